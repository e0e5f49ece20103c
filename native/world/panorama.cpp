// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/panorama.h"

#include <algorithm>
#include <cmath>

#include "math/number.h"

namespace wardmis {
namespace {

float polynomial(const float (&c)[5], float r) { return c[0] + r * (c[1] + r * (c[2] + r * (c[3] + r * c[4]))); }
float slope(const float (&c)[5], float r) { return c[1] + r * (2 * c[2] + r * (3 * c[3] + r * 4 * c[4])); }

// Angle from the axis at a distance from the centre.
float fisheyeAngle(const Camera& c, float r) {
  switch (c.projection) {
    case Projection::kFisheyeEquisolid:
      return r <= 2 ? 2 * std::asin(r / 2) : 4 * kPi<float>;
    case Projection::kFisheyePolynomial:
      return polynomial(c.polynomial, r);
    default:
      return r;
  }
}

// The inverse. Of the polynomial by Newton's method, from where it would be were it linear.
float fisheyeDistance(const Camera& c, float angle) {
  if (c.projection == Projection::kFisheyeEquisolid) return 2 * std::sin(angle / 2);
  if (c.projection == Projection::kFisheyeEquidistant) return angle;
  float r = c.polynomial[1] != 0 ? (angle - c.polynomial[0]) / c.polynomial[1] : 1;
  for (int i = 0; i < 20; ++i) {
    const float down = slope(c.polynomial, r);
    const float step = down != 0 ? (polynomial(c.polynomial, r) - angle) / down : 0;
    r -= step;
    if (!(std::abs(step) > 1e-6f * std::abs(r))) break;
  }
  return r;
}

}  // namespace

Vec3f panoramaDirection(const Camera& camera, float x, float y) {
  constexpr Vec3f kNone{0, 0, 0};
  switch (camera.projection) {
    case Projection::kEquirectangular: {
      const float c = std::cos(y);
      return {c * std::sin(x), std::sin(y), -c * std::cos(x)};
    }
    case Projection::kCentralCylindrical:
      return normalize(Vec3f{std::sin(x), y, -std::cos(x)});
    case Projection::kMirrorBall: {
      const float h2 = 1 - x * x - y * y;
      if (!(h2 >= 0)) return kNone;
      const float h = std::sqrt(h2);
      return normalize(Vec3f{2 * h * x, 2 * h * y, 1 - 2 * h2});
    }
    case Projection::kEquiangularCubeFace:
      return normalize(Vec3f{std::tan(x), std::tan(y), -1});
    default: {
      const float r = std::sqrt(x * x + y * y), angle = fisheyeAngle(camera, r);
      if (!(std::abs(angle) <= 0.5f * camera.fov)) return kNone;
      if (!(r > 0)) return {0, 0, -1};
      const float side = std::sin(angle) / r;
      return {x * side, y * side, -std::cos(angle)};
    }
  }
}

Vec2f panoramaPoint(const Camera& camera, Vec3f d) {
  const float across = std::sqrt(d.x * d.x + d.y * d.y);
  switch (camera.projection) {
    case Projection::kEquirectangular:
      return {std::atan2(d.x, -d.z), std::asin(std::clamp(d.y, -1.0f, 1.0f))};
    case Projection::kCentralCylindrical:
      return {std::atan2(d.x, -d.z), d.y / std::max(std::sqrt(d.x * d.x + d.z * d.z), 1e-30f)};
    case Projection::kMirrorBall: {
      // h of the ball's normal is the cosine of half the angle between the view and the direction
      const float twice = 2 * std::sqrt(std::max(0.5f * (1 - d.z), 0.0f));
      return twice > 0 ? Vec2f{d.x / twice, d.y / twice} : Vec2f{0, 0};
    }
    case Projection::kEquiangularCubeFace:
      return {std::atan2(d.x, -d.z), std::atan2(d.y, -d.z)};
    default: {
      const float r = fisheyeDistance(camera, std::atan2(across, -d.z));
      return across > 0 ? Vec2f{d.x / across * r, d.y / across * r} : Vec2f{0, 0};
    }
  }
}

float panoramaPixel(const Camera& camera, const Film& film, Vec2f p) {
  const float w = (camera.right - camera.left) / static_cast<float>(film.width),
              h = (camera.top - camera.bottom) / static_cast<float>(film.height);
  const Vec3f d = panoramaDirection(camera, p.x, p.y);
  const Vec3f dx = panoramaDirection(camera, p.x + w, p.y), dy = panoramaDirection(camera, p.x, p.y + h);
  return 0.5f * (length(dx - d) + length(dy - d));
}

}  // namespace wardmis
