// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "world/accel.h"

namespace wardmis {
namespace {

Affine turned(float angle, Vec3f scale, Vec3f at) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {Vec3f{c, s, 0} * scale.x, Vec3f{-s, c, 0} * scale.y, Vec3f{0, 0, 1} * scale.z, at};
}

void expectNear(Vec3f a, Vec3f b, float error) {
  EXPECT_NEAR(a.x, b.x, error);
  EXPECT_NEAR(a.y, b.y, error);
  EXPECT_NEAR(a.z, b.z, error);
}
void expectNear(const Affine& a, const Affine& b, float error = 2e-6f) {
  expectNear(a.x, b.x, error), expectNear(a.y, b.y, error), expectNear(a.z, b.z, error), expectNear(a.t, b.t, error);
}

TEST(Motion, TurnsEvenlyAndScalesLinearly) {
  const std::vector<Affine> steps = {turned(0, {1, 2, 3}, {0, 0, 0}), turned(2, {2, 2, 3}, {1, 0, 4}),
                                     turned(3, {2, -1, 3}, {1, 1, 1})};
  const std::vector<Affine> two(steps.begin(), steps.begin() + 2);
  expectNear(MovingFrame(two).at(0.25f), turned(0.5f, {1.25f, 2, 3}, {0.25f, 0, 1}));
  const MovingFrame all(steps);
  for (size_t i = 0; i < steps.size(); ++i) expectNear(all.at(static_cast<float>(i) / 2), steps[i]);
}

TEST(Motion, KeepsAnyMatrixThatHasAnInverse) {
  const Affine sheared{{1, 0.3f, -0.2f}, {0.5f, 2, 0.1f}, {-0.7f, 0.2f, 0.4f}, {1, 2, 3}};
  const Affine mirrored{{-1, 0.3f, -0.2f}, {0.5f, 2, 0.1f}, {-0.7f, 0.2f, 0.4f}, {1, 2, 3}};
  for (const Affine& m : {sheared, mirrored}) {
    const std::vector<Affine> still = {m, m};
    for (const float t : {0.0f, 0.3f, 1.0f}) expectNear(MovingFrame(still).at(t), m);
  }
}

TEST(Motion, ShutterFollowsItsCurve) {
  EXPECT_EQ(Shutter().at(0.3f, 0.9f), 0.3f);
  const float ramp[] = {0, 1};
  for (const float u : {0.01f, 0.25f, 0.81f}) EXPECT_NEAR(Shutter(ramp).at(u, 0), std::sqrt(u), 2e-4f);
  const float half[] = {0, 0, 1, 1};  // shut in the first third
  EXPECT_NEAR(Shutter(half).at(0, 0), 1 / 3.0f, 1e-2f);
  EXPECT_NEAR(Shutter(half).at(1, 0), 1, 1e-6f);
}

TEST(Motion, ShutterRollsFromTheTop) {
  const Shutter s({}, 0.1f);
  EXPECT_NEAR(s.at(0.5f, 1), 0.05f, 1e-6f);
  EXPECT_NEAR(s.at(0.5f, 0), 0.95f, 1e-6f);
  EXPECT_NEAR(s.at(1, 0), 1, 1e-6f);
  EXPECT_NEAR(Shutter({}, 0).at(0.9f, 0.25f), 0.75f, 1e-6f);
}

// A triangle at z = 0 that moves, turns and bends, placed twice: a ray finds it where the frame at its time has it.
TEST(Motion, RaysFindWhatMovesWhereItIs) {
  Scene scene;
  const std::vector<Vec3f> flat = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, bent = {{-1, -1, 0.5f}, {1, -1, 0}, {0, 1, -1}};
  MeshPart part;
  part.positions = Array<Vec3f>::of(flat);
  part.movedPositions = {Array<Vec3f>::of(flat), Array<Vec3f>::of(bent)};
  part.primitives = {{0, Array<uint32_t>::of({0, 1, 2})}};
  scene.meshes = {{"Triangle", {part}}};
  scene.materials.resize(1);
  const auto motion = std::make_shared<const std::vector<Affine>>(std::vector<Affine>{
      turned(0, {1, 1, 1}, {0, 0, 0}), turned(1.5f, {1, 2, 1}, {4, 0, 1}), turned(2, {1.2f, 2, 1}, {4, 3, 0})});
  Instance moving;
  moving.motion = motion, moving.toWorld = (*motion)[1];
  scene.instances = {moving, Instance{}};
  scene.instances[1].toWorld.t = {100, 0, 0};
  const Geometry geometry(scene);
  EXPECT_TRUE(geometry.moves());
  const Accel accel(geometry, 1);
  for (const float time : {0.0f, 0.2f, 0.5f, 0.77f, 1.0f})
    for (size_t p = 0; p < 2; ++p) {
      const Placement& placement = geometry.placements[p];
      const Corners c = Geometry::corners(placement, geometry.shapes[placement.firstShape], 0, time);
      const Vec3f inside = c[0] * 0.3f + c[1] * 0.3f + c[2] * 0.4f;
      Ray ray;
      ray.origin = inside + Vec3f{0, 0, 10}, ray.direction = {0, 0, -1};
      ray.path.time = time;
      const Hit hit = accel.intersect(ray);
      ASSERT_TRUE(hit.valid()) << time;
      EXPECT_EQ(hit.placement, p);
      EXPECT_NEAR(hit.t, 10, 2e-5f);
      EXPECT_NEAR(hit.u, 0.3f, 2e-5f);
      EXPECT_NEAR(hit.v, 0.4f, 2e-5f);
      EXPECT_TRUE(accel.occluded(ray));
    }
}

}  // namespace
}  // namespace wardmis
