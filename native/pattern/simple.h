// SPDX-License-Identifier: GPL-3.0-or-later
// Patterns of one line each: the nodes Checker Texture, Gradient Texture and White Noise Texture.
#pragma once

#include "math/number.h"
#include "pattern/hash.h"

namespace wardmis::pattern {

// 1 where the first colour is, 0 where the second.
inline float checker(float scale, Vec3f p) {
  // Walls at whole numbers do not lie on a jump.
  const auto odd = [scale](float x) {
    return (static_cast<uint32_t>(toInt(std::floor((x * scale + 0.000001f) * 0.999999f))) & 1) != 0;
  };
  return (odd(p.x) == odd(p.y)) == odd(p.z) ? 1 : 0;
}

enum class GradientType { kLinear, kQuadratic, kEasing, kDiagonal, kSpherical, kQuadraticSphere, kRadial };

// In [0, 1].
inline float gradient(GradientType type, Vec3f p) {
  const float sphere = limit(0.999999f - length(p), 0, 1);
  const float x = limit(p.x, 0, 1);
  switch (type) {
    case GradientType::kLinear:
      return x;
    case GradientType::kQuadratic:
      return x * x;
    case GradientType::kEasing:
      return smoothstep(x);
    case GradientType::kDiagonal:
      return limit((p.x + p.y) * 0.5f, 0, 1);
    case GradientType::kSpherical:
      return sphere;
    case GradientType::kQuadraticSphere:
      return sphere * sphere;
    case GradientType::kRadial:
      return limit(std::atan2(p.y, p.x) / (2 * kPi<float>)+0.5f, 0, 1);
  }
  return 0;
}

// A number of every point that has nothing to do with its neighbours', in [0, 1].
inline float whiteNoise(int dimensions, Vec3f p, float w) {
  return atDimensions(dimensions, p, w, [](const auto& at) { return hashToUnit(at); });
}
inline Rgb whiteNoiseColor(int dimensions, Vec3f p, float w) {
  return atDimensions(dimensions, p, w, [](const auto& at) { return hashToColor(at); });
}

}  // namespace wardmis::pattern
