// SPDX-License-Identifier: GPL-3.0-or-later
// Every strategy at one cell: predictions that are numbers, means that are unbiased, and where it takes equal counts.
#pragma once

#include "study/trials.h"

namespace wardmis {

struct StrategyReport {
  const Strategy* strategy = nullptr;
  Densities fractions{};
  bool sound = true;         // fractions sum to 1; N Var is finite and not negative
  bool equalCounts = false;  // though it is no strategy of equal counts
  double logVariance = 0;    // ln(N Var)
  // Of the mean, as a normal variable: where its error is the trials' own, that of Student's t at the same level. NaN
  // where it is not measurable.
  double z = 0;
  double events = 0;  // see StrategyRun
  double variance = 0;
  bool biased = false;  // by O(1/N), as its source says: not judged
  bool measurable() const { return z == z; }
};

struct EstimatorReport {
  double integral = 0, quadrature = 0;
  double logStiffness = 0;  // ln of the largest/smallest second moment
  Densities logSecond{};
  int techniques = 0;
  std::vector<StrategyReport> strategies;
};

double zOf(double level);  // |z| that a normal variable exceeds with that probability

EstimatorReport measureEstimators(const Problem& problem, int samples, int trials, uint64_t seed);

}  // namespace wardmis
