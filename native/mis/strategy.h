// SPDX-License-Identifier: GPL-3.0-or-later
// Every way of sharing N samples between techniques, as data: the fractions a_i = N_i/N and the weights w_i of the
// estimator F = sum_i 1/N_i sum_j w_i(X_ij) f(X_ij)/p_i(X_ij), from points that stand for the integrand. docs/theory.md
// has each one's source, formula and conditions. For any number of techniques.
#pragma once

#include <span>
#include <string_view>

#include "mis/points.h"
#include "mis/rules.h"

namespace wardmis {

// How the numbers that a strategy needs are got in a run.
enum class Knowledge : uint8_t {
  kGiven,        // from points that are independent of the samples
  kProgressive,  // from the samples of the passes before
  kDirect,       // from the same samples: biased by O(1/N)
  kPilot,        // from a share of the N samples, drawn first
};

struct Strategy {
  std::string_view name;
  Allocation allocation;
  Weights weights;
  Knowledge knowledge = Knowledge::kGiven;
  std::string_view source;
};
std::span<const Strategy> strategies();
const Strategy* findStrategy(std::string_view name);

// What is known of an integrand, from points.
struct IntegrandMoments {
  int techniques = 0;
  double integral = 0;       // mu
  Densities mean{};          // mu_i,eq = integral g p_i, g = f/sum_k p_k
  Densities square{};        // integral g^2 p_i
  Densities variance{};      // sigma^2_i,eq = square - mean^2
  Densities logSecond{};     // ln m^2_i, m^2_i = integral f^2/p_i
  Densities variancePrim{};  // m^2_i - mu^2 without its cancellation; infinite beyond double's range

  double second(int i) const;  // m^2_i, infinity beyond double's range
};
IntegrandMoments momentsOf(const Points& points);

Densities equalFractions(int techniques);

// Whether an allocation follows from these moments alone; of the equalised one, its first step from equal counts does.
constexpr bool followsFromMoments(Allocation a) {
  return a != Allocation::kLinear && a != Allocation::kSecondOrder && a != Allocation::kBest && a != Allocation::kAuto;
}
// Fractions, which sum to 1, from moments alone. cost: of one sample of each technique, any unit; nothing: equal costs.
// Equal fractions where the moments say nothing.
Densities fractions(Allocation, const IntegrandMoments&, const Densities* cost = nullptr);

// The same from points, for every allocation.
Densities fractions(Allocation, const Points&, const IntegrandMoments&, const Densities* cost = nullptr);

// w_i f/p_i, for weights that are functions of a and p (all but kOptimal); v: of kVarianceAware. Finite where w_i/p_i
// is not: at a lobe's end f and the densities underflow together.
double weightedValue(Weights, int i, int techniques, double f, const Densities& p, const Densities& a,
                     const Densities& v);
Densities varianceAwareFactors(const IntegrandMoments&);

// tau of the optimal weights: F = sum_i tau_i + 1/N sum_ij (f - sum_k tau_k p_k)/q (X_ij).
Densities optimalTau(const Points&, const Densities& a);

// Of y_i = w_i f/p_i at a sample of technique i, its part of the estimate: mean and central moments. rare: its part of
// N Var where a_i is below double's range, and these are 0.
struct Contributions {
  Densities mean{}, variance{}, fourth{}, rare{};
};
Contributions contributions(Weights, const Densities& a, const Points&, const IntegrandMoments&);

// ln(N Var) of the multi-sample estimator for real-valued fractions, and of the one-sample estimator with balance
// weights.
double logVariance(Weights, const Densities& a, const Points&, const IntegrandMoments&);
double logVariance(Weights, const Densities& a, const IntegrandMoments&, const Contributions&);  // for the same a
double logVarianceOneSample(const Densities& a, const Points&);

// Whole counts: a_i N by largest remainder, at least one each (N >= techniques).
std::array<int, kMaxTechniques> wholeCounts(const Densities& a, int techniques, int n);

}  // namespace wardmis
