// SPDX-License-Identifier: GPL-3.0-or-later
// What quadrature says of a study case: the integral, the techniques' moments, each strategy's fractions and N Var.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "mis/strategy.h"
#include "study/problem.h"

namespace wardmis {

struct Exact {
  Points points;
  IntegrandMoments moments;
  double diffusePart = 0;  // L_o = moments.integral + diffusePart
  double lobeNormalization = 1;
  double integralError = 0;  // the quadrature's estimate for the integral (L_o), relative
  double relativeError = 0;  // the largest estimate of all integrals that the estimators' moments are made of
  // The estimate for N Var of cutoff and maximum with equal counts, relative: their weights jump along lines through
  // the cells.
  double cutoffError = 0, maximumError = 0;
};
// effort: cells that each step of the quadrature may add; fewer than it asks for where the last digits are not needed.
Exact solve(const Problem& problem, size_t effort = 4000);

// One strategy for given costs (null: equal ones).
struct Prediction {
  Densities fractions{};
  double logVariance = 0;  // ln(N Var) for real-valued fractions
};
Prediction predict(const Strategy&, const Exact&, const Densities* cost = nullptr);
// Of several, which share the search for their fractions: that of `best` takes longer than the quadrature.
std::vector<Prediction> predictAll(const std::vector<const Strategy*>&, const Exact&, const Densities* cost = nullptr);

// The golden file's key `expect`: two techniques by their numbers, more as arrays. N: of "integer_counts".
nlohmann::json expectJson(const StudyInput&, const Exact&, int n = 256);

}  // namespace wardmis
