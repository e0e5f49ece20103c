// SPDX-License-Identifier: GPL-3.0-or-later
// Faces in one place are known, and a ray that leaves one meets the others.
#include "world/accel.h"

#include <gtest/gtest.h>

namespace wardmis {
namespace {

void addSquare(Scene& scene, float half, float height) {
  MeshPart part;
  part.positions = Array<Vec3f>::of(
      std::vector<Vec3f>{{-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}});
  part.primitives.push_back({0, Array<uint32_t>::of(std::vector<uint32_t>{0, 1, 2, 0, 2, 3})});
  scene.meshes.push_back({"square", {part}});
  Instance i;
  i.mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.instances.push_back(i);
}

TEST(Accel, KnowsFacesInOnePlace) {
  for (const float height : {0.0f, 0.3f, 100.0f}) {
    Scene scene;
    scene.materials.emplace_back();
    addSquare(scene, 3, height);
    addSquare(scene, 0.5f, height);           // on it
    addSquare(scene, 3, height + 1e-3f * 3);  // above
    const Geometry geometry(scene);
    const Accel accel(geometry, 1);
    const auto of = [&](uint32_t p, uint32_t triangle) {
      return PrimitiveId{p, geometry.placements[p].firstShape, triangle};
    };
    for (const uint32_t triangle : {0u, 1u}) {
      EXPECT_TRUE(accel.shared(of(0, triangle))) << height;
      EXPECT_TRUE(accel.shared(of(1, triangle))) << height;
      EXPECT_FALSE(accel.shared(of(2, triangle))) << height;
    }
    Ray ray;
    ray.origin = {0.2f, 0.1f, height};
    ray.direction = {0, 0, -1};
    EXPECT_FALSE(accel.occluded(ray));  // beginning in their plane
    ray.left = of(0, 0);
    EXPECT_TRUE(accel.occluded(ray));  // by the other
    EXPECT_EQ(accel.intersect(ray).placement, 1u);
    EXPECT_TRUE(accel.intersect(ray).shared);
    ray.aimed = of(1, 0);
    EXPECT_FALSE(accel.occluded(ray));
    ray.origin = {2, 1, height};
    ray.aimed = {};
    EXPECT_FALSE(accel.occluded(ray)) << "where it lies alone";
  }
}

}  // namespace
}  // namespace wardmis
