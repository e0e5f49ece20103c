// SPDX-License-Identifier: GPL-3.0-or-later
// Every strategy on every golden case: unbiased, and of the variance that quadrature predicts.
#include "study/trials.h"

#include <gtest/gtest.h>

#include "golden.h"

namespace wardmis {
namespace {

using nlohmann::json;

// 55 cases x 22 strategies: with |z| < 4 for the means and five standard errors for the variances, one of 15,000 right
// checks fails by chance, about one in ten runs of the whole with another seed; this seed is none of them. Sharper
// lobes are left out: what the cosine technique finds of them is so rare that 10^4 trials may see none of it, and
// neither mean nor variance tells. The same goes for a variance whose own standard error is a quarter of it.
TEST(Trials, MeanAndVarianceAreThoseOfQuadrature) {
  std::vector<const Strategy*> all;
  for (const Strategy& s : strategies()) all.push_back(&s);
  int checked = 0, variances = 0;
  for (const char* kind : {"estimator_cases", "three_technique_cases"})
    for (const json& c : test::golden()[kind]) {
      const StudyInput input = studyInputFromJson(c["input"]);
      if (input.ward() && std::min(input.alphaX, input.alphaY) < 0.01) continue;
      const std::unique_ptr<Problem> problem = makeProblem(input);
      const Exact exact = solve(*problem);
      TrialSettings settings;
      settings.samples = 32, settings.trials = 10000, settings.seed = 2;
      for (const StrategyRun& run : runTrials(*problem, exact, all, settings)) {
        SCOPED_TRACE(c["input"].dump() + " " + std::string(run.strategy->name));
        const Estimate& e = run.estimate;
        if (run.strategy->knowledge == Knowledge::kDirect) continue;  // biased by O(1/N), as its source says
        if (e.varianceError() > 0.25 * e.variance()) continue;
        EXPECT_LT(std::abs(e.mean() - exact.moments.integral), 4 * e.error() + 1e-13 * exact.moments.integral);
        ++checked;
        if (!run.predictedVariance || !(e.variance() > 1e-24 * exact.moments.integral * exact.moments.integral))
          continue;
        EXPECT_LT(std::abs(e.variance() - *run.predictedVariance), 5 * e.varianceError());
        ++variances;
      }
    }
  EXPECT_GT(checked, 1000);
  EXPECT_GT(variances, 800);
}

// Down to one sample a technique: passes that would have none are not taken.
TEST(Trials, FewSamples) {
  StudyInput input;
  input.alphaX = input.alphaY = 0.3;
  const std::unique_ptr<Problem> problem = makeProblem(input);
  const Exact exact = solve(*problem);
  std::vector<const Strategy*> all;
  for (const Strategy& s : strategies()) all.push_back(&s);
  for (int n : {2, 3, 4, 7, 9}) {
    TrialSettings settings;
    settings.samples = n, settings.trials = 4000, settings.seed = 1;
    for (const StrategyRun& run : runTrials(*problem, exact, all, settings)) {
      SCOPED_TRACE(testing::Message() << n << " samples, " << run.strategy->name);
      ASSERT_TRUE(std::isfinite(run.estimate.mean()));
      if (run.strategy->knowledge == Knowledge::kDirect) continue;
      EXPECT_LT(std::abs(run.estimate.mean() - exact.moments.integral), 4 * run.estimate.error() + 1e-13);
    }
  }
}

// Techniques of the same density: every strategy of balance, maximum or cutoff weights is then the same estimator, by
// quadrature and in the trials.
TEST(Trials, EqualDensitiesTie) {
  StudyInput input;
  input.brdf = StudyBrdf::kLafortunePhong, input.m = 1, input.thetaO = 0;
  const std::unique_ptr<Problem> problem = makeProblem(input);
  const Exact exact = solve(*problem);
  TrialSettings settings;
  settings.samples = 16, settings.trials = 20000, settings.seed = 5;
  const auto runs = runTrials(*problem, exact,
                              {findStrategy("equal"), findStrategy("maximum"), findStrategy("cutoff"),
                               findStrategy("power"), findStrategy("second-moment")},
                              settings);
  for (const StrategyRun& run : runs) {
    SCOPED_TRACE(run.strategy->name);
    EXPECT_NEAR(run.exact.logVariance, runs[0].exact.logVariance, 1e-9);
    EXPECT_NEAR(run.estimate.variance() / *run.predictedVariance, 1, 0.05);
    EXPECT_NEAR(run.estimate.variance() / runs[0].estimate.variance(), 1, 1e-9);
  }
}

// `auto` is never worse than equal counts by more than its pilot and the trials' own noise explain: where equal counts
// are the best of all multi-sample mixtures but not of one-sample ones (the first case), and with pilots of few
// samples.
TEST(Trials, AutoIsNeverMuchWorseThanEqual) {
  struct Case {
    StudyBrdf brdf;
    double alpha, theta;
    bool joint;
    int samples;
  };
  for (const Case& c : {Case{StudyBrdf::kWard, 0.02, 0, true, 1024}, Case{StudyBrdf::kWardDur, 0.3, 85, false, 16},
                        Case{StudyBrdf::kWardDur, 0.3, 85, false, 64}, Case{StudyBrdf::kWardGmd, 0.6, 85, false, 16},
                        Case{StudyBrdf::kWardGmd, 0.6, 85, false, 32}, Case{StudyBrdf::kWard, 0.5, 85, false, 32}}) {
    StudyInput input;
    input.brdf = c.brdf, input.alphaX = input.alphaY = c.alpha, input.thetaO = c.theta;
    if (c.joint) input.joint = true, input.rhoD = 0.3, input.rhoS = 0.5;
    const std::unique_ptr<Problem> problem = makeProblem(input);
    const Exact exact = solve(*problem);
    TrialSettings settings;
    settings.samples = c.samples, settings.trials = c.samples > 512 ? 4000 : 20000, settings.seed = 11;
    const auto runs = runTrials(*problem, exact, {findStrategy("equal"), findStrategy("auto")}, settings);
    EXPECT_LT(runs[1].estimate.variance(), 1.05 * runs[0].estimate.variance())
        << name(c.brdf) << " alpha " << c.alpha << " theta_o " << c.theta << " N " << c.samples;
  }
}

}  // namespace
}  // namespace wardmis
