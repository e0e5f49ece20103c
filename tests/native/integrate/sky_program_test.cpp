// SPDX-License-Identifier: GPL-3.0-or-later
// Skies and lights that are programs, against known values. The seeds are fixed; an image is allowed five of its
// standard errors, which for other seeds would fail once in 1.7 million images.
#include <gtest/gtest.h>

#include "math/number.h"
#include "program/programs.h"
#include "scenes.h"
#include "world/environment.h"

namespace wardmis {
namespace {

using namespace test;

RenderSettings settings(Allocation allocation = Allocation::kEqual, Integrand integrand = Integrand::kSplit) {
  RenderSettings s;
  s.spp = 64;
  s.integrator = Integrator::kDirect;
  s.allocation = allocation;
  s.integrand = integrand;
  s.threads = 2;
  return s;
}

const json kHeight = {{{"op", "direction"}}, {{"op", "z"}, {"in", {{{"result", 0}}}}}};

// The sky L = max(0, z)^n in all colours.
json powerOfHeight(float n) {
  json operations = kHeight;
  operations.push_back({{"op", "maximum"}, {"in", {{{"result", 1}}, 0}}});
  operations.push_back({{"op", "power"}, {"in", {{{"result", 2}}, n}}});
  operations.push_back({{"op", "vector"}, {"in", {{{"result", 3}}}}});
  return operations;
}

void setSky(Scene& scene, const json& operations) {
  World& world = worldOf(scene);
  world.radiance = {1, 1, 1};
  world.program = program(operations);
  world.result = 0;
}

// Of a horizontal surface: 2 pi / (n + 2), so that a white one has the radiance 2 / (n + 2).
TEST(SkyProgram, LightsASurfaceAsItsIntegralSays) {
  for (const bool zUp : {false, true})
    for (const float n : {1.0f, 20.0f, 400.0f}) {
      if (zUp && n != 20) continue;
      Scene scene = diffusePlane(16);
      scene.zUp = zUp;
      json sky = powerOfHeight(n);
      if (zUp)
        sky = {{{"op", "direction"}},
               {{"op", "y"}, {"in", {{{"result", 0}}}}},
               {{"op", "multiply"}, {"in", {{{"result", 1}}, -1}}}};
      if (zUp) {  // the plane looks to the file's z, which is -y there
        sky.push_back({{"op", "maximum"}, {"in", {{{"result", 2}}, 0}}});
        sky.push_back({{"op", "power"}, {"in", {{{"result", 3}}, n}}});
        sky.push_back({{"op", "vector"}, {"in", {{{"result", 4}}}}});
      }
      setSky(scene, sky);
      const double want = 2 / double(n + 2);
      for (const Allocation a : {Allocation::kEqual, Allocation::kVariance})
        for (const Integrand i : {Integrand::kSplit, Integrand::kJoint}) {
          const Measured m = measure(renderScene(scene, settings(a, i)));
          EXPECT_NEAR(m.mean, want, 5 * m.error + 1e-5 * want) << n << zUp << int(a) << int(i);
          EXPECT_LT(m.error, 0.01 * want);
        }
    }
}

// The density of what is sampled: its integral is 1, and the mean of L/pdf that of L, by the light technique alone.
TEST(SkyProgram, ItsSamplesHaveTheDensityThatItSays) {
  Scene scene;
  setSky(scene, powerOfHeight(50));
  const Environment sky(scene, scene.worlds[0]);
  ASSERT_TRUE(sky.sampled());
  constexpr int kPoints = 1 << 16;
  const Sampler sampler(SamplerType::kSobol, 3, kPoints);
  double light = 0, sphere = 0;
  for (uint32_t k = 0; k < kPoints; ++k) {
    const Vec3f d = sky.sample(sampler.getChoice(sampler.pixelKey(0, 0), 5, k)).direction;
    const float pdf = sky.look(d).pdf;
    ASSERT_GT(pdf, 0);
    light += double(luminance(sky.radiance(d)) / pdf) / kPoints;
    sphere += 1 / double(pdf) / kPoints;
  }
  EXPECT_NEAR(light, 2 * kPi<double> / 51, 2e-3 * 2 * kPi<double> / 51);
  EXPECT_NEAR(sphere, 4 * kPi<double>, 0.05 * 4 * kPi<double>);  // where it hardly shines there are few samples
  EXPECT_NEAR(double(sky.integral()), 2 * kPi<double> / 51, 0.02 * 2 * kPi<double> / 51);
}

// A disc that is brighter in its middle: L = 1 - .6 (1 - sqrt(1 - r^2)), whose mean over the disc is .8.
TEST(SkyProgram, ConesShineFromWithinThemAlone) {
  const json disc = {{{"op", "direction"}},
                     {{"op", "vector-distance"}, {"in", {{{"result", 0}}, {0, 0, 1}}}},
                     {{"op", "divide"}, {"in", {{{"result", 1}}, 0.0174531}}},
                     {{"op", "multiply"}, {"in", {{{"result", 2}}, {{"result", 2}}}}},
                     {{"op", "subtract"}, {"in", {1, {{"result", 3}}}}},
                     {{"op", "sqrt"}, {"in", {{{"result", 4}}}}},
                     {{"op", "multiply-add"}, {"in", {{{"result", 5}}, 0.6, 0.4}}},
                     {{"op", "vector"}, {"in", {{{"result", 6}}}}}};
  Scene scene = diffusePlane(16);
  setSky(scene, disc);
  worldOf(scene).radiance = {1000, 1000, 1000};
  worldOf(scene).coneAxis = {0, 0, 1};
  worldOf(scene).coneAngle = 0.0349066f;  // 2 degrees
  const double solidAngle = 2 * kPi<double> * (1 - std::cos(0.0174533));
  const Measured m = measure(renderScene(scene, settings()));
  EXPECT_NEAR(m.mean, 1000 * 0.8 * solidAngle / kPi<double>, 5 * m.error + 1e-3 * m.mean);
  EXPECT_LT(m.error, 0.01 * m.mean);
  const Environment sky(scene, scene.worlds[0]);
  EXPECT_EQ(luminance(sky.radiance(normalize(Vec3f{0.02f, 0, 1}))), 0);
  EXPECT_GT(luminance(sky.radiance(normalize(Vec3f{0.01f, 0, 1}))), 0);
  EXPECT_NEAR(double(sky.integral()), 1000 * 0.8 * solidAngle, 4 * solidAngle);
}

// Only what looks at it from the camera sees the ray depth 0.
TEST(SkyProgram, KnowsHowOftenAPathWasScattered) {
  Scene scene = diffusePlane(8);
  setSky(scene, {{{"op", "ray-depth"}}, {{"op", "vector"}, {"in", {{{"result", 0}}}}}});
  const Measured lit = measure(renderScene(scene, settings()));
  EXPECT_NEAR(lit.mean, 1, 5 * lit.error + 1e-5);
  scene.instances.clear();
  EXPECT_EQ(measure(renderScene(scene, settings())).mean, 0);
}

// Under a program that is 1 a light is the same to the bit; of others it follows the integral.
TEST(LightProgram, MultipliesTheLight) {
  for (const LightType type : {LightType::kArea, LightType::kPoint, LightType::kSpot, LightType::kSun})
    for (const float radius : {0.0f, 0.3f}) {
      Scene scene = diffusePlane(4);
      Light light;
      light.type = type;
      light.toWorld.t = {0, 0, 2};
      light.radius = radius;
      light.angle = type == LightType::kSun ? radius : 2.0f;
      light.sizeX = light.sizeY = 0.1f;
      light.emitted = {10, 10, 10};
      scene.lights = {light};
      const auto seen = [&](const json& operations) {
        scene.lights[0].program = operations.is_null() ? nullptr : program(operations);
        scene.lights[0].result = operations.is_null() ? -1 : 0;
        return measure(renderScene(scene, settings()));
      };
      const Measured plain = seen(nullptr);
      ASSERT_GT(plain.mean, 0);
      const Measured half = seen({{{"op", "incoming"}},
                                  {{"op", "vector-length"}, {"in", {{{"result", 0}}}}},
                                  {{"op", "multiply"}, {"in", {{{"result", 1}}, 0.5}}},
                                  {{"op", "vector"}, {"in", {{{"result", 2}}}}}});
      EXPECT_NEAR(half.mean, 0.5 * plain.mean, 1e-6 * plain.mean) << int(type) << radius;
      if (type == LightType::kSun) continue;
      const Measured linear = seen({{{"op", "light-falloff-linear"}, {"in", {1, 0}}, {"version", 5}},
                                    {{"op", "vector"}, {"in", {{{"result", 0}}}}}});
      EXPECT_NEAR(linear.mean, 2 * plain.mean, 0.02 * plain.mean) << int(type) << radius;
    }
}

// A light whose program shines to one side alone.
TEST(LightProgram, ShinesWhereItSays) {
  Scene scene = diffusePlane(4);
  Light light;
  light.toWorld.t = {0, 0, 2};
  light.emitted = {10, 10, 10};
  json operations = {{{"op", "incoming"}},
                     {{"op", "z"}, {"in", {{{"result", 0}}}}},
                     {{"op", "less-than"}, {"in", {{{"result", 1}}, 0}}},
                     {{"op", "vector"}, {"in", {{{"result", 2}}}}}};
  light.program = program(operations);
  light.result = 0;
  scene.lights = {light};
  EXPECT_GT(measure(renderScene(scene, settings())).mean, 0.1);
  scene.lights[0].toWorld.t.z = -2;
  operations[2]["op"] = "greater-than";
  scene.lights[0].program = program(operations);
  scene.lights[0].toWorld.t.z = 2;
  EXPECT_EQ(measure(renderScene(scene, settings())).mean, 0);
}

}  // namespace
}  // namespace wardmis
