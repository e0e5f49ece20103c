// SPDX-License-Identifier: GPL-3.0-or-later
// Discrete sampling in constant time (Walker 1977, Vose 1991).
#pragma once

#include <cstdint>
#include <vector>

namespace wardmis {

class AliasTable {
 public:
  AliasTable() = default;
  explicit AliasTable(const std::vector<double>& weights) {  // >= 0 and finite
    const size_t n = weights.size();
    entries_.resize(n);
    for (double w : weights) sum_ += w;
    if (n == 0 || !(sum_ > 0)) {
      entries_.clear();
      return;
    }
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (size_t i = 0; i < n; ++i) {
      scaled[i] = weights[i] / sum_ * static_cast<double>(n);
      entries_[i].probability = static_cast<float>(weights[i] / sum_);
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
  }

  bool empty() const { return entries_.empty(); }
  double sum() const { return sum_; }
  float probability(uint32_t i) const { return entries_[i].probability; }
  // u in [0, 1) is replaced by what is left of it, again uniform in [0, 1).
  uint32_t sample(float& u) const {
    const float x = u * static_cast<float>(entries_.size());
    uint32_t i = static_cast<uint32_t>(x);
    if (i >= entries_.size()) i = static_cast<uint32_t>(entries_.size()) - 1;
    const float rest = x - static_cast<float>(i);
    const Entry& e = entries_[i];
    if (rest < e.threshold) {
      u = rest / e.threshold;
    } else {
      u = (rest - e.threshold) / (1 - e.threshold);
      i = e.alias;
    }
    if (!(u < 0x1.fffffep-1f)) u = 0x1.fffffep-1f;
    return i;
  }

 private:
  static uint32_t heaviest(const std::vector<double>& w) {
    uint32_t best = 0;
    for (size_t i = 1; i < w.size(); ++i)
      if (w[i] > w[best]) best = static_cast<uint32_t>(i);
    return best;
  }
  struct Entry {
    float threshold = 1, probability = 0;
    uint32_t alias = 0;
  };
  std::vector<Entry> entries_;
  double sum_ = 0;
};

}  // namespace wardmis
