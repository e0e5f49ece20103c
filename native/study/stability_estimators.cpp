// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability_estimators.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace wardmis {

namespace {

size_t at(int i) { return static_cast<size_t>(i); }

// |z| that a normal variable exceeds as often as |t| is exceeded with so many degrees of freedom.
double normalFromStudent(double t, int freedom) {
  const double level = 2 * boost::math::cdf(boost::math::complement(boost::math::students_t(freedom), t));
  return zOf(std::max(level, 1e-300));
}

}  // namespace

double zOf(double level) { return boost::math::quantile(boost::math::complement(boost::math::normal(), 0.5 * level)); }

EstimatorReport measureEstimators(const Problem& problem, int samples, int trials, uint64_t seed) {
  const int n = problem.techniques();
  std::vector<const Strategy*> list;
  for (const Strategy& s : strategies())
    if (s.allocation != Allocation::kSecondOrder || n == 2) list.push_back(&s);
  constexpr size_t kEffort = 20;  // the trials see six digits less than the quadrature
  const Exact exact = solve(problem, kEffort);
  TrialSettings settings;
  settings.samples = samples, settings.trials = trials, settings.seed = seed;
  settings.threads = 1;  // cells run side by side
  const double mu = exact.moments.integral;

  EstimatorReport report;
  report.integral = mu, report.quadrature = exact.relativeError;
  report.techniques = n, report.logSecond = exact.moments.logSecond;
  const auto [low, high] = std::minmax_element(report.logSecond.begin(), report.logSecond.begin() + n);
  report.logStiffness = *high - *low;
  for (const StrategyRun& run : runTrials(problem, exact, list, settings)) {
    StrategyReport s;
    s.strategy = run.strategy;
    s.fractions = run.exact.fractions, s.logVariance = run.exact.logVariance;
    double sum = 0;
    bool equal = true;
    for (int i = 0; i < n; ++i) {
      const double a = s.fractions[at(i)];
      s.sound &= a >= 0 && a <= 1;
      sum += a;
      equal &= a == 1.0 / n;
    }
    // a technique that gets nothing, weighted by its density, makes the variance infinite: no defect
    s.sound &= std::abs(sum - 1) < 1e-12 && !std::isnan(s.logVariance);
    s.sound &= std::isfinite(mu) && mu >= 0;
    s.equalCounts = equal && run.strategy->allocation != Allocation::kEqual;
    if (run.strategy->knowledge == Knowledge::kPilot)
      s.equalCounts = *std::max_element(run.counts.begin(), run.counts.begin() + n) -
                          *std::min_element(run.counts.begin(), run.counts.begin() + n) <=
                      1;
    s.biased = run.strategy->knowledge == Knowledge::kDirect;
    s.variance = run.estimate.variance();
    s.events = run.events;
    // the larger of the two standard errors: rare events make the measured one too small more often than too large
    double error = run.estimate.error();
    if (run.predictedVariance) error = std::max(error, std::sqrt(*run.predictedVariance / trials));
    error += 1e-10 * mu;  // what quadrature and rounding leave
    s.z = run.judgeable && !s.biased ? (run.estimate.mean() - mu) / error : std::nan("");
    if (!run.predictedVariance && s.measurable())
      s.z = std::copysign(normalFromStudent(std::abs(s.z), trials - 1), s.z);
    if (!std::isfinite(run.estimate.mean())) s.z = std::numeric_limits<double>::infinity();
    report.strategies.push_back(s);
  }
  return report;
}

}  // namespace wardmis
