// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/area_lamp.h"

#include <cmath>

#include "math/number.h"
#include "math/warp.h"

namespace wardmis {
namespace {

constexpr float kPif = kPi<float>;

// The rectangle seen from a point, for sampling its solid angle (Urena, Fajardo and King 2013, "An area-preserving
// parametrization for spherical rectangles").
struct SphericalRectangle {
  float x0, x1, y0, y1, z0, b0, b1, k, solidAngle;

  SphericalRectangle(float ax, float bx, float ay, float by, float z) : x0(ax), x1(bx), y0(ay), y1(by), z0(z) {
    const float z2 = z0 * z0;
    const float n0 = -y0 / std::sqrt(z2 + y0 * y0), n1 = x1 / std::sqrt(z2 + x1 * x1);
    const float n2 = y1 / std::sqrt(z2 + y1 * y1), n3 = -x0 / std::sqrt(z2 + x0 * x0);
    b0 = n0, b1 = n2;
    k = 2 * kPif - std::acos(-n2 * n3) - std::acos(-n3 * n0);
    solidAngle = std::acos(-n0 * n1) + std::acos(-n1 * n2) - k;
  }
  Vec2f sample(Vec2f u) const {
    const float a = u.x * solidAngle + k;
    const float f = (std::cos(a) * b0 - b1) / std::sin(a);
    const float c = std::clamp(std::copysign(1 / std::sqrt(f * f + b0 * b0), f), -1.0f, 1.0f);
    const float x = std::clamp(-(c * z0) / std::sqrt(std::max(1e-20f, 1 - c * c)), x0, x1);
    const float d2 = x * x + z0 * z0;
    const float h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
    const float h = h0 + u.y * (h1 - h0);
    const float y = h * h < 1 - 1e-6f ? h * std::sqrt(d2) / std::sqrt(1 - h * h) : y1;
    return {x, std::clamp(y, y0, y1)};
  }
};
constexpr float kLeastSolidAngle = 1e-4f;  // beyond which it would be lost to cancellation

// Whether points of a rectangle are sampled, not directions: seen small, where the two hardly differ.
bool isSmall(float area, float height, float d2) { return area * height < 0.05f * d2 * std::sqrt(d2); }

}  // namespace

AreaLamp::AreaLamp(const Light& light) : center_(light.toWorld.t), ellipse_(light.ellipse) {
  halfX_ = light.toWorld.x * (0.5f * light.sizeX);
  halfY_ = light.toWorld.y * (0.5f * light.sizeY);
  const Vec3f n = cross(halfX_, halfY_);
  if (!(dot(n, n) > 0)) return;
  normal_ = normalize(n);
  if (dot(normal_, light.toWorld.z) > 0) normal_ = -normal_;  // emits along -z
  axis_ = normalize(-light.toWorld.z);
  tilted_ = dot(axis_, normal_) < 1 - 1e-6f;
  if (!tilted_) axis_ = normal_;
  area_ = length(n) * (ellipse_ ? kPif : 4.0f);
  skew_ = std::abs(dot(halfX_, halfY_)) > 1e-4f * length(halfX_) * length(halfY_);

  spread_ = light.spread < kPif - 1e-4f;
  if (!spread_) return;
  const double h = 0.5 * light.spread;
  spreadTan_ = std::tan(static_cast<float>(h));
  // of a narrow one the two are nearly equal: by their series
  const double difference = h < 0.01 ? h * h * h * (1.0 / 3 + h * h * (2.0 / 15)) : std::tan(h) - h;
  spreadScale_ = static_cast<float>(1 / difference);

  dualX_ = cross(halfY_, n) / dot(n, n), dualY_ = cross(n, halfX_) / dot(n, n);
  along_ = normalize(halfX_), across_ = cross(normal_, along_);
  // A direction w + t q towards the lamp, q a unit vector orthogonal to w = -axis, meets the plane where a is that of
  // the point and -height (A.w + t A.q)/(n.w + t n.q), A = dualX. The extremes m of this ratio over q are the roots of
  // (A.w - m n.w)^2 = t^2 |A' - m n'|^2, A' and n' without their parts along w.
  const Vec3f w = -axis_;
  const float nw = dot(normal_, w), t2 = spreadTan_ * spreadTan_;
  const Vec3f n1 = normal_ - w * nw;
  const float denominator = nw * nw - t2 * dot(n1, n1);
  bounded_ = denominator > 1e-3f;  // else a hyperbola
  if (!bounded_) return;
  const auto extremes = [&](Vec3f dual, float& lower, float& upper) {
    const float aw = dot(dual, w);
    const Vec3f a1 = dual - w * aw, mixed = a1 * nw - n1 * aw, turned = cross(a1, n1);
    const float root = spreadTan_ * std::sqrt(std::max(0.0f, dot(mixed, mixed) - t2 * dot(turned, turned)));
    const float middle = aw * nw - t2 * dot(a1, n1);
    lower = (middle - root) / denominator, upper = (middle + root) / denominator;
  };
  extremes(dualX_, reachLower_.x, reachUpper_.x);
  extremes(dualY_, reachLower_.y, reachUpper_.y);
}

float AreaLamp::cosine(Vec3f d) const {
  const float c = dot(d, normal_);
  if (!tilted_) return c;
  return dot(d, axis_) > 0 ? std::abs(c) : 0;
}

// Its sine from the cosine is nothing below 3e-4.
float AreaLamp::tangent(Vec3f d) const { return length(cross(d, axis_)) / dot(d, axis_); }

float AreaLamp::profile(Vec3f d) const {
  float f = 1;
  if (tilted_) {  // as Cycles has it, the light falls off by the angle to the axis, whatever the plane
    const float plane = cosine(d);
    if (!(plane > 0)) return 0;
    f = dot(d, axis_) / plane;
  }
  if (spread_) {  // Cycles' formula
    if (!(dot(d, axis_) > 0)) return 0;
    f *= std::max(0.0f, (spreadTan_ - tangent(d)) * spreadScale_);
  }
  return f;
}

bool AreaLamp::holds(Vec2f ab) const {
  return ellipse_ ? ab.x * ab.x + ab.y * ab.y <= 1 : std::max(std::abs(ab.x), std::abs(ab.y)) <= 1;
}

AreaLamp::Part AreaLamp::seen(Vec3f from) const {
  Part part;
  part.toCenter = center_ - from;
  part.halfX = halfX_, part.halfY = halfY_;
  part.area = area_;
  part.height = -dot(part.toCenter, normal_);
  if (!(part.height > 0) && !tilted_) return part;
  part.by = By::kPoints;
  part.disk = ellipse_;
  if (spread_ && bounded_) narrow(part);
  if (part.by != By::kPoints || ellipse_ || tilted_ || skew_) return part;
  // within 90 degrees points are as good as directions, and cheaper
  if (spread_ && spreadTan_ <= 1) return part;
  if (!isSmall(part.area, part.height, dot(part.toCenter, part.toCenter))) part.by = By::kDirections;
  return part;
}

// Of a lamp with a spread: the parallelogram around what the point sees of it, the lamp's whole ellipse, or the disk
// within whose cone the point sees anything, by a density as the profile is; whichever wastes least.
void AreaLamp::narrow(Part& part) const {
  const Vec2f point = coordinates(-part.toCenter);
  const auto bounds = [&](float at, float from, float to, float& lower, float& upper) {
    from = at - part.height * from, to = at - part.height * to;
    lower = std::max(-1.0f, std::min(from, to)), upper = std::min(1.0f, std::max(from, to));
    return lower < upper;
  };
  Vec2f lower, upper;
  if (!bounds(point.x, reachLower_.x, reachUpper_.x, lower.x, upper.x) ||
      !bounds(point.y, reachLower_.y, reachUpper_.y, lower.y, upper.y)) {
    part.by = By::kNothing;
    return;
  }
  const Vec2f middle{0.5f * (lower.x + upper.x), 0.5f * (lower.y + upper.y)};
  const Vec2f half{0.5f * (upper.x - lower.x), 0.5f * (upper.y - lower.y)};
  const float whole = ellipse_ ? area_ * (4 / kPif) : area_, area = whole * half.x * half.y;
  const Vec3f toMiddle = part.toCenter + halfX_ * middle.x + halfY_ * middle.y;
  // The error of points is as the area times what the profile is about its highest, less where it varies; that of the
  // cone as its volume.
  constexpr float kVaries = 0.6f;
  const float radius = part.height * spreadTan_;
  const float inside = radius - length(toMiddle + normal_ * part.height);
  const float cone = kPif / 3 * radius * radius * radius;
  if (!tilted_ && spreadTan_ <= 1 && cone < kVaries * std::min(area, area_) * inside) {
    part.by = By::kCone;
    part.radius = radius;
    return;
  }
  // points beyond an ellipse's rim are lost, and what the sampler makes even is not when some are
  constexpr float kUneven = 4;
  if (ellipse_ && area_ <= kUneven * area) return;
  part.disk = false;
  part.toCenter = toMiddle;
  part.halfX = halfX_ * half.x, part.halfY = halfY_ * half.y;
  part.lower = lower, part.upper = upper;
  part.area = area;
}

LampSample AreaLamp::sample(Vec3f from, Vec2f u) const {
  LampSample s;
  const Part part = seen(from);
  Vec3f to;
  float solidAngle = 0;
  switch (part.by) {
    case By::kNothing:
      return s;
    case By::kPoints:
      if (part.disk) {
        const Vec2f d = toDisk(u);
        to = center_ + halfX_ * d.x + halfY_ * d.y - from;
      } else {
        const Vec2f ab{2 * u.x - 1, 2 * u.y - 1};
        to = part.toCenter + (part.halfX * ab.x + part.halfY * ab.y);
        if (ellipse_ && !holds(coordinates(to - (center_ - from)))) return s;
      }
      break;
    case By::kDirections: {
      const float lx = length(part.halfX), ly = length(part.halfY);
      const Vec3f ex = part.halfX / lx, ey = part.halfY / ly;
      const float cx = dot(part.toCenter, ex), cy = dot(part.toCenter, ey);
      const SphericalRectangle q(cx - lx, cx + lx, cy - ly, cy + ly, -part.height);
      const Vec2f p = q.sample(u);
      to = part.toCenter + (ex * (p.x - cx) + ey * (p.y - cy));
      solidAngle = q.solidAngle;
      if (!(solidAngle > kLeastSolidAngle)) return s;
      break;
    }
    case By::kCone: {
      const Vec2f d = toConeOverDisk(u);
      to = (along_ * d.x + across_ * d.y) * part.radius - normal_ * part.height;
      if (!holds(coordinates(to - part.toCenter))) return s;
      break;
    }
  }
  const float t2 = dot(to, to);
  s.distance = std::sqrt(t2);
  s.direction = to / s.distance;
  const float cosLight = cosine(-s.direction);
  if (!(cosLight > 0)) return s;
  if (part.by == By::kDirections)
    s.pdf = 1 / solidAngle;
  else if (part.by == By::kPoints)
    s.pdf = t2 / (cosLight * part.area);
  else
    s.pdf = coneDensity(part, s.direction) * t2 / cosLight;
  return s;
}

AreaLamp::Emitted AreaLamp::emit(Vec2f place, Vec2f u) const {
  Emitted e;
  if (!(area_ > 0)) return e;
  const Vec2f ab = ellipse_ ? toDisk(place) : Vec2f{2 * place.x - 1, 2 * place.y - 1};
  e.origin = at(ab.x, ab.y);
  if (emitsCone()) {
    const Framef f = Framef::around(axis_);
    const Vec2f d = toConeOverDisk(u);
    e.direction = normalize(axis_ + (f.x * d.x + f.y * d.y) * spreadTan_);
  } else {
    e.direction = Framef::around(normal_).toWorld(toCosineHemisphere(u));
  }
  e.pdf = emittedDensity(e.direction);
  return e;
}

float AreaLamp::emittedDensity(Vec3f d) const {
  const float plane = cosine(d);
  if (!(plane > 0) || !(area_ > 0)) return 0;
  if (!emitsCone()) return 1 / (kPif * area_);
  const float axis = dot(d, axis_);
  if (!(axis > 0)) return 0;
  const float disk = std::max(0.0f, 1 - tangent(d) / spreadTan_) * 3 / (kPif * spreadTan_ * spreadTan_);
  return disk / (axis * axis * axis * plane * area_);  // the disk's at distance 1, per solid angle
}

// Per area, of the cone over the disk of radius r: 3 (1 - x/r)/(pi r^2) at the distance x from its middle.
float AreaLamp::coneDensity(const Part& part, Vec3f d) const {
  const float x = tangent(-d) / spreadTan_;
  return std::max(0.0f, 1 - x) * 3 / (kPif * part.radius * part.radius);
}

float AreaLamp::meet(Vec3f from, Vec3f d) const {
  if (!(cosine(-d) > 0)) return 0;  // one-sided
  const Vec3f toCenter = center_ - from;
  const float t = dot(toCenter, normal_) / dot(d, normal_);
  const Vec3f p = d * t - toCenter;
  // solve p = a halfX + b halfY in the plane (the axes need not be orthogonal)
  const Vec3f n = cross(halfX_, halfY_);
  const float n2 = dot(n, n);
  return holds({dot(cross(p, halfY_), n) / n2, dot(cross(halfX_, p), n) / n2}) ? t : 0;
}

float AreaLamp::pdf(Vec3f from, Vec3f d, float t) const {
  const Part part = seen(from);
  const float cosLight = cosine(-d);
  if (!(cosLight > 0)) return 0;
  switch (part.by) {
    case By::kNothing:
      return 0;
    case By::kCone:
      return coneDensity(part, d) * (t * t / cosLight);
    case By::kPoints:
    case By::kDirections:
      break;
  }
  if (spread_ && !part.disk) {
    const Vec2f ab = coordinates(d * t - (center_ - from));
    if (ab.x < part.lower.x || ab.x > part.upper.x || ab.y < part.lower.y || ab.y > part.upper.y) return 0;
  }
  if (part.by == By::kPoints) return t * t / (cosLight * part.area);
  const float lx = length(part.halfX), ly = length(part.halfY);
  const float cx = dot(part.toCenter, part.halfX) / lx, cy = dot(part.toCenter, part.halfY) / ly;
  const SphericalRectangle q(cx - lx, cx + lx, cy - ly, cy + ly, -part.height);
  return q.solidAngle > kLeastSolidAngle ? 1 / q.solidAngle : 0;
}

}  // namespace wardmis
