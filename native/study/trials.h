// SPDX-License-Identifier: GPL-3.0-or-later
// What sampling says of a study case: each strategy's estimates over many trials, held against the exact values.
#pragma once

#include <optional>

#include "math/statistics.h"
#include "study/exact.h"

namespace wardmis {

struct TrialSettings {
  int samples = 1024;  // N, of a trial and strategy, in all
  int trials = 1000;
  uint64_t seed = 0;
  std::optional<Densities> cost;  // of one sample of each technique, for the strategies; none: equal ones
  Densities nanoseconds{};        // measured, of one sample of each technique: part of a run's seconds
  int threads = 0;                // 0: all
};

// Means are judged where their variance rests on at least so many events: of strategies whose variance is predicted,
// and of those that learn from their samples, of which every technique must also meet the light so often.
inline constexpr double kEventsGiven = 100, kEventsOwn = 2000;
// And of the latter on so many trials, whose scatter is all that says how sure their mean is.
inline constexpr int kTrialsOwn = 100;

struct StrategyRun {
  const Strategy* strategy = nullptr;
  Prediction exact;                          // for real-valued fractions
  std::array<int, kMaxTechniques> counts{};  // of the given knowledge; else of its last trial's main part
  std::optional<double> predictedVariance;   // for these counts; none where counts follow the samples
  Estimate estimate;                         // of the integral (without the diffuse part), over the trials
  double seconds = 0;                        // of one trial: drawing by the given costs, and combining as measured
  // About how many events the trials' variance rests on (one over the mean's kurtosis): few where a technique meets
  // what it is to find in one of thousands of trials. The mean then says nothing, nor does the measured variance.
  double events = 0;
  bool judgeable = false;  // events and trials are enough to tell a bias from bad luck
};

// Nanoseconds that one sample of each technique takes, drawn and evaluated under all densities: median of several.
Densities measureCost(const Problem& problem);

// Throws Error(usage) where there are fewer samples than techniques. The samples of a trial are shared: each strategy
// takes the first ones of every technique, so that strategies are compared on the same luck. `predictions`:
// predictAll's for the same strategies and costs, which do not depend on the number of samples; null: made here.
std::vector<StrategyRun> runTrials(const Problem& problem, const Exact& exact,
                                   const std::vector<const Strategy*>& strategies, const TrialSettings& settings,
                                   const std::vector<Prediction>* predictions = nullptr);

}  // namespace wardmis
