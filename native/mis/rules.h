// SPDX-License-Identifier: GPL-3.0-or-later
// The names of the rules by which samples are shared (allocations) and weighted. docs/theory.md has each one's source.
#pragma once

#include <cstdint>
#include <string_view>

namespace wardmis {

enum class Allocation : uint8_t {
  kEqual,              // Def. 7: n_i = N/n
  kVariance,           // Def. 8: proportional to sigma^2_i,eq
  kStandardDeviation,  // Sbert et al. 2018: sigma_i,eq
  kSecondMoment,       // Def. 9: 1/m^2_i
  kInverseVariance,    // 1/(m^2_i - mu^2)
  kEqualised,          // Havran and Sbert 2014: equal second moments, the minimum of integral f^2/q
  kLinear,             // Sbert and Szirmay-Kalos 2023: least-squares fit of the mixture to f, a linear system
  kSecondOrder,        // Lu et al. 2013: one Newton step from equal counts; two techniques
  kRepresentativity,   // after Pajot et al. 2011: mu_i,eq, the technique's share of the integral
  kBest,               // the minimum of N Var with balance weights, found numerically: the yardstick
  kAlbedo,  // half to the light, half to the lobes by albedo: the usual path tracer's one BSDF and one light sample
  kAuto,    // least predicted variance x cost over the pilot's samples
};

enum class Weights : uint8_t {
  kBalance,        // a_i p_i, a = n
  kNonbalance,     // p_i (Eq. 14)
  kPower,          // (a_i p_i)^2 (Veach and Guibas 1995)
  kCutoff,         // a_i p_i, dropped below a tenth of the largest (Veach and Guibas 1995)
  kMaximum,        // the largest a_i p_i takes all, equal ones share as in balance (Veach and Guibas 1995)
  kVarianceAware,  // v_i a_i p_i, v_i = m^2_i/(m^2_i - mu^2) (Grittmann et al. 2019)
  kOptimal,        // Kondapaneni et al. 2019, for given fractions
};
// What a_i p_i must be of the largest to count. Of `maximum` it is 1 but for rounding: where two techniques have the
// same density, which of the two computed values is larger is chance, and the estimate must not hang on it.
inline constexpr double kCutoffRatio = 0.1;
template <class T>
inline constexpr T kTieRatio = T(1) - T(1e-9);
template <>
inline constexpr float kTieRatio<float> = 1 - 1e-6f;

std::string_view name(Allocation);
std::string_view name(Weights);

// The weights that the paper pairs with an allocation.
constexpr Weights paperWeights(Allocation a) {
  return a == Allocation::kVariance || a == Allocation::kStandardDeviation ? Weights::kNonbalance : Weights::kBalance;
}
// Whether the allocation asks for moments, that is, for a pilot.
constexpr bool needsMoments(Allocation a) { return a != Allocation::kEqual && a != Allocation::kAlbedo; }

}  // namespace wardmis
