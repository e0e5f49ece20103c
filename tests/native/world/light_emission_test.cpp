// SPDX-License-Identifier: GPL-3.0-or-later
// Rays of light, held against what light sampling finds of the same emitters.
#include "world/light_emission.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrate/scenes.h"
#include "statistics.h"

namespace wardmis {
namespace {

Light lampOf(LightType type, float size) {
  Light l;
  l.type = type;
  l.toWorld.t = {0.3f, -0.2f, 2};
  l.emitted = {3, 2, 1};
  l.radius = size;
  l.sizeX = l.sizeY = 2 * size;
  return l;
}

// Turned towards (0.4, 0.1, -1), with axes of these lengths, the second leaning over to the first.
void turn(Light& light, float x = 1, float y = 1, float lean = 0) {
  const Framef f = Framef::around(normalize(Vec3f{-0.4f, -0.1f, 1}));
  light.toWorld.x = f.x * x, light.toWorld.y = f.y * y + f.x * lean, light.toWorld.z = f.z;
}

struct Case {
  const char* name;
  Scene scene;
};

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](const char* name, const Light& light) {
    Case c{name, {}};
    c.scene.lights = {light};
    all.push_back(std::move(c));
  };
  Light disk = lampOf(LightType::kPoint, 0.4f), sphere = disk, point = disk;
  sphere.facing = false, point.radius = 0;
  add("disk", disk), add("sphere", sphere), add("point", point);
  Light spot = lampOf(LightType::kSpot, 0.4f);
  spot.angle = 1.2f, spot.blend = 0.3f, turn(spot);
  Light small = spot, uneven = spot;
  small.radius = 0, uneven.facing = false, turn(uneven, 2);
  add("spot", spot), add("spot without size", small), add("uneven spot", uneven);
  Light square = lampOf(LightType::kArea, 0.6f);
  turn(square);
  Light ellipse = square, narrow = square, wide = ellipse, sheared = square;
  ellipse.ellipse = true, ellipse.sizeY = 2;
  narrow.spread = 0.5f, narrow.ellipse = true;
  wide.spread = 2.5f, turn(sheared, 1.5f, 1, 0.7f);
  add("square", square), add("ellipse", ellipse), add("narrow", narrow), add("wide", wide), add("sheared", sheared);
  Light sun = lampOf(LightType::kSun, 0), broad = sun, flat = sun;
  sun.angle = 0, turn(sun), broad.angle = 0.6f, turn(broad), flat.angle = 0.6f, flat.flat = true, turn(flat);
  add("sun", sun), add("broad sun", broad), add("flat sun", flat);
  all.push_back({"mesh", {}});
  Material glowing;
  glowing.emission.value = {2, 3, 4};
  all.back().scene.materials = {glowing};
  test::addPlane(all.back().scene, 0.7f, 0, 1.5f);
  Case several{"several", {}};
  several.scene.lights = {disk, square, broad};
  several.scene.materials = {glowing};
  test::addPlane(several.scene, 0.7f, 0, 1.5f);
  all.push_back(std::move(several));
  return all;
}

// What a square around the origin receives from above, by rays of light and by samples of the lights. Of 18 scenes a
// false alarm comes once in 900 seeds.
TEST(LightEmission, BringsWhatSamplesOfLightsFind) {
  constexpr float kHalf = 1.5f;
  constexpr int kRays = 1 << 16;
  for (auto& [name, scene] : cases()) {
    // what the disk of infinitely far light must hold
    scene.materials.resize(2);
    test::addPlane(scene, kHalf, 1);
    Geometry geometry(scene);
    const std::vector<Environment> skies;
    const Emitters emitters(scene, geometry, skies);
    const LightEmission emission(emitters, geometry);
    ASSERT_TRUE(emission.any()) << name;
    const Vec3f up{0, 0, 1};
    Estimate byRays, bySamples;
    test::Random random(17);
    int met = 0;
    for (int k = 0; k < kRays; ++k) {
      const auto a = random.square(), b = random.square();
      const Vec3f at{kHalf * static_cast<float>(2 * a.x - 1), kHalf * static_cast<float>(2 * a.y - 1), 0};
      const LightView view = emitters.view(at, up, 1);
      LightChoice choice = emitters.choose(view, {b.x, static_cast<float>(b.y)});
      emitters.aim(choice);
      const LightSample s = emitters.sample(at, choice);
      bySamples.add(s.pdf > 0 && s.direction.z > 0
                        ? double(s.radiance.x * s.direction.z / s.pdf) * 4 * double(kHalf * kHalf)
                        : 0);
      if (s.pdf > 0 && !isBlack(s.radiance) && k < 1000) {
        const LightSample again = emitters.arriving(choice.emitter, &view, at, s.direction, s.distance);
        EXPECT_NEAR(again.pdf / s.pdf, 1, 0.01f) << name;
        EXPECT_NEAR(again.radiance.x / s.radiance.x, 1, 0.01f) << name;
      }

      const auto c = random.square();
      const auto d = random.square<float>();
      const EmittedRay ray = emission.sample({c.x, static_cast<float>(c.y)}, d);
      double value = 0;
      if (const float t = -ray.origin.z / ray.direction.z; ray.pdf > 0 && ray.direction.z < 0 && t > 0) {
        const Vec3f where = ray.origin + ray.direction * t;
        if (std::max(std::abs(where.x), std::abs(where.y)) < kHalf) {
          const LightSample arrived = emitters.arriving(ray.emitter, nullptr, where, -ray.direction, t);
          const float pdf = emission.density(ray.emitter, where, -ray.direction, t);
          value = double(arrived.radiance.x / pdf);
          ++met;
          const bool point =
              scene.lights.size() == 1 && emitters.anyExclusive() && scene.lights[0].type != LightType::kSun;
          EXPECT_NEAR(pdf * (point ? t * t : 1) / ray.pdf, 1, 1e-3f) << name;
        }
      }
      byRays.add(value);
    }
    EXPECT_GT(met, kRays / 100) << name;
    EXPECT_LT(std::abs(byRays.mean() - bySamples.mean()), 4 * std::hypot(byRays.error(), bySamples.error()))
        << name << ": " << byRays.mean() << " and " << bySamples.mean();
  }
}

}  // namespace
}  // namespace wardmis
