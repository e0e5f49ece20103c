// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe of Ashikhmin and Shirley 2000, "An anisotropic Phong BRDF model", without its Fresnel factor, as Cycles has
// it:
//   f_s = sqrt((nx + 1)(ny + 1))/(8 pi) cos(theta_h)^e / (wi.h max(ci, co)),  e = nx cos^2(phi_h) + ny sin^2(phi_h),
// with n = 2/alpha^2 - 2. Conventions as in ward.h.
#pragma once

#include <limits>

#include "bsdf/microfacet.h"

namespace wardmis {

template <class T>
inline T ashikhminExponent(T alpha) {
  return T(2) / (alpha * alpha) - T(2);
}

// ln cos(theta_h)^e; h of any length.
template <class T>
inline T ashikhminLogPower(Vec3<T> h, T nx, T ny) {
  const Vec3<T> m = scaled(h);
  const T m2 = dot(m, m), sin2 = (m.x * m.x + m.y * m.y) / m2;
  const T lnCos = sin2 < T(0.5) ? T(0.5) * std::log1p(-sin2) : std::log(m.z) - T(0.5) * std::log(m2);
  return (sin2 > T(1e-6) ? lnCos / sin2 : T(-0.5) - T(0.25) * sin2) * (nx * m.x * m.x + ny * m.y * m.y) / m2;
}

// ln of the density of ashikhminSample(); -infinity unless both directions are above.
template <class T>
inline T ashikhminLogPdf(Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return -std::numeric_limits<T>::infinity();
  const T nx = ashikhminExponent(ax), ny = ashikhminExponent(ay);
  const T h = length(wi + wo);  // wi.h = |wi + wo|/2
  return T(0.5) * (std::log(nx + T(1)) + std::log(ny + T(1))) - std::log(T(4) * kPi<T>) +
         ashikhminLogPower(wi + wo, nx, ny) - std::log(h);
}
template <class T>
inline T ashikhminPdf(Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return T(0);
  const T nx = ashikhminExponent(ax), ny = ashikhminExponent(ay);
  return std::sqrt(nx + T(1)) * std::sqrt(ny + T(1)) / (4 * kPi<T> * length(wi + wo)) *
         std::exp(ashikhminLogPower(wi + wo, nx, ny));
}

// f_s cos / pdf.
template <class T>
inline T ashikhminWeight(Vec3<T> wi, Vec3<T> wo) {
  return wi.z > T(0) && wo.z > T(0) ? wi.z / std::max(wi.z, wo.z) : T(0);
}

template <class T>
inline Vec3<T> ashikhminSample(Vec3<T> wo, T ax, T ay, Vec2<T> u) {
  const T nx = ashikhminExponent(ax), ny = ashikhminExponent(ay);
  T s, c;
  sincos2Pi(u.y, s, c);
  c /= std::sqrt(nx + T(1)), s /= std::sqrt(ny + T(1));
  const T r = std::sqrt(c * c + s * s), cosPhi = c / r, sinPhi = s / r;
  const T lnCos = -minusLog1m(u.x) / (nx * cosPhi * cosPhi + ny * sinPhi * sinPhi + T(1));
  const T sine = std::sqrt(-std::expm1(T(2) * lnCos));
  return mirrored(wo, Vec3<T>{sine * cosPhi, sine * sinPhi, std::exp(lnCos)});
}

}  // namespace wardmis
