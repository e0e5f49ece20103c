// SPDX-License-Identifier: GPL-3.0-or-later
// What the runs of a configuration left behind, read and compared with its reference.
#pragma once

#include "report/experiment.h"
#include "report/seeds.h"

namespace wardmis {

inline constexpr size_t kWinBlock = 4;  // pixels: side of the blocks of the map of who wins

// Pixels of the image that belong together.
struct Group {
  std::string kind, name;
  std::vector<uint32_t> pixels;
};

// By object, by material and by class of stiffness, each where there are at least two; the largest ones.
std::vector<Group> groupsOf(const Experiment& e);

// A group's pixels as a reference of one row.
Reference partOf(const Reference& reference, const Group& group);

// What is known of one configuration besides its runs' figures.
struct Measured {
  const Configuration* configuration = nullptr;
  const std::vector<Run>* runs = nullptr;
  const Reference* reference = nullptr;
  SeedStatistics seeds;
  std::vector<float> predicted;               // per pixel: variance that the runs claim; empty: unknown
  std::vector<std::vector<float>> fractions;  // by technique, per pixel; empty where it is not there
  RgbImage first;                             // of the first seed
  std::vector<float> rmsError;                // per pixel: of the relative error, over the seeds
  std::vector<std::vector<Metrics>> groups;   // of each group, of each seed; their floors are still in them
  std::vector<uint8_t> wins;  // against the baseline, 0 better, 1 worse, 2 undecided; empty: not compared

  double Clocks::*effort = &Clocks::cpu;  // of products of error and time: one clock for all that are compared

  double seconds(size_t run) const { return (*runs)[run].checkpoints.back().time.*effort; }
};

// Of configuration k; `wins` is left empty. Throws Error(kCancelled) where it has fewer than two runs.
Measured measure(const Experiment& e, size_t k, const std::vector<Group>& groups);

// Largest over median wall time of the runs.
double wallSpread(const Measured& m);

}  // namespace wardmis
