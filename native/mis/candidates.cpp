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
      for (size_t k = 0; k < kTechniques; ++k) {
        const float n = a[k] * static_cast<float>(samplesPerHit), part = n - std::floor(n + 1e-4f);
        lists_[mask].a[k][c] = a[k];
        lists_[mask].spread[k][c] = std::max(0.0f, part * (1 - part)) / static_cast<float>(samplesPerHit);
      }
    }
}

Fractions chooseCandidate(const CandidateSums& sums, const GainScatter& surface, const CandidateList& list,
                          const SampleCost& cost) {
  constexpr float kSigmas = 2;     // standard errors of the gain
  constexpr float kLeastHits = 8;  // fewer say nothing of their own noise
  constexpr double kSurfaceHits = 16;
  if (!(sums.hits >= kLeastHits)) return list.at(0);
  const auto objective = [&](int c) {
    const Fractions a = list.at(c);
    const float first = sums.mean[0][c], second = sums.mean[1][c];
    const float means[] = {first, second, list.last(c, sums.integral, first, second)};
    float squares = 0;
    for (int i = 0; i < kTechniques; ++i) squares += list.spread[i][c] * means[i] * (means[i] / sums.hits);
    return (sums.within[c] - squares) * cost.of(a[0], a[1], a[2]);
  };
  int best = 0;
  const float equal = objective(0);
  float most = 0;  // the largest gain that is sure, not the largest: that of many candidates is half luck
  for (int c = 1; c < kCandidates; ++c) {
    const double gain2 = double(sums.gain2[c]) + kSurfaceHits * surface.gain2[c] / surface.hits;
    const float sure = equal - objective(c) - kSigmas * static_cast<float>(std::sqrt(gain2));
    if (sure > most) best = c, most = sure;
  }
  return list.at(best);
}

}  // namespace wardmis
