// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe of Lafortune and Willems 1994, "Using the modified Phong reflectance model", the paper's first example:
//   f_s = rho_s (m + 2)/(2 pi) max(0, cos gamma)^m,  gamma: angle between wi and the mirror direction of wo,
// sampled with p = (m + 1)/(2 pi) cos(gamma)^m. (The paper's cos^m(theta_i) is its case theta_o = 0.) Conventions as in
// ward.h.
#pragma once

#include <limits>

#include "math/number.h"
#include "math/vec.h"

namespace wardmis {

template <class T>
struct PhongValue {
  T f;    // rho_s = 1: f_s, sr^-1
  T pdf;  // sr^-1
};

// From cos(gamma); zero beyond a right angle.
template <class T>
PhongValue<T> phongEvaluate(T cosGamma, T m) {
  if (!(cosGamma > T(0))) return {T(0), T(0)};
  const T power = std::pow(cosGamma, m) / (2 * kPi<T>);
  return {(m + 2) * power, (m + 1) * power};
}

// ln of phongEvaluate().pdf, also where that underflows.
template <class T>
T phongLogPdf(T cosGamma, T m) {
  if (!(cosGamma > T(0))) return -std::numeric_limits<T>::infinity();
  return std::log((m + 1) / (2 * kPi<T>)) + m * std::log(cosGamma);
}

// f_s cos(theta_i) / pdf for rho_s = 1.
template <class T>
T phongWeight(T cosGamma, T cosThetaI, T m) {
  return cosGamma > T(0) ? (m + 2) / (m + 1) * cosThetaI : T(0);
}

template <class T>
T phongCosGamma(Vec3<T> wi, Vec3<T> wo) {
  return wi.z * wo.z - wi.x * wo.x - wi.y * wo.y;
}

// Below the surface (wi.z <= 0) the contribution is zero, and it counts.
template <class T>
Vec3<T> phongSample(Vec3<T> wo, T m, Vec2<T> u) {
  const T lnCos = -minusLog1m(u.x) / (m + 1);  // cos(gamma)^(m+1) = 1 - u1
  const T c = std::exp(lnCos), s = std::sqrt(-std::expm1(2 * lnCos));
  T sinPhi, cosPhi;
  sincos2Pi(u.y, sinPhi, cosPhi);
  return Frame<T>::around(Vec3<T>{-wo.x, -wo.y, wo.z}).toWorld({s * cosPhi, s * sinPhi, c});
}

}  // namespace wardmis
