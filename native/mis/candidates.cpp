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

Fractions chooseCandidate(const CandidateSums& sums, TechniqueMask available, const Fractions& cost) {
  constexpr float kSigmas = 2;
  const CandidateList& list = candidatesOf(available);
  const float hits = std::max(1.0f, sums.hits);
  const auto costOf = [&](const Fractions& a) { return a[0] * cost[0] + a[1] * cost[1] + a[2] * cost[2]; };
  const auto objective = [&](int c) {
    const Fractions a = list.at(c);
    // sum_i a_i E[y_i]^2, which is no variance
    const float last = sums.integral - a[0] * sums.mean[0][c] - a[1] * sums.mean[1][c];
    float squares = a[0] * sums.mean[0][c] * sums.mean[0][c] + a[1] * sums.mean[1][c] * sums.mean[1][c];
    if (a[2] > 0) squares += last * (last / a[2]);
    // the pilot's noise may leave less than nothing
    return std::max(sums.value[c] - squares / hits, 1e-3f * sums.value[c]) * costOf(a);
  };
  // Whether the gain is sure is asked of the one-sample variance, sum_i a_i E[y_i^2] - mu^2: there the noise of mu,
  // most of it all, drops out of the difference.
  const auto oneSample = [&](int c) {
    return (sums.value[c] - sums.integral * (sums.integral / hits)) * costOf(list.at(c));
  };
  int best = 0;
  float least = objective(0);
  const float equal = oneSample(0);
  for (int c = 1; c < kCandidates; ++c)
    if (const float v = objective(c); v < least && equal - oneSample(c) > kSigmas * std::sqrt(sums.gain2[c]))
      best = c, least = v;
  return list.at(best);
}

}  // namespace wardmis
