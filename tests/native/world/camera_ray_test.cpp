// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras, seen from the scene: the way back of a ray.
#include "world/camera_ray.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "statistics.h"

namespace wardmis {
namespace {

struct Case {
  const char* name;
  Camera camera;
};

std::vector<Case> cameras() {
  Camera c;
  const Vec3f z = normalize(Vec3f{0.3f, -0.5f, 0.7f}), x = normalize(cross(Vec3f{0, 0, 1}, z));
  c.toWorld = {x, cross(z, x), z, {1, 2, 3}};
  c.left = -0.4f, c.right = 0.6f, c.bottom = -0.3f, c.top = 0.2f;
  c.clipNear = 0.1f, c.clipFar = 100;
  Camera lens = c, polygon = c, orthographic = c, scaled = c;
  lens.lensRadius = 0.2f, lens.focusDistance = 4;
  polygon = lens, polygon.blades = 5, polygon.bladeRatio = 1.5f;
  orthographic.projection = Projection::kOrthographic;
  scaled = lens, scaled.toWorld.x = x * 2, scaled.toWorld.z = z * 0.7f;
  Camera broad = orthographic;
  broad.lensRadius = 0.2f, broad.focusDistance = 4;
  Camera around = c, fisheye = c;
  around.projection = Projection::kEquirectangular;
  fisheye.projection = Projection::kFisheyeEquisolid;
  return {{"equirectangular", around},
          {"fisheye", fisheye},
          {"pinhole", c},
          {"lens", lens},
          {"polygon", polygon},
          {"orthographic", orthographic},
          {"orthographic lens", broad},
          {"scaled", scaled}};
}

// The point that a ray comes to is seen where the ray began, along it, and as much of it as rays around it say.
TEST(CameraRays, PointsAreSeenWhereTheirRaysBegin) {
  for (const auto& [name, camera] : cameras()) {
    Film film;
    film.width = 640, film.height = 480;
    const CameraRays rays(camera, film);
    test::Random random(3);
    for (int k = 0; k < 200; ++k) {
      const auto at = random.square<float>(), lens = random.square<float>();
      const float px = 640 * at.x, py = 480 * at.y, t = static_cast<float>(random.logUniform(1, 30));
      const Ray ray = rays.ray(px, py, lens);
      const Vec3f point = ray.origin + ray.direction * t;
      const auto seen = rays.seen(point, lens);
      ASSERT_TRUE(seen) << name;
      EXPECT_NEAR(seen->px, px, 0.02f) << name;
      EXPECT_NEAR(seen->py, py, 0.02f) << name;
      EXPECT_NEAR(dot(seen->towards, ray.direction), -1, 1e-5f) << name;
      EXPECT_NEAR(seen->distance / t, 1, 1e-4f) << name;
      // of rays through the neighbouring places on the film, at the plane across this one
      const auto across = [&](float dx, float dy) {
        const Ray r = rays.ray(px + dx, py + dy, lens);
        return r.origin + r.direction * (dot(point - r.origin, ray.direction) / dot(r.direction, ray.direction));
      };
      constexpr float kStep = 4;
      const Vec3f ex = across(kStep, 0) - across(-kStep, 0), ey = across(0, kStep) - across(0, -kStep);
      EXPECT_NEAR(seen->importance * length(cross(ex, ey)) / (4 * kStep * kStep), 1, 0.01f) << name;
    }
    if (!camera.panoramic()) {
      EXPECT_FALSE(rays.seen(camera.toWorld.t + camera.toWorld.z, {0.5f, 0.5f})) << name;  // behind it
    }
    EXPECT_FALSE(rays.seen(camera.toWorld.t - camera.toWorld.z * 1e3f, {0.5f, 0.5f})) << name;  // clipped
  }
}

}  // namespace
}  // namespace wardmis
