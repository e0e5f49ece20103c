// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/allocation.h"

#include <algorithm>
#include <bit>

#include "mis/adaptive.h"

namespace wardmis {

namespace {

// What the rule reads of technique i must be a number above zero: a technique that has only seen zeros has no variance,
// which would give it everything.
bool says(Allocation rule, const Moments& m, int i) {
  const auto usable = [&](float x) { return x > 0 && std::isfinite(x / m.hits); };
  switch (rule) {
    case Allocation::kSecondMoment:
      return usable(m.second[i]);
    case Allocation::kInverseVariance:
      return usable(m.second[i]) && usable(m.mean[i]);
    case Allocation::kRepresentativity:
      return usable(m.mean[i]);
    case Allocation::kEqualised:
      return usable(m.square[i]);
    default:
      return usable(m.square[i]) && std::isfinite(m.mean[i] / m.hits);
  }
}

}  // namespace

Fractions allocate(Allocation rule, const Moments& m, TechniqueMask used, float minimum) {
  const int n = std::popcount(used);
  Fractions a{};
  std::array<int, kTechniques> which{};  // the techniques used
  for (int i = 0, k = 0; i < kTechniques; ++i)
    if ((used >> i & 1u) != 0) which[k++] = i;
  for (int k = 0; k < n; ++k) a[which[k]] = 1.0f / static_cast<float>(n);
  if (n == 0 || !needsMoments(rule) || !(m.hits > 0)) return a;

  IntegrandMoments known;
  known.techniques = n;
  const double hits = m.hits;
  for (int k = 0; k < n; ++k) known.integral += m.mean[which[k]] / hits;
  for (int k = 0; k < n; ++k) {
    const int i = which[k];
    if (!says(rule, m, i)) return a;
    const double mean = m.mean[i] / hits, square = m.square[i] / hits, second = m.second[i] / hits;
    known.mean[k] = mean, known.square[k] = square, known.variance[k] = std::max(0.0, square - mean * mean);
    known.logSecond[k] = std::log(second);
    // of a pilot, m^2 may come out below mu^2: then a thousandth of m^2, not infinitely good
    known.variancePrim[k] = std::max(second - known.integral * known.integral, 1e-3 * second);
  }
  const Densities shares = clampFractions(fractions(rule, known), n, double(minimum));
  for (int k = 0; k < n; ++k) a[which[k]] = static_cast<float>(shares[k]);
  return a;
}

Fractions combineSplit(const Fractions& specular, const Fractions& diffuse) {
  Fractions a{specular[kLobe], diffuse[kCosine], std::max(specular[kLight], diffuse[kLight])};
  const float sum = a[kLobe] + a[kCosine] + a[kLight];
  for (float& x : a) x = sum > 0 ? x / sum : 0;
  return a;
}

Fractions allocateSplit(Allocation rule, const Moments& specular, const Moments& diffuse, TechniqueMask available,
                        float minimum) {
  const auto one = [&](const Moments& m, Technique own, TechniqueMask used) {
    return (available & maskOf(own)) != 0 ? allocate(rule, m, available & used, minimum) : Fractions{};
  };
  const Fractions s = one(specular, kLobe, kSpecularTechniques), d = one(diffuse, kCosine, kDiffuseTechniques);
  return restrict(combineSplit(s, d), available);
}

Fractions wholeCounts(const Fractions& a, int n, uint32_t visits) {
  constexpr uint32_t kLeast = 4, kMost = 64;
  visits = std::min(visits, kMost);
  if (visits < kLeast) return a;
  const float units = static_cast<float>(n) * static_cast<float>(visits);
  Fractions counts{};
  size_t largest = 0;
  float sum = 0;
  for (size_t i = 0; i < kTechniques; ++i) {
    if (a[i] > 0) counts[i] = std::max(1.0f, std::round(a[i] * units));
    sum += counts[i];
    if (a[i] > a[largest]) largest = i;
  }
  counts[largest] += units - sum;  // at most one unit off the nearest
  for (float& c : counts) c /= units;
  return counts;
}

Fractions restrict(const Fractions& a, TechniqueMask available) {
  Fractions r{};
  float sum = 0;
  for (int i = 0; i < kTechniques; ++i)
    if ((available >> i & 1u) != 0) sum += r[i] = a[i];
  const float count = static_cast<float>(std::popcount(available));
  for (int i = 0; i < kTechniques; ++i)
    if ((available >> i & 1u) != 0) r[i] = sum > 0 ? r[i] / sum : 1 / count;
  return r;
}

std::string_view name(Integrand r) {
  constexpr std::string_view names[] = {"split", "joint"};
  return names[static_cast<int>(r)];
}

}  // namespace wardmis
