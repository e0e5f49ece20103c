// SPDX-License-Identifier: GPL-3.0-or-later
// The reflecting surface at one hit: diffuse + Ward, with its inputs resolved to numbers.
//   f(wi, wo) = diffuse/pi + specular * ward(wi, wo)
#pragma once

#include "bsdf/batch.h"

namespace wardmis {

struct Surface {
  Rgb diffuse{0, 0, 0}, specular{0, 0, 0};  // albedo factors rho_d, rho_s
  float ax = 0.1f, ay = 0.1f;
  WardVariant variant = WardVariant::kWardGmd;

  bool hasDiffuse() const { return maxComponent(diffuse) > 0; }
  bool hasSpecular() const { return maxComponent(specular) > 0; }
  // Where the rounding of float directions shows in E, and the lobe is evaluated in double: a slope is rounded by
  // 6e-8/h_z, at grazing angles h_z is about alpha/(1 + |s|^2), near the horizon only cos(theta_o), and the narrower
  // alpha is what that is to be small against.
  bool needsDouble(float cosThetaO) const {
    const float narrow = std::min(ax, ay), wide = std::max(ax, ay);
    return narrow * std::min(narrow, cosThetaO) < 4e-6f * (1 + wide * wide);
  }
};

// f_s cos (rho_s = 1) and the lobe's pdf at one direction.
template <class T>
inline WardValue<T> evaluateWard(const Surface& s, Vec3<T> wi, Vec3<T> wo) {
  return wardEvaluate(s.variant, wi, wo, T(1) / T(s.ax), T(1) / T(s.ay));
}

// Below this many directions, one at a time is faster.
inline constexpr int kVectorised = 8;

// Fills specular and lobe of the first n directions, however few, with the bits of evaluateWard().
template <class T, int Capacity>
inline void evaluate(const Surface& s, Vec3<T> wo, Batch<T, Capacity>& b, int n) {
  wardBatch(s.variant, {n, b.x, b.y, b.z, b.specular, b.lobe}, wo, T(1) / T(s.ax), T(1) / T(s.ay));
}

}  // namespace wardmis
