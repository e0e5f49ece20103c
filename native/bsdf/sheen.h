// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of cloth and of thin varnish, conventions as in ward.h.
//   velvet      Ashikhmin 2001, "Distribution-based BRDFs": an inverted Gaussian of normals, V-groove masking
//   Schlick     sheen of Principled in Cycles 3.4 (Burley 2012): (1 - wi.h)^5 cos(theta_i)
//   fibres      Zeltner, Burley and Chiang 2022, "Practical multiple-scattering sheen using linearly transformed
//   cosines":
//               a cosine lobe transformed by a matrix of two numbers, scaled to an albedo
//   clearcoat   of Principled in Cycles 3.4: D of Burley's GTR1, masking of GGX with alpha = 1/4
#pragma once

#include <limits>

#include "bsdf/microfacet.h"
#include "math/warp.h"

namespace wardmis {

// f_s cos of velvet. Cycles leaves out half vectors within 1e-5 of the normal's cosine or of a right angle to wo.
template <class T>
inline T velvetFCos(Vec3<T> wi, Vec3<T> wo, T sigma) {
  const Vec3<T> h = scaled(wi + wo);
  const T h2 = dot(h, h), sin2 = (h.x * h.x + h.y * h.y) / h2, cosH = h.z / std::sqrt(h2);
  const T cosHO = dot(h, wo) / std::sqrt(h2);
  if (!(cosH < T(1) - T(1e-5)) || !(cosHO > T(1e-5))) return T(0);
  const T inv = T(1) / (sigma * sigma);
  const T d = exp(-cosH * cosH / sin2 * inv) * inv / (kPi<T> * sin2 * sin2);
  const T g = std::min(T(1), T(2) * std::max(cosH / cosHO, T(1e-5)) * std::min(wi.z, wo.z));
  return T(0.25) * d * g / wo.z;
}

// f_s cos of Schlick's sheen.
template <class T>
inline T schlickSheenFCos(Vec3<T> wi, Vec3<T> wo) {
  const Vec3<T> apart = wi - wo;
  const T m = T(0.25) * dot(apart, apart) / (T(1) + T(0.5) * length(wi + wo));  // 1 - c = (1 - c^2)/(1 + c), c = wi.h
  return square(square(m)) * m * wi.z;
}

// Density of the transformed cosine, which is f_s cos for albedo 1: the plane of wo is that of its skewness.
template <class T>
inline T fibrePdf(Vec3<T> wi, Vec3<T> wo, T a, T b) {
  const T r = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const T c = r > T(0) ? wo.x / r : T(1), s = r > T(0) ? wo.y / r : T(0);
  const T x = c * wi.x + s * wi.y, y = c * wi.y - s * wi.x;
  const T length2 = square(a * x + b * wi.z) + square(a * y) + square(wi.z);
  return T(1) / kPi<T> * std::max(wi.z, T(0)) * square(a / length2);
}
template <class T>
inline Vec3<T> fibreSample(Vec3<T> wo, T a, T b, Vec2<T> u) {
  const T r = std::sqrt(wo.x * wo.x + wo.y * wo.y);
  const T c = r > T(0) ? wo.x / r : T(1), s = r > T(0) ? wo.y / r : T(0);
  const Vec3<T> cosine = toCosineHemisphere(u);
  const Vec3<T> w = normalize(Vec3<T>{cosine.x - cosine.z * b, cosine.y, cosine.z * a});
  return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

// (1 - alpha^2)/(-ln alpha^2), 1 at alpha = 1; L = -ln alpha^2.
template <class T>
inline T gtr1Norm(T l) {
  return l > T(1e-4) ? -std::expm1(-l) / l : T(1) - T(0.5) * l;
}
inline constexpr float kClearcoatMasking = 0.25f;  // alpha of its masking, whatever its roughness

// f_s cos of a mirror layer, and the density that Cycles takes its samples to have, G1 D/(4 cos(theta_o)). They are
// those of GGX with the same alpha.
template <class T>
inline MicrofacetValue<T> clearcoatEvaluate(Vec3<T> wi, Vec3<T> wo, T alpha) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return {T(0), T(0)};
  const Vec3<T> h = scaled(wi + wo);
  const T h2 = dot(h, h), q = (h.x * h.x + h.y * h.y + square(alpha * h.z)) / h2;  // sin^2 + alpha^2 cos^2
  const T d = T(0.25) * gtr1Norm(T(-2) * std::log(alpha)) / (kPi<T> * q), g = T(kClearcoatMasking);
  const T si = masked<Distribution::kGgx>(wi, g, g), so = masked<Distribution::kGgx>(wo, g, g);
  return {d * maskingOver(Masking::kSeparable, wi.z, si, wo.z, so), d / (wo.z + so)};
}
// f_s cos over that density.
template <class T>
inline T clearcoatWeight(Vec3<T> wi) {
  const T g = T(kClearcoatMasking);
  return wi.z > T(0) ? wi.z / (wi.z + masked<Distribution::kGgx>(wi, g, g)) : T(0);
}

}  // namespace wardmis
