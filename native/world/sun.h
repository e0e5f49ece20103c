// SPDX-License-Identifier: GPL-3.0-or-later
// Light from infinitely far, out of a cone of directions: of the same radiance in each, or a disk at distance 1 that
// shines as its cosine has it, as in Cycles up to 3; or out of one direction alone.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/number.h"
#include "math/warp.h"

namespace wardmis {

class Sun {
 public:
  Sun() = default;
  // towards: unit; angle: of the whole cone.
  Sun(Vec3f towards, float angle, bool flat) : towards_(towards) {
    constexpr float kLeast = 1e-5f;
    if (!(angle > kLeast)) return;
    const float half = 0.5f * angle, s = std::sin(0.5f * half);
    oneMinusCos_ = 2 * s * s;
    if (flat) {
      const float cosHalf = std::max(1e-6f, std::cos(half));
      radius_ = std::sqrt(std::max(0.0f, 1 - cosHalf * cosHalf)) / cosHalf;
      area_ = kPi<float> * radius_ * radius_;
      // integral over the disk of cos = 2 cos h/(1 + cos h) times that of 1: the irradiance, and the power
      excess_ = (1 + cosHalf) / (2 * cosHalf);
    } else {
      const float sinHalf = std::sin(half);
      projected_ = kPi<float> * sinHalf * sinHalf;
    }
  }

  bool delta() const { return !(oneMinusCos_ > 0); }
  float oneMinusCos() const { return oneMinusCos_; }  // of the half angle
  // How much more light it sends than the irradiance that is told of it.
  float excess() const { return excess_; }
  // At the axis, by its irradiance; of a delta light the irradiance itself.
  Rgb radiance(Rgb irradiance) const { return area_ > 0 ? irradiance * (excess_ / area_) : irradiance / projected_; }

  struct Sample {
    Vec3f direction;  // unit
    float cos3 = 1;   // what the radiance at the axis is to be divided by
    float pdf = 0;    // per solid angle; of a delta light 1
  };
  Sample sample(Vec2f u) const {
    if (delta()) return {towards_, 1, 1};
    const Framef f = Framef::around(towards_);
    if (!(area_ > 0)) return {f.toWorld(toCone(u, oneMinusCos_)), 1, inCone()};
    const Vec2f d = toDisk(u);
    const Vec3f to = towards_ + (f.x * d.x + f.y * d.y) * radius_;
    const float cos3 = 1 / (dot(to, to) * length(to));  // of the angle to the axis, cubed
    return {normalize(to), cos3, 1 / (area_ * cos3)};
  }
  // What lies in the unit direction d; of a density of 0 where that is beside it.
  Sample at(Vec3f d) const {
    const Vec3f apart = d - towards_;  // 1 - cos = |apart|^2 / 2, exact for narrow cones
    const float cosAxis = dot(d, towards_);
    if (delta() || !(0.5f * dot(apart, apart) <= oneMinusCos_)) return {d};
    if (!(area_ > 0)) return {d, 1, inCone()};
    if (!(cosAxis > 0)) return {d};
    const float cos3 = cosAxis * cosAxis * cosAxis;
    return {d, cos3, 1 / (area_ * cos3)};
  }

 private:
  float inCone() const { return 1 / (2 * kPi<float> * oneMinusCos_); }

  Vec3f towards_{0, 0, 1};
  float oneMinusCos_ = 0;
  float radius_ = 0, area_ = 0;       // of the disk; 0: a cone
  float excess_ = 1, projected_ = 1;  // solid angle of the cone, projected
};

}  // namespace wardmis
