// SPDX-License-Identifier: GPL-3.0-or-later
// Arithmetic that is defined for all numbers, as Cycles defines it: nothing divides by zero or takes a root of less.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "math/number.h"
#include "math/vec.h"

namespace wardmis::arithmetic {

inline float divide(float a, float b) { return b != 0 ? a / b : 0; }
inline float clamp(float a, float least, float most) { return std::min(std::max(a, least), most); }
inline float saturate(float a) { return clamp(a, 0, 1); }
inline float clampRange(float a, float b, float c) { return b > c ? clamp(a, c, b) : clamp(a, b, c); }
inline float fraction(float a) { return a - std::floor(a); }
inline float truncate(float a) { return a >= 0 ? std::floor(a) : std::ceil(a); }
inline float sign(float a) { return a == 0 ? 0.0f : a < 0 ? -1.0f : 1.0f; }

inline float power(float a, float b) {
  if (b == 0) return 1;
  if (a == 0 || (a < 0 && b != truncate(b))) return 0;
  return std::pow(a, b);
}
inline float logarithm(float a, float b) { return a > 0 && b > 0 ? divide(std::log(a), std::log(b)) : 0; }
inline float squareRoot(float a) { return std::sqrt(std::max(a, 0.0f)); }
inline float inverseSquareRoot(float a) { return a > 0 ? 1 / std::sqrt(a) : 0; }
inline float arcSine(float a) { return std::asin(clamp(a, -1, 1)); }
inline float arcCosine(float a) { return std::acos(clamp(a, -1, 1)); }
inline float arcTangent2(float y, float x) { return x == 0 && y == 0 ? 0 : std::atan2(y, x); }
inline float modulo(float a, float b) { return b != 0 ? std::fmod(a, b) : 0; }
inline float flooredModulo(float a, float b) { return b != 0 ? a - std::floor(a / b) * b : 0; }
inline float snap(float a, float b) { return std::floor(divide(a, b)) * b; }
inline float wrap(float a, float most, float least) {
  const float range = most - least;
  return range != 0 ? a - range * std::floor((a - least) / range) : least;
}
inline float pingPong(float a, float b) { return b != 0 ? std::abs(fraction((a - b) / (b * 2)) * b * 2 - b) : 0; }
inline float compare(float a, float b, float c) { return a == b || std::abs(a - b) <= std::max(c, FLT_EPSILON); }
inline float smoothMinimum(float a, float b, float width) {
  if (width == 0) return std::min(a, b);
  const float h = std::max(width - std::abs(a - b), 0.0f) / width;
  return std::min(a, b) - h * h * h * width * (1 / 6.0f);
}

enum class Steps { kLinear, kStepped, kSmooth, kSmoother };

// t of a value between two others, by the kind of steps. from != to.
template <Steps S>
float place(float value, float from, float to, float steps) {
  float t = (value - from) / (to - from);
  if constexpr (S == Steps::kStepped) t = steps > 0 ? std::floor(t * (steps + 1)) / steps : 0;
  if constexpr (S == Steps::kSmooth) {
    t = saturate(t);
    t = t * t * (3 - 2 * t);
  }
  if constexpr (S == Steps::kSmoother) {
    t = saturate(t);
    t = t * t * t * (t * (t * 6 - 15) + 10);
  }
  return t;
}
template <Steps S>
float mapRange(float value, float from, float to, float least, float most, float steps, bool clamped) {
  const float mapped = from != to ? least + place<S>(value, from, to, steps) * (most - least) : 0;
  return clamped ? clampRange(mapped, least, most) : mapped;
}
// Of a component of a vector: where the range to map from is empty, t is 0. Steps that are smooth stay within.
template <Steps S>
float mapRangeOfVector(float value, float from, float to, float least, float most, float steps, bool clamped) {
  const float t = from != to ? place<S>(value, from, to, steps) : 0;
  const float mapped = least + t * (most - least);
  return clamped && (S == Steps::kLinear || S == Steps::kStepped) ? clampRange(mapped, least, most) : mapped;
}

}  // namespace wardmis::arithmetic

namespace wardmis {

template <class F>
Vec3f each(F f, Vec3f a) {
  return {f(a.x), f(a.y), f(a.z)};
}
template <class F>
Vec3f each(F f, Vec3f a, Vec3f b) {
  return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)};
}
template <class F>
Vec3f each(F f, Vec3f a, Vec3f b, Vec3f c) {
  return {f(a.x, b.x, c.x), f(a.y, b.y, c.y), f(a.z, b.z, c.z)};
}

inline Vec3f safeNormalize(Vec3f a) {
  const float l = length(a);
  return l != 0 ? a * (1 / l) : a;
}

}  // namespace wardmis
