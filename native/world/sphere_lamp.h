// SPDX-License-Identifier: GPL-3.0-or-later
// A sphere of the same radiance everywhere: Blender's point lamp without soft falloff.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/number.h"
#include "math/warp.h"
#include "world/lamp_sample.h"

namespace wardmis {

struct SphereLamp {
  Vec3f center;
  float radius;

  // Even over the cone that it fills; from inside none.
  LampSample sample(Vec3f from, Vec2f u) const {
    const Vec3f toCenter = center - from;
    const float d2 = dot(toCenter, toCenter), r2 = radius * radius;
    if (!(d2 > r2)) return {};
    const float sine2 = r2 / d2, oneMinusCos = cone(sine2);
    const float d = std::sqrt(d2);
    const Vec3f direction = Framef::around(toCenter / d).toWorld(toCone(u, oneMinusCos));
    const float along = dot(direction, toCenter);
    return {direction, along - std::sqrt(std::max(0.0f, r2 - (d2 - along * along))), density(oneMinusCos)};
  }
  LampHit meet(Vec3f from, Vec3f d) const {
    const Vec3f toCenter = center - from;
    const float d2 = dot(toCenter, toCenter), along = dot(d, toCenter), r2 = radius * radius;
    const Vec3f closest = toCenter - d * along;
    const float q = r2 - dot(closest, closest);
    if (!(q >= 0)) return {};
    const float root = std::sqrt(q);
    if (!(d2 > r2)) return {along + root, 0};
    return {along - root, density(cone(r2 / d2))};
  }

 private:
  // 1 - cos of the half angle of the cone, whose sine is given squared.
  static float cone(float sine2) { return sine2 / (1 + std::sqrt(1 - sine2)); }
  static float density(float oneMinusCos) { return 1 / (2 * kPi<float> * oneMinusCos); }
};

}  // namespace wardmis
