// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/panorama.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/number.h"
#include "world/camera_ray.h"

namespace wardmis {
namespace {

constexpr float kQuarter = kPi<float> / 4, kHalf = kPi<float> / 2;

Camera panorama(Projection projection, float right, float top) {
  Camera c;
  c.projection = projection;
  c.left = -right, c.right = right, c.bottom = -top, c.top = top;
  c.toWorld = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  return c;
}

void expectNear(Vec3f a, Vec3f b, float error = 1e-6f) {
  EXPECT_NEAR(a.x, b.x, error);
  EXPECT_NEAR(a.y, b.y, error);
  EXPECT_NEAR(a.z, b.z, error);
}

TEST(Panorama, LooksWhereItsFormulaSays) {
  const float r = std::sqrt(0.5f);
  expectNear(panoramaDirection(panorama(Projection::kEquirectangular, 3, 1), kHalf, 0), {1, 0, 0});
  expectNear(panoramaDirection(panorama(Projection::kEquirectangular, 3, 1), 0, kQuarter), {0, r, -r});
  expectNear(panoramaDirection(panorama(Projection::kCentralCylindrical, 3, 1), kHalf, 1), {r, r, 0});
  expectNear(panoramaDirection(panorama(Projection::kFisheyeEquidistant, 3, 1), 0, kHalf), {0, 1, 0});
  expectNear(panoramaDirection(panorama(Projection::kFisheyeEquisolid, 3, 1), std::sqrt(2.0f), 0), {1, 0, 0});
  expectNear(panoramaDirection(panorama(Projection::kMirrorBall, 1, 1), r, 0), {1, 0, 0});
  expectNear(panoramaDirection(panorama(Projection::kEquiangularCubeFace, 1, 1), kQuarter, 0), {r, 0, -r});
  Camera c = panorama(Projection::kFisheyePolynomial, 20, 20);
  c.polynomial[1] = 0.02f, c.polynomial[2] = 0.001f;
  const float angle = 0.02f * 10 + 0.001f * 100;
  expectNear(panoramaDirection(c, 0, -10), {0, -std::sin(angle), -std::cos(angle)});
}

TEST(Panorama, FindsThePointOfADirection) {
  for (const Projection p :
       {Projection::kEquirectangular, Projection::kCentralCylindrical, Projection::kFisheyeEquidistant,
        Projection::kFisheyeEquisolid, Projection::kFisheyePolynomial, Projection::kMirrorBall,
        Projection::kEquiangularCubeFace}) {
    Camera c = panorama(p, 1, 1);
    c.polynomial[1] = 0.9f, c.polynomial[3] = 0.05f;
    for (float x = -0.65f; x < 0.7f; x += 0.13f)
      for (float y = -0.65f; y < 0.7f; y += 0.13f) {
        const Vec3f d = panoramaDirection(c, x, y);
        EXPECT_NEAR(length(d), 1, 1e-6f);
        const Vec2f back = panoramaPoint(c, d);
        EXPECT_NEAR(back.x, x, 2e-5f) << static_cast<int>(p);
        EXPECT_NEAR(back.y, y, 2e-5f) << static_cast<int>(p);
      }
  }
}

TEST(Panorama, SeesNothingBesideItsCircle) {
  Camera c = panorama(Projection::kFisheyeEquidistant, kHalf, kHalf);
  c.fov = kPi<float>;
  EXPECT_EQ(length(panoramaDirection(c, 1.2f, 1.2f)), 0);
  EXPECT_GT(length(panoramaDirection(c, 1.1f, 1.1f)), 0);
  EXPECT_EQ(length(panoramaDirection(panorama(Projection::kFisheyeEquisolid, 3, 3), 1.5f, 1.5f)), 0);
  EXPECT_EQ(length(panoramaDirection(panorama(Projection::kMirrorBall, 1, 1), 0.8f, 0.8f)), 0);
  Film film;
  film.width = film.height = 100;
  const CameraRays rays(c, film);
  EXPECT_EQ(rays.ray(0.5f, 0.5f, {0.5f, 0.5f}).tMax, 0);
  EXPECT_GT(rays.ray(50, 50, {0.5f, 0.5f}).tMax, 0);
}

// All rays of a pixel cross at the focus, at its distance in every direction; the lens stands across the view.
TEST(Panorama, FocusesOnASphere) {
  Camera c = panorama(Projection::kEquirectangular, 3, 1.5f);
  c.lensRadius = 0.25f, c.focusDistance = 3, c.bladeRatio = 2;
  Film film;
  film.width = 60, film.height = 30;
  const CameraRays rays(c, film);
  for (const Vec2f at : {Vec2f{30, 15}, Vec2f{3, 28}, Vec2f{44, 2}}) {
    const Vec3f view = panoramaDirection(c, (at.x / 60 * 2 - 1) * 3, (at.y / 30 * 2 - 1) * 1.5f);
    for (const Vec2f u : {Vec2f{0.1f, 0.9f}, Vec2f{0.7f, 0.2f}}) {
      const Ray r = rays.ray(at.x, at.y, u);
      EXPECT_NEAR(dot(r.origin, view), 0, 1e-6f);
      EXPECT_GT(length(r.origin), 0.01f);
      EXPECT_LE(length(r.origin), 0.25f);
      const Vec3f focus = view * 3.0f;
      expectNear(r.origin + r.direction * length(focus - r.origin), focus, 1e-5f);
    }
  }
}

TEST(Panorama, MeasuresAPixel) {
  Film film;
  film.width = 628, film.height = 314;
  const Camera c = panorama(Projection::kEquirectangular, kPi<float>, kHalf);
  EXPECT_NEAR(panoramaPixel(c, film, {0, 0}), 2 * kPi<float> / 628, 1e-5f);
  EXPECT_NEAR(panoramaPixel(c, film, {1, 1}), kPi<float> / 628 * (1 + std::cos(1.0f)), 2e-5f);
}

}  // namespace
}  // namespace wardmis
