// SPDX-License-Identifier: GPL-3.0-or-later
// How the samples of a hit are shared between techniques, as data: expected counts n_i and weight coefficients a_i.
// The multi-sample estimator (Veach 1995; the paper's Eq. 3) of the integral of f, with X_ij of density p_i:
//   F = sum_i 1/n_i sum_j w_i(X_ij) f(X_ij)/p_i(X_ij),   w_i = (a_i p_i)^beta / sum_k (a_k p_k)^beta
// Balance weights are a = n, beta = 1; the paper's Eq. 14 is a = 1 ("nonbalance"); the power heuristic a = n, beta = 2;
// cutoff and maximum are rules.h's.
// n_i is an expected count: the actual one is n_i rounded up or down at random (systematicCounts), independently of the
// samples, so that F is unbiased for any n_i > 0.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "mis/moments.h"
#include "mis/rules.h"

namespace wardmis {

enum class Integrand : uint8_t { kSplit, kJoint };

// The techniques of the integrand that a surface technique is drawn for: of split integrands itself and the light.
template <size_t K>
constexpr TechniqueMask techniquesFor(Integrand integrand, size_t own) {
  return integrand == Integrand::kJoint ? Techniques<K>::kAll
                                        : static_cast<TechniqueMask>(maskOf(own) | maskOf(Techniques<K>::kLight));
}

// One of each integrand of a hit: by its own technique, a lobe or cosine; joint, the first alone.
template <class T, size_t K>
using PerIntegrand = std::array<T, Techniques<K>::kSurface>;

// Fractions of one integrand's techniques (those in `used`), from its moments; they sum to 1 over `used`.
// Equal where the moments say nothing (a zero, not finite). Clamped to [minimum, 1 - (n-1) minimum].
template <size_t K>
Fractions<K> allocate(Allocation rule, const Moments<K>& m, TechniqueMask used, float minimum);

// Fractions of a hit with several integrands, each with the same budget and its own fractions of it: its own technique
// and light. Light samples serve all, so the largest of the demands is drawn, and what that saves goes to all in
// proportion. Each integrand has at least the samples that it asked for.
template <size_t K>
Fractions<K> combineSplit(const PerIntegrand<Fractions<K>, K>& each);

// The fractions of split integrands, of the techniques `available`; an integrand without its own technique asks for
// nothing.
template <size_t K>
Fractions<K> allocateSplit(Allocation rule, const PerIntegrand<Moments<K>, K>& moments, TechniqueMask available,
                           float minimum);

// Whether every technique of `available` gets samples. A hit that has more techniques than its pixel's fractions know
// of (at an edge) must not use them: light that only the missing one finds would be lost.
template <size_t K>
constexpr bool covers(const Fractions<K>& a, TechniqueMask available) {
  for (size_t i = 0; i < K; ++i)
    if (has(available, i) && !(a[i] > 0)) return false;
  return true;
}

// Restricts fractions to the techniques that a hit has, and renormalises.
template <size_t K>
Fractions<K> restrict(const Fractions<K>& a, TechniqueMask available);

// Number of samples of each technique at one hit: n points (j + u)/n over the cumulated fractions. Each count is n a_i
// rounded up or down, their sum is n, and its mean over u uniform in [0, 1) is n a_i exactly.
template <size_t K>
std::array<int, K> systematicCounts(const Fractions<K>& a, int n, float u) {
  std::array<int, K> counts{};
  size_t last = K - 1;  // takes what is left; never a technique without a share
  while (last > 0 && !(a[last] > 0)) --last;
  float cumulated = 0;
  int before = 0;
  for (size_t i = 0; i < last; ++i) {
    cumulated += a[i];
    // points below the cumulated fraction: the number of j with (j + u)/n < cumulated, exact in double
    const int below = std::min(n, std::max(before, static_cast<int>(std::ceil(double(cumulated) * n - double(u)))));
    counts[i] = below - before;
    before = below;
  }
  counts[last] = n - before;
  return counts;
}

// Fractions rounded so that the counts of `visits` hits of n samples are whole numbers, at least one where there was a
// share: with u evenly spread over the visits, systematicCounts then gives these very counts. Without it a pixel's
// total of a technique is off by part of a sample, and where the techniques' means differ more than their samples
// scatter, that part is the noise. Unchanged where visits are too few to hold the shares (rounding would be coarse).
template <size_t K>
Fractions<K> wholeCounts(const Fractions<K>& a, int n, uint32_t visits);

// The weights of one hit, ready for use.
template <size_t K>
struct Mixture {
  Fractions<K> n{};       // expected counts n_i
  Fractions<K> a{};       // coefficients a_i; 0 for a technique that takes no samples
  Fractions<K> aOverN{};  // a_i/n_i
  Weights rule = Weights::kBalance;

  Mixture() = default;
  Mixture(const Fractions<K>& fractions, int samples, Weights weights) : rule(weights) {
    for (size_t i = 0; i < K; ++i) {
      n[i] = fractions[i] * static_cast<float>(samples);
      if (!(n[i] > 0)) continue;
      a[i] = rule == Weights::kNonbalance ? 1 : n[i];
      aOverN[i] = rule == Weights::kNonbalance ? 1 / n[i] : 1;
    }
  }

  // w_i / (n_i p_i): what f is to be multiplied by for a sample of technique i, where `used` techniques share the
  // integrand and p holds their densities at the sample (p[i] > 0).
  float scale(size_t i, const Fractions<K>& p, TechniqueMask used) const {
    Fractions<K> ap{};
    float sum = 0;
    for (size_t k = 0; k < K; ++k) {
      ap[k] = has(used, k) ? a[k] * p[k] : 0.0f;
      sum += ap[k];
    }
    if (!(sum > 0)) return 0;  // every density underflowed: so did f
    return rule <= Weights::kNonbalance ? aOverN[i] / sum : scaleOfHeuristic(i, p, ap);
  }

  // The same where there are more ways to make the sample than these techniques, of which `others` is the sum of
  // densities or, of the power heuristic, of their squares; of the two heuristics alone.
  float scale(size_t i, const Fractions<K>& p, TechniqueMask used, double others) const {
    const float alone = scale(i, p, used);
    if (!(others > 0)) return alone;
    const double own = rule == Weights::kPower ? double(n[i]) * double(p[i]) : 1;
    return static_cast<float>(double(alone) / (1 + double(alone) * others / own));
  }

 private:
  // The heuristics that give more to the larger densities; ap: a_k p_k.
  float scaleOfHeuristic(size_t i, const Fractions<K>& p, const Fractions<K>& ap) const {
    float top = 0, sum = 0;
    for (size_t k = 0; k < K; ++k) top = std::max(top, ap[k]);
    if (rule == Weights::kPower) {
      for (size_t k = 0; k < K; ++k) sum += (ap[k] / ap[i]) * (ap[k] / ap[i]);  // as ratios: p^2 overflows
      return 1 / (sum * n[i] * p[i]);
    }
    const float least = (rule == Weights::kCutoff ? static_cast<float>(kCutoffRatio) : kTieRatio<float>)*top;
    if (ap[i] < least) return 0;
    for (size_t k = 0; k < K; ++k) sum += ap[k] >= least ? ap[k] : 0;
    return 1 / sum;
  }
};

std::string_view name(Integrand);

}  // namespace wardmis
