// SPDX-License-Identifier: GPL-3.0-or-later
// A rectangle or an ellipse that shines to one side. Of one whose light is spread over less than a hemisphere a point
// sees no more than a part, and that part alone is sampled.
#pragma once

#include <algorithm>

#include "scene/scene.h"
#include "world/lamp_sample.h"

namespace wardmis {

class AreaLamp {
 public:
  AreaLamp() = default;
  explicit AreaLamp(const Light& light);

  float area() const { return area_; }  // world units squared; 0: of no use
  Vec3f normal() const { return normal_; }
  // Of the whole parallelogram |a|, |b| <= 1 that it is, or that is around it.
  Vec3f at(float a, float b) const { return center_ + halfX_ * a + halfY_ * b; }
  bool ellipse() const { return ellipse_; }
  bool tilted() const { return tilted_; }  // it looks elsewhere than along its normal
  // The squared radius of a sphere about its centre in which it lies.
  float reach2() const {
    return std::max(dot(halfX_ + halfY_, halfX_ + halfY_), dot(halfX_ - halfY_, halfX_ - halfY_));
  }

  // Of the angle between its plane's normal and d, which leaves it; not above 0: no light leaves there.
  float cosine(Vec3f d) const;
  // What its radiance is multiplied by in the unit direction d, which leaves it.
  float profile(Vec3f d) const;

  // A ray of its light: from an even place, in a direction as the light is spread.
  struct Emitted {
    Vec3f origin, direction;  // unit
    float pdf = 0;            // per m^2 across the ray and sr; 0: none
  };
  Emitted emit(Vec2f place, Vec2f u) const;
  float emittedDensity(Vec3f d) const;  // of those that leave in the unit direction d

  LampSample sample(Vec3f from, Vec2f u) const;
  // Where a ray with the unit direction d meets it; 0: nowhere.
  float meet(Vec3f from, Vec3f d) const;
  // The density of sample() at the unit direction d, in which the lamp is met at the distance t.
  float pdf(Vec3f from, Vec3f d, float t) const;

 private:
  // How the part that a point sees is sampled: its solid angle; its area; the cone over a disk of which it is a piece.
  enum class By : uint8_t { kNothing, kDirections, kPoints, kCone };
  struct Part {
    By by = By::kNothing;
    bool disk = false;                 // by points: of the ellipse
    Vec3f toCenter{};                  // from the point
    Vec3f halfX{}, halfY{};            // of the parallelogram
    Vec2f lower{-1, -1}, upper{1, 1};  // the same by the lamp's a and b
    float area = 0, height = 0;        // height: of the point above the plane
    float radius = 0;                  // by cone: of the disk
  };
  Part seen(Vec3f from) const;
  void narrow(Part& part) const;
  float coneDensity(const Part& part, Vec3f d) const;
  // Whether rays are spread as the profile is, and not as the cosine: within 45 degrees.
  bool emitsCone() const { return spread_ && spreadTan_ <= 1; }
  Vec2f coordinates(Vec3f fromCenter) const { return {dot(fromCenter, dualX_), dot(fromCenter, dualY_)}; }
  bool holds(Vec2f ab) const;
  float tangent(Vec3f d) const;  // of the angle between d and the axis, which is below 90 degrees

  Vec3f center_{}, halfX_{}, halfY_{};
  Vec3f normal_{};  // unit
  Vec3f axis_{};    // unit; where it looks
  float area_ = 0;
  bool ellipse_ = false;
  bool tilted_ = false;  // the axis is not the normal: the light's node is sheared
  bool skew_ = false;    // the half axes are not orthogonal
  bool spread_ = false;  // over less than a hemisphere
  // with a spread s: t = tan(s/2), and 1/(t - s/2)
  float spreadTan_ = 0, spreadScale_ = 0;
  Vec3f dualX_{}, dualY_{};            // a = dualX . (p - center), b = dualY . (p - center)
  Vec3f along_{}, across_{};           // unit, in the plane
  bool bounded_ = false;               // the directions that see it meet its plane within bounds:
  Vec2f reachLower_{}, reachUpper_{};  // of a and b, from those of the point, per -height
};

}  // namespace wardmis
