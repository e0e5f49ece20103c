// SPDX-License-Identifier: GPL-3.0-or-later
// From a point on the film and on the lens to a ray: Blender's camera (docs/scene-format.md).
#pragma once

#include <cmath>
#include <optional>

#include "math/number.h"
#include "math/warp.h"
#include "world/accel.h"
#include "world/panorama.h"

namespace wardmis {

class CameraRays {
 public:
  CameraRays(const Camera& camera, const Film& film) : camera_(camera), film_(film) {
    const Vec3f n = cross(camera.toWorld.x, camera.toWorld.y);
    toDepth_ = n / -dot(n, camera.toWorld.z);
    if (!camera.motion.empty()) motion_.emplace(camera.motion);
  }

  bool moves() const { return motion_ || !camera_.viewPlanes.empty(); }

  bool needsLens() const { return camera_.lensRadius > 0; }

  // (px, py): film position in pixels of the full frame from its bottom left; u: lens. Without length (tMax 0) where a
  // panorama sees nothing.
  Ray ray(float px, float py, Vec2f u, float time = kMiddle) const {
    const Camera& c = camera_;
    const float fx = px / static_cast<float>(film_.width), fy = py / static_cast<float>(film_.height);
    Ray r = motion_ ? through(motion_->at(time), fx, fy, u, time) : through(c.toWorld, fx, fy, u, time);
    r.path.time = time;
    return r;
  }
  // Where on the film a point is seen through a place of the lens.
  struct Seen {
    float px, py;      // as for ray()
    Vec3f towards;     // unit; from the point
    float distance;    // to the lens
    float clear;       // so far from the point nothing may be in the way: up to where the camera begins to see
    float importance;  // area of the film, in pixels, for one of a surface there across the ray
  };
  // A panorama's lens turns with its view, and is not looked through from there.
  bool seesBack() const { return !camera_.panoramic() || !needsLens(); }
  std::optional<Seen> seen(Vec3f point, Vec2f u, float time = kMiddle) const {
    const Camera& c = camera_;
    const Affine toWorld = motion_ ? motion_->at(time) : c.toWorld;
    const Vec3f local = toWorld.inverseVector(point - toWorld.t);
    if (c.panoramic()) [[unlikely]]
      return seenAround(toWorld, point, local, time);
    const bool open = c.lensRadius > 0;
    const Vec2f on = open ? onLens(u) : Vec2f{};
    const Vec3f lens{on.x, on.y, 0};
    const float focus = open ? c.focusDistance : 1, depth = -local.z;
    if (!(depth > 0)) return std::nullopt;
    Vec3f plane, origin = lens;  // of the film's plane the place, at its distance from the lens
    if (c.orthographic()) {
      plane = local - lens * (1 - (open ? depth / focus : 0));
      origin += Vec3f{plane.x, plane.y, 0};
    } else {
      plane = (lens + (local - lens) * (focus / depth)) / focus;
    }
    const auto [left, right, bottom, top] = viewPlane(time);
    Seen s;
    s.px = (plane.x - left) / (right - left) * static_cast<float>(film_.width);
    s.py = (plane.y - bottom) / (top - bottom) * static_cast<float>(film_.height);
    const Vec3f way = local - origin, to = toWorld.vector(way);
    s.distance = length(to);
    s.towards = -to / s.distance;
    const float stretch = length(way) / depth;
    if (!(s.distance > c.clipNear * stretch) || !(s.distance < c.clipFar * stretch)) return std::nullopt;
    s.clear = s.distance - c.clipNear * stretch;
    // The plane's square 1 x 1 is spanned by the axes x and y, at the distance of which way = (., ., -depth): across
    // the ray it is det(x, y, way)/|way|.
    const float across = std::abs(toWorld.determinant()) * depth / s.distance;
    const float pixels =
        static_cast<float>(film_.width) * static_cast<float>(film_.height) / std::abs((right - left) * (top - bottom));
    const float widens = c.orthographic() ? 1 : depth;  // from the plane at distance 1 to there
    s.importance = pixels / (across * widens * widens);
    return s;
  }
  // Planar depth of a point at distance t along a ray of this camera; of a panorama its distance.
  float depth(const Ray& r, float t) const {
    if (camera_.panoramic()) return length(r.origin + r.direction * t - camera_.toWorld.t);
    if (motion_) [[unlikely]]  // from where the frame's own camera is
      return dot(r.origin + r.direction * t - camera_.toWorld.t, toDepth_);
    return dot(r.direction, toDepth_) * t;
  }

