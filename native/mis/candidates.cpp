// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/candidates.h"

#include <algorithm>
#include <cmath>

#include "mis/adaptive.h"
#include "mis/allocation.h"

namespace wardmis {

CandidateLists::CandidateLists(int samplesPerHit) {
  constexpr uint32_t kParts = 4;  // of a sample
  const std::vector<Densities> three = candidates(kTechniques, 4, 2);
  for (unsigned mask = 1; mask <= kAllTechniques; ++mask)
    for (size_t c = 0; c < kCandidates; ++c) {
      Fractions a = restrict({float(three[c][0]), float(three[c][1]), float(three[c][2])}, TechniqueMask(mask));
      if (c > 0) a = wholeCounts(a, samplesPerHit, kParts);
      for (size_t k = 0; k < kTechniques; ++k) lists_[mask].a[k][c] = a[k];
    }
}

Fractions chooseCandidate(const CandidateSums& sums, const CandidateList& list, const SampleCost& cost) {
  constexpr float kLeastHits = 8;  // fewer say nothing of their own noise
  if (!(sums.hits >= kLeastHits)) return list.at(0);
  const auto objective = [&](int c) {
    const Fractions a = list.at(c);
    // sum_i a_i E[y_i]^2, which is no variance
    const float last = sums.integral - a[0] * sums.mean[0][c] - a[1] * sums.mean[1][c];
    float squares = a[0] * sums.mean[0][c] * sums.mean[0][c] + a[1] * sums.mean[1][c] * sums.mean[1][c];
    if (a[2] > 0) squares += last * (last / a[2]);
    // the pilot's noise may leave less than nothing
    return std::max(sums.value[c] - squares / sums.hits, 1e-3f * sums.value[c]) * cost.of(a[0], a[1], a[2]);
  };
  int best = 0;
  const float equal = objective(0);
  float most = 0;  // the largest gain that is sure, not the largest: that of many candidates is half luck
  for (int c = 1; c < kCandidates; ++c)
    if (const float sure = equal - objective(c) - std::sqrt(sums.gain2[c]); sure > most) best = c, most = sure;
  return list.at(best);
}

}  // namespace wardmis
