// SPDX-License-Identifier: GPL-3.0-or-later
// The reflecting surface at one hit: diffuse + Ward, with its inputs resolved to numbers.
//   f(wi, wo) = diffuse/pi + specular * ward(wi, wo)
#pragma once

#include "bsdf/ward.h"

namespace wardmis {

struct Surface {
  Rgb diffuse{0, 0, 0}, specular{0, 0, 0};  // albedo factors rho_d, rho_s
  float ax = 0.1f, ay = 0.1f;
  WardVariant variant = WardVariant::kWardGmd;

  bool hasDiffuse() const { return maxComponent(diffuse) > 0; }
  bool hasSpecular() const { return maxComponent(specular) > 0; }
  // Below this alpha the rounding of float directions shows in E, and the lobe is evaluated in double (docs/theory.md).
  bool needsDouble() const { return std::min(ax, ay) < 2e-3f; }
};

// Directions of the samples at one hit, and what the surface says of them: structure of arrays, so that evaluation
// is one vectorised loop. Local frame; densities per solid angle.
template <class T, int Capacity>
struct Batch {
  T x[Capacity], y[Capacity], z[Capacity];  // wi
  T specular[Capacity];                     // f_s cos for rho_s = 1
  T lobe[Capacity];                         // the lobe technique's pdf

  Vec3<T> wi(int j) const { return {x[j], y[j], z[j]}; }
  void set(int j, Vec3<T> wi) { x[j] = wi.x, y[j] = wi.y, z[j] = wi.z; }
};

// f_s cos (rho_s = 1) and the lobe's pdf at one direction.
template <class T>
inline WardValue<T> evaluateWard(const Surface& s, Vec3<T> wi, Vec3<T> wo) {
  return wardEvaluate(s.variant, wi, wo, T(1) / T(s.ax), T(1) / T(s.ay));
}

// The same for the first n directions of a batch, in one vectorised loop.
template <WardVariant V, class T, int Capacity>
inline void evaluateWard(Batch<T, Capacity>& b, int n, Vec3<T> wo, T invAx, T invAy) {
  for (int j = 0; j < n; ++j) {
    const WardValue<T> w = wardEvaluate<V>({b.x[j], b.y[j], b.z[j]}, wo, invAx, invAy);
    b.specular[j] = w.fCos;
    b.lobe[j] = w.pdf;
  }
}

// Below this many directions, one at a time is faster.
inline constexpr int kVectorised = 8;

// Fills specular and lobe of the first n directions, however few.
template <class T, int Capacity>
inline void evaluate(const Surface& s, Vec3<T> wo, Batch<T, Capacity>& b, int n) {
  const T invAx = T(1) / T(s.ax), invAy = T(1) / T(s.ay);
  switch (s.variant) {
    case WardVariant::kWard:
      return evaluateWard<WardVariant::kWard>(b, n, wo, invAx, invAy);
    case WardVariant::kWardDur:
      return evaluateWard<WardVariant::kWardDur>(b, n, wo, invAx, invAy);
    case WardVariant::kWardGmd:
      return evaluateWard<WardVariant::kWardGmd>(b, n, wo, invAx, invAy);
  }
}

}  // namespace wardmis