 private:
  // fx, fy: of the full frame, 0 to 1.
  Ray through(const Affine& toWorld, float fx, float fy, Vec2f u, float time) const {
    const Camera& c = camera_;
    const auto [left, right, bottom, top] = viewPlane(time);
    const float x = left + fx * (right - left);
    const float y = bottom + fy * (top - bottom);
    if (c.panoramic()) [[unlikely]]
      return panorama(toWorld, x, y, u);
    Vec3f origin{0, 0, 0}, direction{x, y, -1};
    if (c.orthographic()) origin = {x, y, 0}, direction = {0, 0, -1};
    if (c.lensRadius > 0) {
      const Vec3f focus = origin + direction * c.focusDistance;
      const Vec2f lens = onLens(u);
      origin += Vec3f{lens.x, lens.y, 0};
      direction = focus - origin;
    }
    // clip distances are planar depths: along the ray they stretch by |direction| / depth
    const float stretch = length(direction) / -direction.z;
    Ray r;
    r.origin = toWorld.point(origin);
    r.direction = normalize(toWorld.vector(direction));
    r.tMin = c.clipNear * stretch;
    r.tMax = c.clipFar * stretch;
    r.kind = kSeenByCamera;
    return r;
  }
  std::optional<Seen> seenAround(const Affine& toWorld, Vec3f point, Vec3f local, float time) const {
    const Camera& c = camera_;
    const Vec3f to = point - toWorld.t;
    Seen s;
    s.distance = length(to);
    if (!(s.distance > c.clipNear) || !(s.distance < c.clipFar)) return std::nullopt;
    s.clear = s.distance - c.clipNear;
    s.towards = -to / s.distance;
    const Vec2f at = panoramaPoint(c, normalize(local));
    const auto direction = [&](float x, float y) { return panoramaDirection(c, x, y); };
    constexpr float kStep = 1e-3f;                // of what the projection measures in
    const auto between = [&](Vec3f a, Vec3f b) {  // in the world, of unit directions
      return normalize(toWorld.vector(b)) - normalize(toWorld.vector(a));
    };
    if (isBlack(direction(at.x, at.y))) return std::nullopt;
    const Vec3f ex = between(direction(at.x - kStep, at.y), direction(at.x + kStep, at.y)),
                ey = between(direction(at.x, at.y - kStep), direction(at.x, at.y + kStep));
    const auto [left, right, bottom, top] = viewPlane(time);
    const float width = static_cast<float>(film_.width), height = static_cast<float>(film_.height);
    s.px = (at.x - left) / (right - left) * width;
    s.py = (at.y - bottom) / (top - bottom) * height;
    const float solidAngle = length(cross(ex, ey)) / (4 * kStep * kStep);  // of the plane's square 1 x 1
    if (!(solidAngle > 0)) return std::nullopt;
    s.importance = width * height / std::abs((right - left) * (top - bottom)) / (solidAngle * s.distance * s.distance);
    return s;
  }
  // Left, right, bottom and top of the frame at distance 1.
  std::array<float, 4> viewPlane(float time) const {
    const Camera& c = camera_;
    if (c.viewPlanes.empty()) [[likely]]
      return {c.left, c.right, c.bottom, c.top};
    const auto [first, t] = stepAt(c.viewPlanes.size(), time);
    const auto &a = c.viewPlanes[first], &b = c.viewPlanes[first + 1];
    const auto side = [&, t = t](size_t k) { return a[k] * (1 - t) + b[k] * t; };
    return {side(0), side(1), side(2), side(3)};
  }
  // The lens stands across the view, whichever way that goes; it turns about the axis towards which its x would point,
  // as in Cycles.
  Ray panorama(const Affine& toWorld, float x, float y, Vec2f u) const {
    const Camera& c = camera_;
    Vec3f origin{0, 0, 0}, direction = panoramaDirection(c, x, y);
    Ray r;
    if (isBlack(direction)) {
      r.tMax = 0;
      return r;
    }
    if (c.lensRadius > 0) {
      const bool mirror = c.projection == Projection::kMirrorBall;
      const Vec3f axis = mirror ? Vec3f{1, 0, 0} : Vec3f{0, 0, -1};
      const Vec3f across = axis - direction * dot(axis, direction);
      const Vec3f lensX = dot(across, across) > 1e-12f ? normalize(across) : Framef::around(direction).x;
      const Vec3f lensY = cross(direction, lensX) * (mirror ? -1.0f : 1.0f);
      const Vec2f lens = onLens(u);
      origin = lensX * lens.x + lensY * lens.y;
      direction = direction * c.focusDistance - origin;
    }
    r.origin = toWorld.point(origin);
    r.direction = normalize(toWorld.vector(direction));
    r.tMin = c.clipNear;
    r.tMax = c.clipFar;
    r.kind = kSeenByCamera;
    return r;
  }
  Vec2f onLens(Vec2f u) const {
    const Vec2f lens = camera_.blades < 3 ? toDisk(u) : onPolygon(u);
    return {lens.x * camera_.lensRadius / camera_.bladeRatio, lens.y * camera_.lensRadius};
  }
  // Uniform on a regular polygon inscribed in the unit circle.
  Vec2f onPolygon(Vec2f u) const {
    const auto n = static_cast<float>(camera_.blades);
    const float corner = std::min(std::floor(u.x * n), n - 1);
    const Vec2f b = toTriangle(Vec2f{u.x * n - corner, u.y});
    const float step = 2 * kPi<float> / n, a0 = camera_.bladeRotation + corner * step, a1 = a0 + step;
    return {b.x * std::cos(a0) + b.y * std::cos(a1), b.x * std::sin(a0) + b.y * std::sin(a1)};
  }
  const Camera& camera_;
  const Film& film_;
  std::optional<MovingFrame> motion_;
  Vec3f toDepth_;  // minus the z of a vector in the camera's axes
};

}  // namespace wardmis
