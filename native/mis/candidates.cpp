// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/candidates.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "mis/allocation.h"

namespace wardmis {

namespace {

// Proportions of m techniques, the equal ones first: all of 1, 4 and 16 with a least one of 1; where these are more
// than `most`, those in which one technique has more than the others, or one and the last, which is the light.
std::vector<std::vector<float>> proportions(size_t m, size_t most) {
  constexpr float kLevels[] = {1, 4, 16};
  std::vector<std::vector<float>> list;
  std::vector<size_t> digits(m, 0);
  while (true) {
    std::vector<float> a(m);
    std::transform(digits.begin(), digits.end(), a.begin(), [&](size_t digit) { return kLevels[digit]; });
    if (*std::min_element(a.begin(), a.end()) == 1) list.push_back(a);
    size_t i = 0;
    while (i < m && ++digits[i] == std::size(kLevels)) digits[i++] = 0;
    if (i == m) break;
  }
  if (list.size() <= most) return list;
  const auto raised = [&](const std::vector<float>& a) {
    return m - static_cast<size_t>(std::count(a.begin(), a.end(), 1.0f));
  };
  std::stable_sort(list.begin(), list.end(), [&](const auto& a, const auto& b) {
    const auto rank = [&](const auto& x) { return raised(x) < 2 ? raised(x) : x.back() > 1 ? raised(x) : m + 1; };
    return rank(a) < rank(b);
  });
  list.resize(most);
  return list;
}

}  // namespace

template <size_t K>
CandidateLists<K>::CandidateLists(int samplesPerHit) {
  constexpr uint32_t kParts = 4;  // of a sample
  std::array<std::vector<std::vector<float>>, K + 1> lists;
  for (size_t m = 1; m <= K; ++m) lists[m] = proportions(m, kCandidates<K>);
  for (unsigned mask = 1; mask <= Techniques<K>::kAll; ++mask) {
    const std::vector<std::vector<float>>& all = lists[static_cast<size_t>(std::popcount(mask))];
    for (size_t c = 0; c < kCandidates<K>; ++c) {
      const std::vector<float>& proportion = all[c < all.size() ? c : 0];  // spare ones are the equal counts again
      Fractions<K> a{};
      for (size_t k = 0, next = 0; k < K; ++k)
        if (has(TechniqueMask(mask), k)) a[k] = proportion[next++];
      a = restrict<K>(a, TechniqueMask(mask));
      if (c > 0 && c < all.size()) a = wholeCounts<K>(a, samplesPerHit, kParts);
      for (size_t k = 0; k < K; ++k) {
        const float n = a[k] * static_cast<float>(samplesPerHit), part = n - std::floor(n + 1e-4f);
        lists_[mask].a[k][c] = a[k];
        lists_[mask].spread[k][c] = std::max(0.0f, part * (1 - part)) / static_cast<float>(samplesPerHit);
      }
    }
  }
}

template <size_t K>
Fractions<K> chooseCandidate(const CandidateSums<K>& sums, const SurfaceScatter<K>& surface,
                             const CandidateList<K>& list, const SampleCost<K>& cost) {
  constexpr float kSigmas = 2;  // standard errors of the gain
  constexpr double kSurfaceHits = 16;
  if (!(sums.hits >= kLeastHits)) return list.at(0);
  const auto objective = [&](int c) {
    const auto mean = [&](size_t i) { return sums.mean[i][c]; };
    float squares = 0;
    for (size_t i = 0; i < K; ++i) {
      const float y = i + 1 < K ? mean(i) : list.last(c, sums.integral, mean);
      squares += list.spread[i][c] * y * (y / sums.hits);
    }
    return (sums.within[c] - squares) * cost.of(list, c);
  };
  int best = 0;
  const float equal = objective(0);
  float most = 0;  // the largest gain that is sure, not the largest: that of many candidates is half luck
  for (int c = 1; c < kCandidates<K>; ++c) {
    const double gain2 = double(sums.gain2[c]) + kSurfaceHits * surface.gain2[c] / surface.hits;
    const float sure = equal - objective(c) - kSigmas * static_cast<float>(std::sqrt(gain2));
    if (sure > most) best = c, most = sure;
  }
  return list.at(best);
}

template <size_t K>
bool suffice(int samples, const CandidateSums<K>& sums, const SurfaceScatter<K>& surface) {
  constexpr double kScatter = 0.005, kSurfaceScatter = 0.1;
  const auto isEven = [&](double within, double integral, double hits, double scatter) {
    const double mean = integral / hits;
    return mean > 0 && within / hits <= samples * scatter * scatter * mean * mean;
  };
  return sums.hits >= kLeastHits &&
         isEven(double(sums.within[0]), double(sums.integral), double(sums.hits), kScatter) &&
         isEven(surface.within, surface.integral, surface.hits, kSurfaceScatter);
}

#define WARDMIS_INSTANTIATE(K)                                                                                         \
  template class CandidateLists<K>;                                                                                    \
  template Fractions<K> chooseCandidate<K>(const CandidateSums<K>&, const SurfaceScatter<K>&, const CandidateList<K>&, \
                                           const SampleCost<K>&);                                                      \
  template bool suffice<K>(int, const CandidateSums<K>&, const SurfaceScatter<K>&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
