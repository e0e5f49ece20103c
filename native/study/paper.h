// SPDX-License-Identifier: GPL-3.0-or-later
// What the paper says held against quadrature: how far off its printed formulas are, and when its ranking of the
// allocations is true.
#pragma once

#include <string>
#include <vector>

#include "study/exact.h"

namespace wardmis {

// One printed formula: the mean of its estimator, or the value of its expression, over the true one.
struct Erratum {
  std::string where, what, of;
  double ratio = 0;
};
std::vector<Erratum> errata();

// N Var over N Var of equal counts (Def. 7), exactly, for one case.
struct Verdict {
  bool joint = false;
  double alpha = 0, thetaO = 0;
  std::vector<double> logRatio;  // by kVerdictStrategies
};
inline constexpr const char* kVerdictStrategies[] = {
    "variance", "variance-balance", "second-moment", "second-moment-nonbalance", "standard-deviation", "best"};
// Ward's model, rho_s = 0.5, rho_d = 0.3, for alpha from 0.01 to 1 and theta_o of 0, 30, 60 and 80 degrees.
std::vector<Verdict> verdicts();

std::string errataTable(const std::vector<Erratum>&);
std::string verdictTable(const std::vector<Verdict>&);
// A panel for split and joint, a curve for each strategy, at theta_o = 0 and 60.
void plotVerdicts(const std::vector<Verdict>&, const std::string& path);

}  // namespace wardmis
