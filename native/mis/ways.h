// SPDX-License-Identifier: GPL-3.0-or-later
// How many samples each group of ways gets, chosen from a pilot's: of a fixed set of numbers, those of least predicted
// second moment x cost (Grittmann, Yazici, Georgiev and Slusallek 2022, "Efficiency-aware multiple importance sampling
// for bidirectional rendering algorithms"). With the balance heuristic a sample that brings f out of all ways, whose
// densities sum up to D, brings f/D; with other numbers, D', the second moment of all samples is the integral of
// f^2/D', of which (f/D)^2 (D/D') is an estimate, whichever way the sample came.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "mis/path_end.h"

namespace wardmis {

// Numbers of samples.
struct WayCounts {
  double atHit = 1;  // of the camera's techniques at its first hit, over those that are asked for
  double paths = 0;  // from the lights, for each camera sample of a pixel; 0: none
  int connections = 0, laterConnections = 0;  // of the first vertex of a camera's path, and of each other
};

// Those among which is chosen, paths from the camera alone first; and how much larger than with one path and one
// connection the densities of a group are.
class WayCandidates {
 public:
  static constexpr size_t kCount = 40;  // at most

  WayCandidates();
  size_t size() const { return counts_.size(); }
  const WayCounts& at(size_t c) const { return counts_[c]; }
  static std::array<double, kJoins> factors(const WayCounts& counts);

  // Adds to sums[c] the second moment that a sample of value v says candidate c has.
  void add(std::array<float, kCount>& sums, float v, const Ways& ways) const {
    const double own = double(v) * double(v) * ways.sum();
    for (size_t c = 0; c < kCount; ++c) {
      double mixture = kNever * ways.sum();
      for (size_t j = 0; j < kJoins; ++j) mixture += factor_[j][c] * ways.of[j];
      sums[c] += static_cast<float>(own / mixture);
    }
  }

 private:
  // What no way of a candidate finds is missing from its image: worse than any noise.
  static constexpr double kNever = 1e-6;
  std::vector<WayCounts> counts_;
  double factor_[kJoins][kCount]{};
};

using WaySums = std::array<float, WayCandidates::kCount>;

// Of one technique's samples at a hit: only what they scatter counts, of which sharing can make less.
struct WayScatter {
  WaySums sums{};
  float sum = 0, squares = 0;
  int count = 0;

  // n: samples that were drawn.
  void addTo(WaySums& to, int n) const {
    if (!(squares > 0)) return;
    const float even = sum * sum / (static_cast<float>(n) * squares);
    const float part = n > 1 ? std::max(0.0f, 1 - even) * static_cast<float>(n) / static_cast<float>(n - 1) : 1;
    for (size_t c = 0; c < sums.size(); ++c) to[c] += part * sums[c];
  }
};

}  // namespace wardmis
