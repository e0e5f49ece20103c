// SPDX-License-Identifier: GPL-3.0-or-later
// What a smooth interface does: Fresnel's reflectance and its coloured relatives, refraction, and refraction by rough
// surfaces (Walter et al. 2007, of which the equations are).
// eta: index of refraction of the side that light is refracted to, over that of wo's. Conventions as in ward.h; wi lies
// below the surface. Radiance is not scaled by eta^2, as in Cycles: what is not reflected is transmitted, and
//   f(wi, wo, eta) = eta^2 f(wo, wi, 1/eta),  seen from below in the second.
#pragma once

#include "bsdf/microfacet.h"

namespace wardmis {

// eta^2 - 1 without cancellation.
template <class T>
inline T etaSquaredMinus1(T eta) {
  return (eta - T(1)) * (eta + T(1));
}

// Unpolarised reflectance at cosine c >= 0 of the side of wo; 1 in total internal reflection.
template <class T>
inline T fresnelDielectric(T c, T eta) {
  const T k = etaSquaredMinus1(eta), c2 = c * c, g2 = k + c2;
  if (!(g2 > T(0))) return T(1);
  const T g = std::sqrt(g2);
  const T rs = -k / square(c + g);                                                // (c - g)/(c + g)
  const T rp = k * (c2 * (eta * eta + T(1)) - T(1)) / square(eta * eta * c + g);  // (eta^2 c - g)/(eta^2 c + g)
  return T(0.5) * (rs * rs + rp * rp);
}

// At normal incidence.
template <class T>
inline T fresnelNormal(T eta) {
  return square((eta - T(1)) / (eta + T(1)));
}

// How far the reflectance has gone from that at normal incidence to 1: what Cycles blends F0 and white by.
template <class T>
inline T fresnelBlend(T c, T eta) {
  const T f0 = fresnelNormal(eta);
  return std::clamp((fresnelDielectric(c, eta) - f0) / (T(1) - f0), T(0), T(1));
}

// F82-tint (Kutz, Hasan and Edmondson 2021, "Novel aspects of the Adobe Standard Material"): Schlick's reflectance of
// f0 less b c (1 - c)^6, so that it is multiplied by the tint at cos = 1/7.
template <class T>
inline T fresnelF82(T c, T f0, T b) {
  const T m = std::clamp(T(1) - c, T(0), T(1)), m5 = square(square(m)) * m;
  return std::clamp(f0 + (T(1) - f0) * m5 - b * c * m5 * m, T(0), T(1));
}
inline float f82Edge(float f0, float tint) {  // b
  const float m = 6.0f / 7.0f, m5 = square(square(m)) * m;
  return (f0 + (1 - f0) * m5) * (7 / (m5 * m)) * (1 - tint);
}

// wo refracted at a normal m of any length, wo.m > 0; false in total internal reflection.
template <class T>
inline bool refracted(Vec3<T> wo, Vec3<T> m, T eta, Vec3<T>& wi) {
  Vec3<T> n = scaled(m);
  n = n * (T(1) / length(n));
  const T k = etaSquaredMinus1(eta), c = dot(wo, n), g2 = k + c * c;
  if (!(g2 > T(0)) || !(c > T(0))) return false;
  wi = (wo + n * (k / (c + std::sqrt(g2)))) * (T(-1) / eta);  // -wo/eta + (c/eta - cos(theta_t)) n
  return true;
}

// The normal that refracts wo into wi, scaled by |eta wi + wo| (eq. 16), turned to wo's side. wi + wo first: for eta
// near 1 that is exact.
template <class T>
inline Vec3<T> refractionHalf(Vec3<T> wi, Vec3<T> wo, T eta) {
  const Vec3<T> h = -((wi + wo) + wi * (eta - T(1)));
  return dot(h, wo) < T(0) ? -h : h;
}

// True if a facet with normal h, facing up, does refract wo into wi. For eta < 1 that may lie above the mean surface.
template <class T>
inline bool refracts(Vec3<T> wi, Vec3<T> wo, Vec3<T> h) {
  return wo.z > T(0) && h.z > T(0) && dot(h, wo) > T(0) && dot(h, wi) < T(0);
}

// d omega_m / d omega_i (eq. 17) times |wo.m|; h from refractionHalf(), with its length.
template <class T>
inline T refractionJacobian(Vec3<T> wi, Vec3<T> wo, Vec3<T> h, T eta) {
  const T l2 = dot(h, h);
  return eta * eta * std::abs(dot(wi, h) / l2) * (dot(wo, h) / l2);
}

namespace detail {
template <Distribution K, class T>
inline MicrofacetValue<T> refractionValue(Masking masking, Vec3<T> wi, Vec3<T> wo, Vec3<T> h, T ax, T ay, T eta) {
  const T d = normalDensity<K>(h, T(1) / ax, T(1) / ay) * refractionJacobian(wi, wo, h, eta);
  const T si = masked<K>(wi, ax, ay), so = masked<K>(wo, ax, ay);
  return {d * maskingOver(masking, std::abs(wi.z), si, wo.z, so), d / (wo.z + maskedExactly<K>(wo, ax, ay))};
}
}  // namespace detail

// f_s cos and pdf of refraction with transmittance 1 of each facet (eq. 21), zero where no facet refracts so.
template <Distribution K, class T>
inline MicrofacetValue<T> refractionEvaluate(Masking masking, Vec3<T> wi, Vec3<T> wo, T ax, T ay, T eta) {
  const Vec3<T> h = refractionHalf(wi, wo, eta);
  return refracts(wi, wo, h) ? detail::refractionValue<K>(masking, wi, wo, h, ax, ay, eta) : MicrofacetValue<T>{};
}

// The formulas' value where none does, since it would have to face down, or to have both directions on one side: zero
// where one does. Cycles takes it for f_s cos and pdf, although its own samples never go there.
template <Distribution K, class T>
inline MicrofacetValue<T> unseenRefraction(Masking masking, Vec3<T> wi, Vec3<T> wo, T ax, T ay, T eta) {
  const Vec3<T> h = refractionHalf(wi, wo, eta);
  if (!(wi.z < T(0)) || !(wo.z > T(0)) || h.z == T(0) || refracts(wi, wo, h)) return {};
  return detail::refractionValue<K>(masking, wi, wo, h, ax, ay, eta);
}

template <Distribution K, class T>
inline T refractionWeight(Masking masking, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z < T(0)) || !(wo.z > T(0))) return T(0);
  return microfacetWeight<K>(masking, Vec3<T>{wi.x, wi.y, -wi.z}, wo, ax, ay);
}

template <Distribution K, class T>
inline T refractionLogPdf(Vec3<T> wi, Vec3<T> wo, T ax, T ay, T eta) {
  const Vec3<T> h = refractionHalf(wi, wo, eta);
  if (!refracts(wi, wo, h)) return -std::numeric_limits<T>::infinity();
  return logNormalDensity<K>(h, T(1) / ax, T(1) / ay) + std::log(refractionJacobian(wi, wo, h, eta)) -
         std::log(wo.z + maskedExactly<K>(wo, ax, ay));
}

// In total internal reflection along the horizon, where this lobe is zero; it counts.
template <Distribution K, class T>
inline Vec3<T> refractionSample(Vec3<T> wo, T ax, T ay, T eta, Vec2<T> u) {
  Vec3<T> wi{T(1), T(0), T(0)};
  refracted(wo, sampleNormal<K>(wo, ax, ay, u), eta, wi);
  return wi;
}

}  // namespace wardmis
