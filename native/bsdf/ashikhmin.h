// SPDX-License-Identifier: GPL-3.0-or-later
// The lobe of Ashikhmin and Shirley 2000, "An anisotropic Phong BRDF model", without its Fresnel factor, as Cycles has
// it:
//   f_s = sqrt((nx + 1)(ny + 1))/(8 pi) cos(theta_h)^e / (wi.h max(ci, co)),  e = nx cos^2(phi_h) + ny sin^2(phi_h),
// with n = 2/alpha^2 - 2. Conventions as in ward.h.
// Half vectors that look away from the view Cycles turns over, but keeps their cosine c = wo.h < 0: the samples leave
// along 2|c| h - wo, no mirror's direction and longer than 1, within 30 degrees of straight ahead. At grazing views
// that is above the surface. Its light samples, and the density that it divides by, know nothing of them: the strays.
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

// ln of the density of half vectors that look towards the view, as one of wi; -infinity unless both are above.
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

// f_s cos / pdf of half vectors that look towards the view; wi of the length that Cycles gives it.
template <class T>
inline T ashikhminWeight(Vec3<T> wi, Vec3<T> wo) {
  return wi.z > T(0) && wo.z > T(0) ? wi.z / std::max(wi.z, wo.z) : T(0);
}

// Calls add(f_s cos, density, counted) of the strays that leave along wi; counted: the density that Cycles takes theirs
// to be. Each direction is that of two half vectors, at angles beta to -wo with sin(2 beta - delta) = 2 sin(delta),
// where delta is its own.
template <class T, class Add>
inline void ashikhminStrays(Vec3<T> wi, Vec3<T> wo, T ax, T ay, Add&& add) {
  const T c = -dot(wi, wo), s = length(cross(wi, wo)), q2 = (T(1) - T(2) * s) * (T(1) + T(2) * s);
  if (!(wi.z > T(0)) || !(wo.z > T(0)) || !(c > T(0)) || !(s > T(0)) || !(q2 > T(0))) return;
  const T nx = ashikhminExponent(ax), ny = ashikhminExponent(ay), q = std::sqrt(q2);
  const Vec3<T> across = (wi + wo * c) * (T(1) / s);
  const T norm = std::sqrt(nx + T(1)) * std::sqrt(ny + T(1)) / (2 * kPi<T>);
  const auto of = [&](T cosBeta, T sinBeta, T stretch) {  // stretch: d omega_h / d omega_i
    const Vec3<T> h = across * sinBeta - wo * cosBeta;
    if (!(h.z > T(0)) || !(cosBeta > T(0))) return;
    const T facets = norm * std::exp(ashikhminLogPower(h, nx, ny)), density = facets * stretch;
    if (!(facets > std::numeric_limits<T>::min())) return;
    add(density * ashikhminWeight(wi * std::sqrt(T(1) + T(8) * cosBeta * cosBeta), wo), density,
        facets / (T(4) * cosBeta));
  };
  const T near = std::sqrt(T(0.5) * (T(1) + c * q - T(2) * s * s));  // cos(beta) of the one that is nearer to -wo
  of(near, s * (q + T(2) * c) / (T(2) * near), square(q + T(2) * c) / (T(4) * near * q));
  const T far = std::sqrt(T(0.5) * (T(1) + c * q + T(2) * s * s));  // sin(beta) of the other
  of(s * (T(2) * c - q) / (T(2) * far), far, far * (T(2) * c - q) / (T(2) * s * q));
}
// The density of ashikhminSample().
template <class T>
inline T ashikhminSampledPdf(Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  T sum = ashikhminPdf(wi, wo, ax, ay);
  ashikhminStrays(wi, wo, ax, ay, [&](T, T pdf, T) { sum += pdf; });
  return sum;
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
  const Vec3<T> h{sine * cosPhi, sine * sinPhi, std::exp(lnCos)};
  const T cosine = dot(wo, h);
  return cosine < T(0) ? normalize(h * (T(-2) * cosine) - wo) : mirrored(wo, h);
}

}  // namespace wardmis
