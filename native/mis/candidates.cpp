// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/candidates.h"

#include <algorithm>
#include <cmath>

#include "mis/allocation.h"

namespace wardmis {

namespace {

// Fractions proportional to 1, 4 or 16, each once, the equal ones first.
std::array<Fractions, kCandidates> proportions() {
  constexpr float kLevels[] = {1, 4, 16};
  std::array<Fractions, kCandidates> list;
  size_t count = 0;
  for (float c : kLevels)
    for (float b : kLevels)
      for (float a : kLevels)
        if (std::min({a, b, c}) == 1) list[count++] = {a / (a + b + c), b / (a + b + c), c / (a + b + c)};
  return list;
}

}  // namespace

CandidateLists::CandidateLists(int samplesPerHit) {
  constexpr uint32_t kParts = 4;  // of a sample
  const std::array<Fractions, kCandidates> three = proportions();
  for (unsigned mask = 1; mask <= kAllTechniques; ++mask)
    for (size_t c = 0; c < kCandidates; ++c) {
      Fractions a = restrict(three[c], TechniqueMask(mask));
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
  constexpr float kSigmas = 2;  // standard errors of the gain
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
