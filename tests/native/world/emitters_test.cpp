// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps as rays meet them.
#include "world/emitters.h"

#include <gtest/gtest.h>

namespace wardmis {
namespace {

Light lampOf(LightType type, Vec3f at) {
  Light l;
  l.type = type;
  l.toWorld.t = at;
  return l;
}

// What a sample of a lamp aims at, a ray of that direction meets, up to the rim, near and far, for lamps of any size
// and form: the sphere that rays are tested against first must hold all of the lamp. Rounding of the direction loses
// at most 6e-8 of the distance at the rim; 2 % of the samples may do so.
TEST(Emitters, RaysMeetWhatSamplesAimAt) {
  for (const float size : {1e-3f, 1.0f, 1e3f}) {
    const Vec3f at{3 * size, -2 * size, 5 * size};
    Light disk = lampOf(LightType::kPoint, at), sphere = disk, spot = lampOf(LightType::kSpot, at);
    disk.radius = sphere.radius = spot.radius = size;
    sphere.facing = spot.facing = false;
    spot.angle = 3;
    Light square = lampOf(LightType::kArea, at);
    square.sizeX = square.sizeY = 2 * size;
    Light strip = square, ellipse = square, sheared = square;
    strip.sizeX = 20 * size;
    ellipse.ellipse = true, ellipse.sizeY = 6 * size;
    sheared.toWorld.x = {1, 0.9f, 0};
    for (const Light& light : {disk, sphere, spot, square, strip, ellipse, sheared}) {
      Scene scene;
      scene.lights = {light};
      Geometry geometry(scene);
      const std::vector<Environment> skies;
      const Emitters emitters(scene, geometry, skies);
      for (const float away : {1.5f, 10.0f, 1e4f}) {
        Stream random(1, static_cast<uint64_t>(away));
        int aimed = 0, met = 0;
        for (int k = 0; k < 2000; ++k) {
          const auto u = random.square();
          const Vec3f from = at + normalize(Vec3f{static_cast<float>(u.x) - 0.5f, 0.4f, -1}) * (away * size);
          const auto v = random.square();
          const LightView view = emitters.view(from, {0, 0, 0}, 1);
          LightChoice choice = emitters.choose(view, {v.x, static_cast<float>(v.y)});
          emitters.aim(choice);
          const LightSample s = emitters.sample(from, choice);
          if (!(s.pdf > 0) || isBlack(s.radiance)) continue;
          Ray ray;
          ray.origin = from, ray.direction = s.direction, ray.kind = kSeenByDiffuse;
          ++aimed;
          emitters.along(ray, 2 * s.distance, false, 0, &view, [&](const EmitterHit& hit) {
            ++met;
            EXPECT_NEAR(hit.pdf / s.pdf, 1, 0.02) << size << " " << away;
          });
        }
        EXPECT_GT(aimed, 1500) << size << " " << away;
        EXPECT_GE(met, aimed - aimed / 50) << size << " " << away;
        EXPECT_LE(met, aimed);
      }
    }
  }
}

// Lamps so small that no float holds their radiance shine as points do.
TEST(Emitters, TinyLampsArePoints) {
  for (const bool facing : {false, true})
    for (const float radius : {1e-12f, 1e-16f, 1e-19f, 1e-20f, 1e-30f}) {
      Scene scene;
      scene.lights = {lampOf(LightType::kPoint, {0, 0, 2})};
      scene.lights[0].radius = radius, scene.lights[0].facing = facing, scene.lights[0].emitted = {100, 100, 100};
      Geometry geometry(scene);
      const std::vector<Environment> skies;
      const Emitters emitters(scene, geometry, skies);
      const LightView view = emitters.view({0, 0, 0}, {0, 0, 0}, 1);
      LightChoice choice = emitters.choose(view, {0.5, 0.5f});
      const LightSample s = emitters.sample({0, 0, 0}, choice);
      EXPECT_NEAR(s.radiance.x / s.pdf, 25, 0.1) << radius;
      EXPECT_EQ(s.exclusive, radius < 1e-15f);
    }
}

// Cycles 3.4 picks lamps evenly and weighs them so against samples of surfaces, wherever ours are drawn; others by what
// they send, as here.
TEST(Emitters, AreCountedAsCyclesPicksThem) {
  for (const int version : {3, 5}) {
    Scene scene;
    Light near = lampOf(LightType::kPoint, {0, 0, 1}), far = lampOf(LightType::kPoint, {0, 0, 50});
    near.radius = far.radius = 0.1f;
    scene.lights = {near, far};
    Material material;
    Closure closure;
    closure.version = static_cast<uint8_t>(version);
    material.closures = {closure};
    scene.materials = {material};
    Geometry geometry(scene);
    const std::vector<Environment> skies;
    const Emitters emitters(scene, geometry, skies);
    const LightView view = emitters.view({0, 0, 0}, {0, 0, 1}, 1);
    Stream random(1, 2);
    for (int k = 0; k < 100; ++k) {
      const auto u = random.square();
      LightChoice choice = emitters.choose(view, {u.x, static_cast<float>(u.y)});
      emitters.aim(choice);
      const LightSample s = emitters.sample({0, 0, 0}, choice);
      const float expected = version == 3 ? s.pdf / choice.probability / 2 : s.pdf;
      EXPECT_NEAR(s.counted / expected, 1, 1e-5);
      Ray ray;
      ray.origin = {0, 0, 0}, ray.direction = s.direction, ray.kind = kSeenByDiffuse;
      emitters.along(ray, 1.001f * s.distance, false, 0, &view,
                     [&](const EmitterHit& hit) { EXPECT_EQ(hit.counted == hit.pdf, version != 3); });
    }
  }
}

}  // namespace
}  // namespace wardmis
