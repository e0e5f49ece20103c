// SPDX-License-Identifier: GPL-3.0-or-later
// What all patterns share: points of one to four dimensions, and the steps from float to the lattice, which are defined
// for every number. No pattern has a branch that NaN, an infinity or 1e30 could lead astray; what comes out may then be
// NaN, and is for the caller to refuse.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "math/vec.h"

namespace wardmis::pattern {

// Whose equations are meant: those of Cycles in Blender 3.4, 4.3 or 5.2. Where a pattern takes none, all three agree.
enum class Version { kBlender3 = 3, kBlender4 = 4, kBlender5 = 5 };

template <int D>
struct Point {
  std::array<float, D> v{};

  constexpr float operator[](int d) const { return v[d]; }
  constexpr float& operator[](int d) { return v[d]; }
  // Component by component: f(a) or f(a, b).
  template <class F>
  constexpr Point map(F f) const {
    Point r;
    for (int d = 0; d < D; d++) r[d] = f(v[d]);
    return r;
  }
  template <class F>
  constexpr Point map(const Point& b, F f) const {
    Point r;
    for (int d = 0; d < D; d++) r[d] = f(v[d], b[d]);
    return r;
  }
  constexpr Point operator+(const Point& b) const {
    return map(b, [](float x, float y) { return x + y; });
  }
  constexpr Point operator-(const Point& b) const {
    return map(b, [](float x, float y) { return x - y; });
  }
  constexpr Point operator*(float s) const {
    return map([s](float x) { return x * s; });
  }
  constexpr Point operator/(float s) const {
    return map([s](float x) { return x / s; });
  }
  constexpr Point operator+(float s) const {
    return map([s](float x) { return x + s; });
  }
};

template <int D>
constexpr float dot(const Point<D>& a, const Point<D>& b) {
  float sum = 0;
  for (int d = 0; d < D; d++) sum += a[d] * b[d];
  return sum;
}
template <int D>
Point<D> floor(const Point<D>& p) {
  return p.map([](float x) { return std::floor(x); });
}
// p with one more coordinate.
template <int D>
constexpr Point<D + 1> append(const Point<D>& p, float x) {
  Point<D + 1> r;
  for (int d = 0; d < D; d++) r[d] = p[d];
  r[D] = x;
  return r;
}

// f at the point that a node of so many dimensions looks at: w alone, (x, y), (x, y, z) or (x, y, z, w).
template <class F>
auto atDimensions(int dimensions, Vec3f p, float w, F f) {
  switch (dimensions) {
    case 1:
      return f(Point<1>{{w}});
    case 2:
      return f(Point<2>{{p.x, p.y}});
    case 3:
      return f(Point<3>{{p.x, p.y, p.z}});
    default:
      return f(Point<4>{{p.x, p.y, p.z, w}});
  }
}

// Towards zero; the least integer for what none holds, as x86 converts.
constexpr int toInt(float x) {
  return x >= -0x1p31f && x < 0x1p31f ? static_cast<int>(x) : std::numeric_limits<int>::min();
}
// x in [lo, hi]; lo for NaN.
constexpr float limit(float x, float lo, float hi) { return x > lo ? (x < hi ? x : hi) : lo; }
// a + t (b - a)
constexpr float lerp(float a, float b, float t) { return a + t * (b - a); }
template <int D>
constexpr Point<D> lerp(const Point<D>& a, const Point<D>& b, float t) {
  return a.map(b, [t](float x, float y) { return lerp(x, y, t); });
}
constexpr Rgb lerp(Rgb a, Rgb b, float t) { return a + (b - a) * t; }
// Hermite's step from 0 to 1 over [0, 1]; 0 for NaN.
constexpr float smoothstep(float x) { return x > 0 ? (x < 1 ? (3 - 2 * x) * (x * x) : 1.0f) : 0.0f; }

}  // namespace wardmis::pattern
