// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/candidates.h"

#include <algorithm>
#include <cmath>

#include "mis/adaptive.h"
#include "mis/allocation.h"

namespace wardmis {

const CandidateList& candidatesOf(TechniqueMask available) {
  static const auto lists = [] {
    std::array<CandidateList, kAllTechniques + 1> all{};
    const std::vector<Densities> three = candidates(kTechniques, 4, 2);
    for (unsigned mask = 1; mask <= kAllTechniques; ++mask)
      for (size_t c = 0; c < kCandidates; ++c) {
        const Fractions a = restrict({float(three[c][0]), float(three[c][1]), float(three[c][2])}, TechniqueMask(mask));
        for (size_t k = 0; k < kTechniques; ++k) all[mask].a[k][c] = a[k];
      }
    return all;
  }();
  return lists[available & kAllTechniques];
}

Fractions chooseCandidate(const CandidateSums& sums, float squares, TechniqueMask available, const Fractions& cost) {
  const CandidateList& list = candidatesOf(available);
  const auto objective = [&](int c) {
    const Fractions a = list.at(c);
    // the pilot's noise may leave less than nothing
    return std::max(sums.value[c] - squares, 1e-3f * sums.value[c]) *
           (a[0] * cost[0] + a[1] * cost[1] + a[2] * cost[2]);
  };
  int best = 0;
  const float equal = objective(0);
  float least = equal;
  for (int c = 1; c < kCandidates; ++c)
    if (const float v = objective(c); v < least && equal - v > 2 * std::sqrt(sums.gain2[c])) best = c, least = v;
  return list.at(best);
}

}  // namespace wardmis
