// SPDX-License-Identifier: GPL-3.0-or-later
// Maps from the unit square, u in [0, 1)^2, to the domains that are sampled.
#pragma once

#include "math/number.h"
#include "math/vec.h"

namespace wardmis {

// Uniform on the unit disk (polar map). Density 1/pi.
template <class T>
Vec2<T> toDisk(Vec2<T> u) {
  const T r = std::sqrt(u.x);
  T s, c;
  sincos2Pi(u.y, s, c);
  return {r * c, r * s};
}

// On the unit disk, as densely as a cone over it is high. Density 3 (1 - r)/pi.
template <class T>
Vec2<T> toConeOverDisk(Vec2<T> u) {
  // r^2 (3 - 2r) = u
  const T r = T(0.5) - std::sin(std::asin(T(1) - T(2) * u.x) / T(3));
  T s, c;
  sincos2Pi(u.y, s, c);
  return {r * c, r * s};
}

// Cosine-weighted on the upper hemisphere. Density cos/pi per solid angle.
template <class T>
Vec3<T> toCosineHemisphere(Vec2<T> u) {
  const Vec2<T> d = toDisk(u);
  return {d.x, d.y, std::sqrt(std::max(T(0), T(1) - u.x))};
}

// Uniform in the cone of directions around +z with 1 - cos(half angle) = oneMinusCos. Density 1/(2 pi oneMinusCos).
template <class T>
Vec3<T> toCone(Vec2<T> u, T oneMinusCos) {
  const T h = u.x * oneMinusCos;  // 1 - cos of the sampled angle: exact for narrow cones
  const T sinTheta = std::sqrt(std::max(T(0), h * (T(2) - h)));
  T s, c;
  sincos2Pi(u.y, s, c);
  return {sinTheta * c, sinTheta * s, T(1) - h};
}

// Uniform on a triangle: barycentric weights of the second and third vertex. Density 1/area.
template <class T>
Vec2<T> toTriangle(Vec2<T> u) {
  const T r = std::sqrt(u.x);
  return {r * (T(1) - u.y), r * u.y};
}

}  // namespace wardmis
