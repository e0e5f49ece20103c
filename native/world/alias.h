// SPDX-License-Identifier: GPL-3.0-or-later
// Discrete sampling in constant time (Walker 1977, Vose 1991).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/table.h"

namespace wardmis {

// Of up to 2^32 - 1 entries. sample() draws from exactly the probabilities that probability() gives, but for the
// rounding of u: a uniform multiple of 2^-53 makes the two differ by at most N 2^-52 in total variation, which is 10^-9
// for the 2 million cells of a sky and 10^-6 for 2^32 entries.
class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights) {  // >= 0 and finite
    const std::size_t n = weights.size();
    for (double w : weights) sum_ += w;
    if (n == 0 || !(sum_ > 0)) return;
    entries_.resize(n);
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (std::size_t i = 0; i < n; ++i) {
      scaled[i] = weights[i] / sum_ * static_cast<double>(n);
      (scaled[i] < 1 ? small : large).push_back(static_cast<uint32_t>(i));
    }
    while (!small.empty() && !large.empty()) {
      const uint32_t s = small.back(), l = large.back();
      small.pop_back();
      entries_[s].threshold = static_cast<float>(scaled[s]);
      entries_[s].alias = l;
      scaled[l] -= 1 - scaled[s];
      if (scaled[l] < 1) large.pop_back(), small.push_back(l);
    }
    for (const auto* rest : {&small, &large})
      for (uint32_t i : *rest) entries_[i].threshold = 1, entries_[i].alias = i;
    // what rounding left among the small ones may have no weight at all: it must never be drawn
    for (uint32_t i : small)
      if (!(weights[i] > 0)) entries_[i].threshold = 0, entries_[i].alias = heaviest(weights);

    // the probabilities are those of the thresholds as they were rounded, not of the weights
    std::vector<double> drawn(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      const double own = double(entries_[i].threshold);
      drawn[i] += own;
      drawn[entries_[i].alias] += 1 - own;
    }
    probabilities_.resize(n);
    for (std::size_t i = 0; i < n; ++i) probabilities_[i] = static_cast<float>(drawn[i] / static_cast<double>(n));
  }

  bool empty() const { return entries_.empty(); }
  double sum() const { return sum_; }
  float probability(uint32_t i) const { return probabilities_[i]; }
  // Asks for what sample(u) and probability(i) read: in a table of millions each is a wait for memory.
  void prefetch(double u) const { fetch(&entries_[slot(u)]); }
  void prefetchProbability(uint32_t i) const { fetch(&probabilities_[i]); }
  // u in [0, 1), a multiple of 2^-53, is replaced by what is left of it, again uniform in [0, 1).
  uint32_t sample(double& u) const {
    const double x = u * static_cast<double>(entries_.size());
    uint32_t i = slot(u);
    const double rest = x - i;
    const Entry& e = entries_[i];
    const auto threshold = double(e.threshold);
    if (rest < threshold) {
      u = rest / threshold;
    } else {
      u = (rest - threshold) / (1 - threshold);
      i = e.alias;
    }
    if (!(u < 0x1.fffffffffffffp-1)) u = 0x1.fffffffffffffp-1;
    return i;
  }

 private:
  uint32_t slot(double u) const {
    return static_cast<uint32_t>(std::min(u * static_cast<double>(entries_.size()), double(entries_.size() - 1)));
  }
  static uint32_t heaviest(const std::vector<double>& w) {
    uint32_t best = 0;
    for (std::size_t i = 1; i < w.size(); ++i)
      if (w[i] > w[best]) best = static_cast<uint32_t>(i);
    return best;
  }
  struct Entry {
    float threshold = 1;
    uint32_t alias = 0;
  };
  Table<Entry> entries_;
  Table<float> probabilities_;  // apart: a draw reads one entry, who meets something a probability
  double sum_ = 0;
};

}  // namespace wardmis
