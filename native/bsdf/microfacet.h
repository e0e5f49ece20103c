// SPDX-License-Identifier: GPL-3.0-or-later
// Reflection by rough surfaces of small mirrors, GGX and Beckmann, with Smith's masking and sampling of visible
// normals.
//   model      Walter, Marschner, Li and Torrance 2007, "Microfacet models for refraction through rough surfaces", EGSR
//   masking    Heitz 2014, "Understanding the masking-shadowing function in microfacet-based BRDFs", JCGT 3(2)
//   GGX        Dupuy and Benyoub 2023, "Sampling visible GGX normals with spherical caps", CGF 42(8)
//   Beckmann   Heitz and d'Eon 2014, "Importance sampling microfacet-based BSDFs with the distribution of visible
//              normals", EGSR: the slope's distribution inverted by Newton's method within a bracket
// Written over half vectors of any length, and over S(w) = |w.z| Lambda(w) in place of Lambda, which is infinite at the
// horizon: G1 = |w.z| / (|w.z| + S). Conventions as in ward.h. The reflectance of a single facet is 1 here
// (dielectric.h).
#pragma once

#include <limits>

#include "math/number.h"
#include "math/vec.h"

namespace wardmis {

enum class Distribution : uint8_t { kGgx, kBeckmann };
// How the masking of the two directions goes together. Cycles: as independent until 3.4, correlated by height since.
// kOfView: what facets send to the view is masked there alone.
enum class Masking : uint8_t { kSeparable, kCorrelated, kOfView };

template <class T>
struct MicrofacetValue {
  T fCos;  // f_s cos(theta_i), sr^-1
  T pdf;   // of the sampling by visible normals, sr^-1
};

// h without its length, as far as no square of it leaves the range.
template <class T>
inline Vec3<T> scaled(Vec3<T> h) {
  return h * (T(1) / std::max(std::abs(h.z), std::max(std::abs(h.x), std::abs(h.y))));
}

// Density of the normals per area of the mean surface, D(h), for a half vector of any length above the surface.
template <Distribution K, class T>
inline T normalDensity(Vec3<T> h, T invAx, T invAy) {
  const Vec3<T> m = scaled(h);
  const T x = m.x * invAx, y = m.y * invAy, length2 = dot(m, m), norm = invAx * invAy * (T(1) / kPi<T>);
  if constexpr (K == Distribution::kGgx) {
    const T q = (x * x + y * y + m.z * m.z) / length2;  // cos^2 (1 + tan^2/alpha^2)
    return norm / (q * q);
  } else {
    const T big = T(1e18f);  // e underflows to 0 long before, and 0 times its square is 0
    const T sx = x / m.z, sy = y / m.z, slope = length2 / (m.z * m.z);
    const T e = exp(-(sx * sx + sy * sy)), s = slope < big ? slope : big;
    return norm * e * s * s;
  }
}

// S(w) = |w.z| Lambda(w). Beckmann: Walter's rational approximation, which is what Cycles renders.
template <Distribution K, class T>
inline T masked(Vec3<T> w, T ax, T ay) {
  const T z = std::abs(w.z), t2 = square(ax * w.x) + square(ay * w.y);
  if constexpr (K == Distribution::kGgx) {
    return T(0.5) * t2 / (z + std::sqrt(z * z + t2));
  } else {
    const T t = std::sqrt(t2), a = z / t;  // t = 0: a is infinite or, at a denormal z, not a number
    return a < T(1.6) ? t * ((T(0.396) * a - T(1.259)) * a + T(1)) / (T(2.181) * a + T(3.535)) : T(0);
  }
}

// The same without approximation: what visible normals are distributed by.
template <Distribution K, class T>
inline T maskedExactly(Vec3<T> w, T ax, T ay) {
  if constexpr (K == Distribution::kGgx) {
    return masked<K>(w, ax, ay);
  } else {
    const T t = std::sqrt(square(ax * w.x) + square(ay * w.y)), a = std::abs(w.z) / t;
    const T s = T(0.5) * t * (std::exp(-a * a) / std::sqrt(kPi<T>) - a * std::erfc(a));
    return a < T(10) ? std::max(T(0), s) : T(0);
  }
}

// G2 / |wo.z| over the two directions' S: what D/4 is multiplied by.
template <class T>
inline T maskingOver(Masking masking, T zi, T si, T zo, T so) {
  if (masking == Masking::kOfView) return T(1) / (zo + so);
  return masking == Masking::kSeparable ? zi / ((zi + si) * (zo + so)) : zi / (zo * zi + si * zo + so * zi);
}

// f_s cos and pdf at one pair of directions, zero unless both lie above the surface.
template <Distribution K, class T>
inline MicrofacetValue<T> microfacetEvaluate(Masking masking, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return {T(0), T(0)};
  const T d = T(0.25) * normalDensity<K>(wi + wo, T(1) / ax, T(1) / ay);
  const T si = masked<K>(wi, ax, ay), so = masked<K>(wo, ax, ay);
  return {d * maskingOver(masking, wi.z, si, wo.z, so), d / (wo.z + maskedExactly<K>(wo, ax, ay))};
}

// How much more than f_s Cycles' samples of visible normals bring, as a share of it: it divides by the density that the
// masking of f_s would have, which of Beckmann is an approximation.
template <Distribution K, class T>
inline T microfacetSurplus(Vec3<T> wo, T ax, T ay) {
  if constexpr (K == Distribution::kGgx) return T(0);
  const T so = masked<K>(wo, ax, ay), exact = maskedExactly<K>(wo, ax, ay);
  return (so - exact) / (wo.z + exact);
}

// f_s cos and the surplus over pdf of a sampled direction: D cancels.
template <Distribution K, class T>
inline T microfacetWeight(Masking masking, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return T(0);
  const T si = masked<K>(wi, ax, ay), so = masked<K>(wo, ax, ay);
  return maskingOver(masking, wi.z, si, wo.z, so) * (wo.z + so);
}

// ln of normalDensity(), also where that underflows.
template <Distribution K, class T>
inline T logNormalDensity(Vec3<T> h, T invAx, T invAy) {
  if constexpr (K == Distribution::kGgx) {
    return std::log(normalDensity<K>(h, invAx, invAy));
  } else {
    const Vec3<T> m = scaled(h);
    const T sx = m.x / m.z * invAx, sy = m.y / m.z * invAy;
    return std::log(invAx) + std::log(invAy) - std::log(kPi<T>) - (sx * sx + sy * sy) +
           T(2) * (std::log(dot(m, m)) - T(2) * std::log(m.z));
  }
}

// ln of microfacetEvaluate().pdf; -infinity unless both directions are above.
template <Distribution K, class T>
inline T microfacetLogPdf(Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return -std::numeric_limits<T>::infinity();
  return logNormalDensity<K>(wi + wo, T(1) / ax, T(1) / ay) - std::log(T(4) * (wo.z + maskedExactly<K>(wo, ax, ay)));
}

// x <= c with F(x) = u F(c), F(x) = cosO erfc(-x)/2 + sinO exp(-x^2)/(2 sqrt(pi)): minus the visible slope of a
// Beckmann surface with alpha 1, seen at an angle with cotangent c. sinO = 0: a Gaussian with variance 1/2.
template <class T>
T beckmannSlope(T cosO, T sinO, T u) {
  const T rootPi = std::sqrt(kPi<T>), c = cosO / sinO, lowest = T(-6.5);
  const auto f = [&](T x) { return T(0.5) * (cosO * std::erfc(-x) + sinO / rootPi * std::exp(-x * x)); };
  T lo = lowest, hi = std::min(c, -lowest), x = T(0);
  const T target = u * f(hi);
  x = std::min(x, T(0.5) * hi);
  for (int i = 0; i < 60; ++i) {
    const T error = f(x) - target;
    if (std::abs(error) <= T(2) * std::numeric_limits<T>::epsilon() * target) break;  // the rounding of f
    (error > T(0) ? hi : lo) = x;
    const T next = x - error * rootPi / (std::exp(-x * x) * (cosO - x * sinO));
    const T moved = next > lo && next < hi ? next : T(0.5) * (lo + hi);
    const T step = std::abs(moved - x);
    x = moved;
    if (!(step > std::numeric_limits<T>::epsilon() * (T(1) + std::abs(x)))) break;
  }
  return x;
}

// A visible normal, of no particular length; m.z > 0 (Beckmann: 1).
template <Distribution K, class T>
inline Vec3<T> sampleNormal(Vec3<T> wo, T ax, T ay, Vec2<T> u) {
  const T tx = ax * wo.x, ty = ay * wo.y, t2 = tx * tx + ty * ty, l = std::sqrt(wo.z * wo.z + t2);
  if constexpr (K == Distribution::kGgx) {
    // uniform on the cap of the sphere around the stretched direction, no difference of nearly equal numbers in it
    const T cosO = wo.z / l, oneMinusCosO = t2 / (l * (l + wo.z));
    const T z = (T(1) - u.x) * (T(1) + cosO);
    const T r = std::sqrt(u.x * (T(1) + cosO) * (oneMinusCosO + z));
    T s, c;
    sincos2Pi(u.y, s, c);
    return {ax * (r * c + tx / l), ay * (r * s + ty / l), z};
  } else {
    const T t = std::sqrt(t2), cosPhi = t > T(0) ? tx / t : T(1), sinPhi = t > T(0) ? ty / t : T(0);
    const T x = -beckmannSlope(wo.z / l, t / l, u.x), y = beckmannSlope(T(1), T(0), u.y);
    return {ax * (cosPhi * x - sinPhi * y), ay * (sinPhi * x + cosPhi * y), T(1)};
  }
}

// wo mirrored at a normal of any length.
template <class T>
inline Vec3<T> mirrored(Vec3<T> wo, Vec3<T> m) {
  const Vec3<T> n = scaled(m);
  return n * (T(2) * dot(wo, n) / dot(n, n)) - wo;
}

// A direction with density microfacetEvaluate().pdf; below the surface its contribution is zero, and it counts.
template <Distribution K, class T>
inline Vec3<T> microfacetSample(Vec3<T> wo, T ax, T ay, Vec2<T> u) {
  return mirrored(wo, sampleNormal<K>(wo, ax, ay, u));
}

}  // namespace wardmis
