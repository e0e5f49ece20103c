// SPDX-License-Identifier: GPL-3.0-or-later
// The reflecting surface at one hit: diffuse + Ward, with its inputs resolved to numbers.
//   f(wi, wo) = diffuse/pi + specular * ward(wi, wo)
#pragma once

#include <array>

#include "bsdf/batch.h"
#include "bsdf/shadow_terminator.h"
#include "math/component.h"

namespace wardmis {

struct Surface {
  Rgb diffuse{0, 0, 0}, specular{0, 0, 0};  // albedo factors rho_d, rho_s
  float ax = 0.1f, ay = 0.1f;
  WardVariant variant = WardVariant::kWardGmd;
  float terminator = 1;  // as of shadow_terminator.h

  bool hasDiffuse() const { return maxComponent(diffuse) > 0; }
  bool hasSpecular() const { return maxComponent(specular) > 0; }

  static constexpr Rgb transparent{0, 0, 0};  // what goes straight through
  bool reflects() const { return hasDiffuse() || hasSpecular(); }
  Rgb albedo() const { return diffuse + specular; }
  PerComponent colors() const { return {diffuse, specular, Rgb{0, 0, 0}}; }

  // The lobes by number: the first is Ward's.
  bool hasLobe(size_t lobe) const { return lobe == 0 && hasSpecular(); }
  Rgb lobeWeight(size_t) const { return specular; }
  float strength(size_t) const { return luminance(specular); }
  float diffuseStrength() const { return luminance(diffuse); }
  float strength() const { return luminance(specular) + luminance(diffuse); }
  template <class T>
  Vec3<T> sampleLobe(size_t, Vec3<T> wo, Vec2<T> u) const {
    return wardSample<T>(wo, T(ax), T(ay), u);
  }
  // f_s cos (weight 1) and the lobe's pdf at one direction.
  template <class T>
  WardValue<T> evaluateLobe(size_t, Vec3<T> wi, Vec3<T> wo) const {
    return wardEvaluate(variant, wi, wo, T(1) / T(ax), T(1) / T(ay));
  }
  // The same of the first n directions, however few, with the same bits.
  template <class T, size_t Lobes, int Capacity>
  void evaluateLobe(size_t lobe, Vec3<T> wo, LobeBatch<T, Lobes, Capacity>& b, int n) const {
    wardBatch(variant, {n, b.x, b.y, b.z, b.fCos[lobe], b.pdf[lobe]}, wo, T(1) / T(ax), T(1) / T(ay));
  }
  // Where the rounding of float directions shows in E, and the lobe is evaluated in double: a slope is rounded by
  // 6e-8/h_z, at grazing angles h_z is about alpha/(1 + |s|^2), near the horizon only cos(theta_o), and the narrower
  // alpha is what that is to be small against.
  bool needsDouble(float cosThetaO) const {
    const float narrow = std::min(ax, ay), wide = std::max(ax, ay);
    return narrow * std::min(narrow, cosThetaO) < 4e-6f * (1 + wide * wide);
  }
};

// Below this many directions, one at a time is faster.
inline constexpr int kVectorised = 8;

}  // namespace wardmis
