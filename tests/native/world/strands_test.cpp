// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and spheres against what they are: tubes and spheres by their equations, ribbons by the plane that faces the
// ray.
#include "world/strands.h"

#include <gtest/gtest.h>

#include <cmath>

#include "world/accel.h"

namespace wardmis {
namespace {

Scene sceneOf(Form form, std::vector<Vec3f> points, std::vector<float> radii, std::vector<uint32_t> indices) {
  Scene scene;
  scene.materials.emplace_back();
  MeshPart part;
  part.positions = Array<Vec3f>::of(std::move(points));
  part.radii = Array<float>::of(std::move(radii));
  part.primitives.push_back({0, Array<uint32_t>::of(std::move(indices)), form, 16});
  scene.meshes.push_back({"strands", {part}});
  Instance i;
  i.toWorld = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {1, 2, 3}};
  scene.instances.push_back(i);
  return scene;
}
// Twice as large, about (1, 2, 3): a straight curve along x of radius 0.2 from x = -1 to 3, by four points.
Scene straight(Form form) {
  return sceneOf(form, {{-1, 0, 0}, {-0.4f, 0, 0}, {0.3f, 0, 0}, {1, 0, 0}}, {0.1f, 0.1f, 0.1f, 0.1f}, {0, 1, 2});
}
Ray ray(Vec3f from, Vec3f direction) {
  Ray r;
  r.origin = from, r.direction = normalize(direction);
  return r;
}
void expectNear(Vec3f a, Vec3f b, float tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// Each of them placed once, so that it is moved into the world, and twice, so that it is not.
class Placed : public testing::TestWithParam<bool> {
 protected:
  Scene placed(Scene scene) {
    if (GetParam()) {
      scene.instances.push_back(scene.instances[0]);
      scene.instances[1].toWorld.t.z += 100;
    }
    return scene;
  }
};
INSTANTIATE_TEST_SUITE_P(Strands, Placed, testing::Bool());

TEST_P(Placed, TubesAndConesAreCylinders) {
  for (const Form form : {Form::kTubes, Form::kCones}) {
    const Scene scene = placed(straight(form));
    const Geometry geometry(scene);
    const Accel accel(geometry, 1);
    EXPECT_EQ(geometry.segments, GetParam() ? 6u : 3u);
    EXPECT_EQ(geometry.triangles, 0u);
    for (int k = 0; k < 40; ++k) {
      const float x = -0.9f + 3.8f * (static_cast<float>(k) + 0.5f) / 40, y = 0.19f * std::sin(static_cast<float>(k));
      const Ray r = ray({x, 2 + y, 8}, {0, 0, -1});
      const Hit hit = accel.intersect(r);
      ASSERT_TRUE(hit.valid()) << x;
      const float height = std::sqrt(0.04f - y * y);
      EXPECT_NEAR(hit.t, 5 - height, 1e-4f);
      const StrandPoint on = strandPoint(geometry.placements[hit.placement], geometry.shapes[hit.shape], r, hit);
      expectNear(on.normal, Vec3f{0, y, height} / 0.2f, 2e-3f);
      expectNear(normalize(on.along), {1, 0, 0}, 1e-4f);
      EXPECT_FALSE(on.turned);
    }
    EXPECT_FALSE(accel.intersect(ray({0, 2.21f, 8}, {0, 0, -1})).valid());
  }
}

TEST_P(Placed, RibbonsFaceTheRayWithTheNormalsOfTubes) {
  const Scene scene = placed(straight(Form::kRibbons));
  const Geometry geometry(scene);
  const Accel accel(geometry, 1);
  for (const Vec3f towards : {Vec3f{0, 0, -1}, Vec3f{0, 1, -1}, Vec3f{0, -1, 0.5f}}) {
    const Vec3f d = normalize(towards), side = cross(Vec3f{1, 0, 0}, d);
    for (const float v : {-0.9f, -0.3f, 0.0f, 0.5f}) {
      const Ray r = ray(Vec3f{0.4f, 2, 3} + side * (0.2f * v) - d * 5, d);
      const Hit hit = accel.intersect(r);
      ASSERT_TRUE(hit.valid());
      EXPECT_NEAR(hit.t, 5, 1e-3f);
      const StrandPoint on = strandPoint(geometry.placements[hit.placement], geometry.shapes[hit.shape], r, hit);
      expectNear(on.normal, side * v - d * std::sqrt(1 - v * v), 5e-3f);
      expectNear(on.facing, -d, 1e-6f);
    }
  }
}

TEST_P(Placed, SpheresAreSpheres) {
  const Scene scene = placed(sceneOf(Form::kSpheres, {{0, 0, 0}, {3, 0, 0}}, {0.5f, 0.25f}, {0, 1}));
  const Geometry geometry(scene);
  const Accel accel(geometry, 1);
  const Ray r = ray({1.3f, 2.2f, 10}, {0, 0, -1});
  const Hit hit = accel.intersect(r);
  ASSERT_TRUE(hit.valid());
  const float height = std::sqrt(1 - 0.09f - 0.04f);
  EXPECT_NEAR(hit.t, 7 - height, 1e-4f);
  const StrandPoint on = strandPoint(geometry.placements[hit.placement], geometry.shapes[hit.shape], r, hit);
  expectNear(on.normal, {0.3f, 0.2f, height}, 1e-3f);
  EXPECT_TRUE(accel.intersect(ray({7.4f, 2, 10}, {0, 0, -1})).valid());
  EXPECT_FALSE(accel.intersect(ray({7.6f, 2, 10}, {0, 0, -1})).valid());
}

// A ray that leaves a curve meets others, and not the same one again; other kinds of ray do not see what is hidden.
TEST_P(Placed, LeavesItsOwnAndMeetsOthers) {
  Scene scene =
      sceneOf(Form::kTubes, {{-1, 0, 0}, {1, 0, 0}, {-1, 0, -2}, {1, 0, -2}}, {0.1f, 0.1f, 0.1f, 0.1f}, {0, 2});
  scene.instances[0].visibility = kSeenByCamera;
  scene = placed(scene);
  const Geometry geometry(scene);
  const Accel accel(geometry, 1);
  Ray r = ray({1, 2, 8}, {0, 0, -1});
  const Hit first = accel.intersect(r);
  ASSERT_TRUE(first.valid());
  EXPECT_NEAR(first.t, 4.8f, 1e-4f);
  r.left = {first.placement, first.shape, geometry.shapes[first.shape].strands->strandOf(first.triangle)};
  const Hit second = accel.intersect(r);
  ASSERT_TRUE(second.valid());
  EXPECT_NEAR(second.t, 8.8f, 1e-4f);
  r.kind = kCastsShadow;
  EXPECT_FALSE(accel.occluded(r));
  // not from inside
  EXPECT_NEAR(accel.intersect(ray({1, 2, 3}, {0, 0, -1})).t, 3.8f, 1e-4f);
}

// What begins inside meets the far side, seen from behind, where the scene says so.
TEST_P(Placed, TheirInsideIsSeenWhereItIsSaid) {
  for (const Form form : {Form::kTubes, Form::kCones, Form::kSpheres})
    for (const bool inside : {false, true}) {
      Scene scene = form == Form::kSpheres ? sceneOf(form, {{0, 0, 0}}, {0.1f}, {0}) : straight(form);
      scene.meshes[0].parts[0].primitives[0].inside = inside;
      scene = placed(scene);
      const Geometry geometry(scene);
      const Accel accel(geometry, 1);
      Ray r = ray({1, 2, 3}, {0, 1, 1});
      const Hit hit = accel.intersect(r);
      ASSERT_EQ(hit.valid(), inside);
      r.tMax = 1, r.kind = kCastsShadow;
      EXPECT_EQ(accel.occluded(r), inside);
      if (!inside) continue;
      EXPECT_NEAR(hit.t, 0.2f, 1e-4f);
      const Shape& shape = geometry.shapes[hit.shape];
      const StrandPoint on = strandPoint(geometry.placements[hit.placement], shape, r, hit);
      expectNear(on.normal, -r.direction, 1e-3f);
      EXPECT_TRUE(on.turned);
      r.left = {hit.placement, hit.shape, shape.strands->strandOf(hit.triangle)};
      EXPECT_FALSE(accel.occluded(r));
    }
}

TEST_P(Placed, BoundsHoldWhatRaysMeet) {
  // a spline that swings out beyond its points, and is thicker between them
  const Scene scene =
      placed(sceneOf(Form::kTubes, {{0, 0, 0}, {1, 1, 0}, {1, -1, 0}, {0, 0, 0}}, {0.1f, 0.4f, 0.4f, 0.1f}, {0, 1, 2}));
  const Geometry geometry(scene);
  const Accel accel(geometry, 1);
  int met = 0;
  for (int k = 0; k < 4000; ++k) {
    const int column = k % 63, row = k / 63;
    const float y = -3 + 10 * static_cast<float>(column) / 63, x = -3 + 10 * static_cast<float>(row) / 63;
    const Hit hit = accel.intersect(ray({x, y, 20}, {0, 0, -1}));
    if (!hit.valid()) continue;
    ++met;
    const Vec3f p{x, y, 20 - hit.t};
    EXPECT_TRUE(p.x >= geometry.lower.x - 1e-4f && p.x <= geometry.upper.x + 1e-4f) << p.x;
    EXPECT_TRUE(p.y >= geometry.lower.y - 1e-4f && p.y <= geometry.upper.y + 1e-4f) << p.y;
  }
  EXPECT_GT(met, 100);
}

}  // namespace
}  // namespace wardmis
