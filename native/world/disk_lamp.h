// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that faces whoever looks at it: Blender's point lamp with soft falloff.
#pragma once

#include <cmath>

#include "math/number.h"
#include "math/warp.h"
#include "world/lamp_sample.h"

namespace wardmis {

struct DiskLamp {
  Vec3f center;
  float radius;

  // Even over its area.
  LampSample sample(Vec3f from, Vec2f u) const {
    const Vec3f toCenter = center - from;
    const float d2 = dot(toCenter, toCenter);
    if (!(d2 > 0)) return {};
    const Framef f = Framef::around(toCenter / std::sqrt(d2));
    const Vec2f d = toDisk(u);
    const Vec3f to = toCenter + (f.x * d.x + f.y * d.y) * radius;
    const float t2 = dot(to, to), t = std::sqrt(t2);
    return {to / t, t, density(t2 * t, d2)};
  }
  LampHit meet(Vec3f from, Vec3f d) const {
    const Vec3f toCenter = center - from;
    const float d2 = dot(toCenter, toCenter), along = dot(d, toCenter);
    if (!(along > 0)) return {};
    const float t = d2 / along;
    const Vec3f p = d * t - toCenter;
    if (dot(p, p) > radius * radius) return {};
    return {t, density(t * t * t, d2)};
  }

 private:
  // At a distance whose cube is t3, of a lamp whose centre is at one whose square is d2.
  float density(float t3, float d2) const { return t3 / (std::sqrt(d2) * kPi<float> * radius * radius); }
};

}  // namespace wardmis
