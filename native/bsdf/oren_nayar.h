// SPDX-License-Identifier: GPL-3.0-or-later
// Diffuse reflection. Lambert, and Fujii's form of the model of Oren and Nayar 1994 ("improved Oren-Nayar", 2012) with
//   f_s = A + B t,  t = wi.wo - ci co, over max(ci, co) where it is positive,
//   A = 1/(pi + (pi/2 - 2/3) sigma),  B = sigma A,
// in Cycles 3.4 alone, since 4.x with the light that is reflected more than once (OpenPBR specification):
//   f_ms = rho^2 Eavg/(1 - Eavg)/(1 - rho (1 - Eavg)) (1 - E(ci)) (1 - E(co)) / pi,  to be multiplied by rho as f_s is.
// Both are sampled by the cosine. Conventions as in ward.h.
#pragma once

#include "math/number.h"
#include "math/vec.h"
#include "math/warp.h"

namespace wardmis {

// Coefficients of the model: of a roughness in [0, 1].
template <class T>
struct OrenNayar {
  T a, b;
  static OrenNayar of(T sigma) {
    const T a = T(1) / (kPi<T> + (kPi<T> / 2 - T(2) / 3) * sigma);
    return {a, sigma * a};
  }
  // Albedo of f_s at a cosine: pi A + B G(c), in angles theta and sin(theta).
  T albedo(T c) const {
    const T s = std::sqrt(std::max(T(0), (T(1) - c) * (T(1) + c)));
    const T third = T(2) / 3;
    // (1 - s^3)/c = c (1 + s + s^2)/(1 + s): no quotient of two small numbers at the horizon
    const T g = s * (std::acos(std::min(c, T(1))) - third - s * c) + third * s * c * (T(1) + s + s * s) / (T(1) + s);
    return kPi<T> * a + b * g;
  }
  // Its mean over the hemisphere, weighted by the cosine; Cycles' constant, 5.6/3 for 1.866...
  T meanAlbedo() const { return kPi<T> * a + (2 * kPi<T> - T(5.6)) / 3 * b; }
};

// f_s alone. A view from below the normal counts as one along the surface, as in Cycles.
template <class T>
inline T orenNayarF(Vec3<T> wi, Vec3<T> wo, T a, T b) {
  const T t = wi.x * wo.x + wi.y * wo.y + wi.z * std::min(wo.z, T(0));  // wi.wo - ci max(co, 0)
  const T over = t > T(0) ? std::max(wi.z, wo.z) : T(1);
  return a + b * t / over;
}

// The part of f_ms without (1 - E(ci)), at the albedo rho of a channel: constant over wi.
template <class T>
inline T orenNayarMultiple(OrenNayar<T> model, T rho, T cosThetaO) {
  const T mean = model.meanAlbedo();
  return T(1) / kPi<T> * rho * rho * (mean / (T(1) - mean)) / (T(1) - rho * (T(1) - mean)) *
         (T(1) - model.albedo(std::max(cosThetaO, T(0))));
}

// Diffuse reflection of Principled in Cycles 3.4: Burley 2012 ("Physically based shading at Disney") in the form of
// 2015.
template <class T>
inline T burleyF(Vec3<T> wi, Vec3<T> wo, T roughness) {
  const auto schlick = [](T c) {
    const T m = std::clamp(T(1) - c, T(0), T(1));
    return square(square(m)) * m;
  };
  const T fi = schlick(wi.z), fo = schlick(wo.z);
  const T retro = roughness * (dot(wi, wo) + T(1));  // 2 roughness cos^2 of the half angle
  return T(1) / kPi<T> * ((T(1) - T(0.5) * fo) * (T(1) - T(0.5) * fi) + retro * (fi + fo + fi * fo * (retro - T(1))));
}

}  // namespace wardmis
