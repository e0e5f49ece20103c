// SPDX-License-Identifier: GPL-3.0-or-later
// The edge of a smooth surface's own shadow.
#include "integrate/terminator.h"

#include <gtest/gtest.h>

#include <random>

#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

// Over a triangle of the unit sphere: from the sphere up to its corners' tangent planes, whatever it is placed by.
TEST(Terminator, MovesToTheSmoothSurface) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  for (const bool shared : {false, true}) {
    Scene scene;
    scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
    addSphere(scene, 12, 0);
    constexpr float kSize = 2;
    scene.instances[0].toWorld = {Vec3f{0, kSize, 0}, Vec3f{-kSize, 0, 0}, Vec3f{0, 0, kSize}, {3, 2, 1}};
    if (shared) scene.instances.push_back(scene.instances[0]);
    const Geometry geometry(scene);
    const Placement& placement = geometry.placements[0];
    ASSERT_EQ(placement.flat, !shared);
    const Shape& shape = geometry.shapes[0];
    float most = 0;
    for (uint32_t t = 0; t < shape.triangles; ++t)
      for (int i = 0; i < 8; ++i) {
        const float r = std::sqrt(unit(random)), v = unit(random);
        const SmoothFace face{0.1f, 0, t, r * (1 - v), r * v};
        const Corners c = Geometry::corners(placement, shape, t);
        const Vec3f at = c[0] + (c[1] - c[0]) * face.u + (c[2] - c[0]) * face.v;
        const Vec3f center = placement.toWorld.t, out = normalize(at - center);
        const float radius = length(at + shadowOffset(geometry, placement, face, out, kMiddle) - center) / kSize;
        EXPECT_GT(radius, 1 - 1e-3f);
        EXPECT_LT(radius, 1.02f);
        most = std::max(most, radius - length(at - center) / kSize);
      }
    EXPECT_GT(most, 0.01f);  // faces of 15 degrees are below the sphere by that
  }
}

TEST(Terminator, IsFarFromLightThatFacesTheSurface) {
  const SmoothFace face{0.1f, 0, 0, 0, 0};
  EXPECT_EQ(face.amount(0.5f, 0.5f), 0);
  EXPECT_EQ(face.amount(0.5f, 0.1f), 0);
  EXPECT_NEAR(face.amount(0.5f, 0.025f), 0.75f, 1e-6f);
  EXPECT_EQ(face.amount(0.05f, -0.05f), 1);
  EXPECT_NEAR(face.amount(-0.05f, -0.1f), 0.5f, 1e-6f);  // behind
  EXPECT_EQ(SmoothFace{}.amount(0.05f, -0.05f), 0);
}

Light sun(Vec3f to, float irradiance) {
  Light l;
  l.type = LightType::kSun;
  l.toWorld = {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, normalize(to), {0, 0, 0}};
  l.emitted = {irradiance, irradiance, irradiance};
  return l;
}

// A coarse sphere of two sides under a sun: nothing is in its way where the smooth surface looks towards it.
TEST(Terminator, AConvexSurfaceIsInNoShadowButItsOwn) {
  for (const bool general : {false, true}) {
    Scene scene;
    scene.materials = {ward({0.5f, 0.5f, 0.5f}, {0.2f, 0.2f, 0.2f}, 0.5f, WardVariant::kWardGmd)};
    if (general) scene.materials[0].closures = {closure(ClosureType::kDiffuse)};
    addSphere(scene, 6, 0);
    lookFrom(scene, 0.3f, 1, 64);
    scene.lights = {sun({1, 0, -1}, 3)};
    RenderSettings s;
    s.spp = 16, s.threads = 2;
    const auto mean = [&](float offset, bool shadow) {
      scene.instances[0].terminator.geometry = offset;
      scene.lights[0].shadow = shadow;
      return measure(renderScene(scene, s)).mean;
    };
    const double without = mean(0.1f, false);
    EXPECT_NEAR(mean(0.1f, true) / without, 1, 1e-3);
    EXPECT_LT(mean(0, true) / without, 0.95);
  }
}

