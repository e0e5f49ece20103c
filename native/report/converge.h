// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a comparison: reference images, then every configuration with every seed, interleaved; all of it resumable.
#pragma once

#include <functional>

#include "report/experiment.h"

namespace wardmis {

struct StudyPlan {
  std::filesystem::path scenePath, folder;
  std::string title, command;
  std::vector<Configuration> configurations;  // of WardMIS: name, settings, described
  std::string baseline;                       // empty: the first
  size_t seeds = 16;
  uint64_t firstSeed = 1;
  uint32_t maxSpp = 64;
  double budgetSeconds = 0;         // > 0: for all of it; maxSpp then follows from it
  std::filesystem::path reference;  // empty: made
  double referenceSeconds = 0;      // 0: as long as 16 runs of one configuration
  std::optional<double> target;
  std::vector<std::filesystem::path> external;  // manifests of other renderers
  int threads = 0;
};

struct StudyProgress {
  const char* phase = "";     // reference, runs, report
  std::string configuration;  // empty: none
  uint64_t seed = 0;
  size_t done = 0, of = 0;
  double fraction = 0, seconds = 0, left = 0;
};

struct StudyObserver {
  std::function<void(const StudyProgress&)> progress;
  std::function<void(const std::string&)> warn;
  const std::atomic<Stop>* stop = nullptr;
};

// Throws for every mistake of the plan that shows without a render; writes nothing.
void check(const BuiltScene& built, const StudyPlan& plan);

// Continues what the folder holds of the same study; throws Error(kUsage) if it holds another one. After a stop it
// returns what is there: Experiment::complete is false.
Experiment measure(const BuiltScene& built, const StudyPlan& plan, const StudyObserver& observer);

}  // namespace wardmis
