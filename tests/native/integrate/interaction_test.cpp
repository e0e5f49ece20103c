// SPDX-License-Identifier: GPL-3.0-or-later
// Where a ray met a surface: that a ray which leaves from there does not meet the surface again, at any size and place.
#include "integrate/interaction.h"

#include <gtest/gtest.h>

#include <random>

#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

struct Place {
  float size, distance;  // of a triangle; of its place from the origin along each axis
};

// A triangle of any direction, well shaped, at `place`; of two instances where `instanced`. flat: factor of its heights
// before it is placed; where it is small, the triangle lies nearly in a plane of the axes, and exactly where it is 0.
Scene triangle(Place place, bool instanced, float flat, std::mt19937& random) {
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto vector = [&] { return Vec3f{unit(random), unit(random), flat * unit(random)}; };
  Scene scene;
  scene.materials = {ward({0.5f, 0.5f, 0.5f}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  const Vec3f center = Vec3f{1, 1, 1} * place.distance;
  std::vector<Vec3f> corners;
  while (corners.size() < 3) {
    const Vec3f a = vector(), b = vector(), c = vector(), n = cross(b - a, c - a);
    if (length(n) < 0.3f) continue;
    for (const Vec3f& v : {a, b, c}) corners.push_back((instanced ? Vec3f{} : center) + v * place.size);
  }
  addMesh(scene, corners, {0, 1, 2}, 0);
  if (instanced) {
    const Framef f = flat < 1 ? Framef::around({0, 0, 1}) : Framef::around(normalize(vector()));
    scene.instances.front().toWorld = {f.x * 2, f.y * 2, f.z * 2, center};
    Instance second = scene.instances.front();
    second.toWorld.t += Vec3f{100, 0, 0} * place.size;
    scene.instances.push_back(second);
  }
  return scene;
}

// Rays from all around to triangles, and from what they hit, at grazing angles and others, away from it.
TEST(Interaction, RayThatLeavesDoesNotMeetItsSurface) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const Place place : {Place{1, 0}, Place{1e-6f, 0}, Place{1e6f, 0}, Place{1, 1e3f}, Place{1e3f, 1e6f}})
    for (bool instanced : {false, true}) {
      int hits = 0, met = 0;
      float farthest = 0;
      for (int i = 0; i < 400; ++i) {
        constexpr float kFlat[] = {1, 1e-3f, 1e-7f, 0};
        const Scene scene = triangle(place, instanced, kFlat[i % 4], random);
        const Geometry geometry(scene);
        const Accel accel(geometry, 1);
        for (int j = 0; j < 40; ++j) {
          const Shape& shape = geometry.shapes[0];
          const Vec2f b = toTriangle(Vec2f{unit(random), unit(random)});
          const Corners corner = Geometry::corners(geometry.placements[0], shape, 0);
          const Vec3f p = corner[0] * (1 - b.x - b.y) + corner[1] * b.x + corner[2] * b.y;
          Ray ray;
          ray.direction = toCone(Vec2f{unit(random), unit(random)}, 2.0f);
          ray.origin = p - ray.direction * (3 * place.size);
          const Hit hit = accel.intersect(ray);
          if (!hit.valid()) continue;
          ++hits;
          const Interaction x = interact<0, 3>(scene, geometry, ray, hit);
          farthest = std::max(farthest, length(x.leave(x.geometric) - x.position));
          for (float height : {1e-4f, 1e-2f, 0.5f}) {
            const Framef f = Framef::around(x.geometric);
            const float phi = 2 * kPi<float> * unit(random), r = std::sqrt(1 - height * height);
            Ray away;
            away.direction = f.toWorld({r * std::cos(phi), r * std::sin(phi), height});
            away.origin = x.leave(away.direction);
            away.tMax = 50 * place.size;  // the other instance is farther away
            met += accel.occluded(away) ? 1 : 0;
          }
        }
      }
      EXPECT_GT(hits, 12000) << place.size << ' ' << place.distance << ' ' << instanced;
      EXPECT_EQ(met, 0) << place.size << ' ' << place.distance << ' ' << instanced;
      // no farther than rounding is: the scene's own size never shows
      EXPECT_LT(farthest, 2e-5f * (place.size + place.distance)) << place.size << ' ' << place.distance;
    }
}

// Without interpolated normals there is nothing to bend: the frame is the surface's own down to the smallest angle.
TEST(Interaction, FlatSurfaceKeepsItsNormalAtGrazingAngles) {
  Scene scene;
  scene.materials = {ward({0.5f, 0.5f, 0.5f}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  addPlane(scene, 1, 0);
  const Geometry geometry(scene);
  const Accel accel(geometry, 1);
  for (float cosine : {1e-2f, 1e-3f, 1e-4f, 1e-5f}) {
    Ray ray;
    ray.direction = normalize(Vec3f{1, 0, -cosine});
    ray.origin = Vec3f{0.1f, 0.2f, 0} - ray.direction * 2;
    const Hit hit = accel.intersect(ray);
    ASSERT_TRUE(hit.valid()) << cosine;
    EXPECT_EQ((interact<0, 3>(scene, geometry, ray, hit).frame.z), (Vec3f{0, 0, 1})) << cosine;
  }
}

}  // namespace
}  // namespace wardmis