// However samples are shared out, of lights that surfaces' rays find, too. 4.5 standard errors: 7e-6 a comparison.
TEST(Terminator, TheImageDoesNotDependOnTheAllocation) {
  for (const bool general : {false, true}) {
    Scene scene;
    Material lamp;
    lamp.emission.value = {8, 6, 4};
    scene.materials = {ward({0.5f, 0.4f, 0.3f}, {0.3f, 0.3f, 0.3f}, 0.3f, WardVariant::kWardGmd), lamp};
    if (general) {
      Closure glossy = closure(ClosureType::kGlossy, {1, 1, 1}, 0.3f);
      glossy.scalars[0].value = glossy.scalars[1].value = 0.3f;
      scene.materials[0].closures = {closure(ClosureType::kDiffuse, {1, 1, 1}, 0.5f), glossy};
    }
    addSphere(scene, 4, 0);
    scene.instances[0].terminator.geometry = 1;
    addPlane(scene, 0.7f, 1, 2.5f);
    addCosineSky(scene, 64);
    Light area;
    area.type = LightType::kArea;
    area.emitted = {9, 9, 9};
    area.toWorld = {Vec3f{0, 1, 0}, Vec3f{0, 0, 1}, Vec3f{1, 0, 0}, {2.2f, 0, 0}};
    scene.lights = {area};
    lookFrom(scene, 0.9f, 1, 32);
    RenderSettings s;
    s.spp = 32, s.threads = 2, s.sampler = SamplerType::kIndependent;
    s.integrator = Integrator::kDirect;
    std::vector<double> means, errors;
    const auto add = [&] {
      double sum = 0, square = 0;
      constexpr int kSeeds = 16;
      for (s.seed = 0; s.seed < kSeeds; ++s.seed) {
        const double m = measure(renderScene(scene, s)).mean;
        sum += m / kSeeds, square += m * m / kSeeds;
      }
      means.push_back(sum), errors.push_back(std::sqrt(std::max(square - sum * sum, 0.0) / (kSeeds - 1)));
    };
    for (Integrand integrand : {Integrand::kSplit, Integrand::kJoint})
      for (const auto& [rule, weights] :
           {std::pair{Allocation::kEqual, Weights::kBalance}, std::pair{Allocation::kAlbedo, Weights::kPower},
            std::pair{Allocation::kSecondMoment, Weights::kMaximum}, std::pair{Allocation::kAuto, Weights::kBalance}}) {
        s.integrand = integrand, s.allocation = rule, s.weights = weights;
        add();
      }
    for (size_t i = 1; i < means.size(); ++i)
      EXPECT_NEAR(means[i], means[0], 4.5 * std::hypot(errors[i], errors[0])) << i << ' ' << general;
    const double moved = means[0], error = errors[0];
    means.clear(), errors.clear();
    scene.instances[0].terminator.geometry = 0;
    s.allocation = Allocation::kEqual, s.weights = Weights::kBalance;
    add();
    EXPECT_GT(moved - means[0], 4.5 * std::hypot(error, errors[0])) << "it is seen at all";
  }
}

// A plane under a sun at 60 degrees that counts as one at 80.
TEST(Terminator, LightOfAGreaterAngle) {
  for (const bool general : {false, true}) {
    Scene scene = diffusePlane(2);
    if (general) scene.materials[0].closures = {closure(ClosureType::kDiffuse)};
    scene.instances[0].terminator.shading = 0.5f;
    scene.lights = {sun({std::sqrt(0.75f), 0, 0.5f}, kPi<float>)};
    RenderSettings s;
    s.spp = 1, s.threads = 1;
    EXPECT_NEAR(measure(renderScene(scene, s)).mean, std::cos(80 * 3.14159265 / 180), 1e-4);
  }
}

}  // namespace
}  // namespace wardmis
