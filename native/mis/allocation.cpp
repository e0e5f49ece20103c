// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/allocation.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "mis/adaptive.h"

namespace wardmis {

namespace {

bool number(double x) { return x > 0 && std::isfinite(x); }

// The techniques of a mask, in their order.
template <size_t K>
struct Present {
  std::array<size_t, K> which{};
  int count = 0;

  explicit Present(TechniqueMask mask) {
    for (size_t i = 0; i < K; ++i)
      if (has(mask, i)) which[static_cast<size_t>(count++)] = i;
  }
  size_t operator[](int k) const { return which[static_cast<size_t>(k)]; }
};

// From the moments of all light. False where they say nothing: what the rule reads of each technique must be a number
// above zero, since a technique that has only seen zeros has no variance, which would give it everything.
template <size_t K>
bool fromAll(Allocation rule, const Moments<K>& m, const Present<K>& t, Fractions<K>& a) {
  IntegrandMoments known;
  known.techniques = t.count;
  const double hits = double(m.hits);
  for (int k = 0; k < t.count; ++k) {
    const auto at = static_cast<size_t>(k);
    const double mean = double(m.mean[t[k]]) / hits, square = double(m.square[t[k]]) / hits;
    if (!(rule == Allocation::kRepresentativity ? number(mean) : number(square) && std::isfinite(mean))) return false;
    known.mean[at] = mean, known.square[at] = square, known.variance[at] = std::max(0.0, square - mean * mean);
  }
  const Densities shares = fractions(rule, known);
  for (int k = 0; k < t.count; ++k) a[t[k]] = static_cast<float>(shares[static_cast<size_t>(k)]);
  return true;
}

// Adds one part's demand for samples, the root of what its second moment then is, times its fractions by the rule.
// False where its moments say nothing.
template <size_t K>
bool demand(Allocation rule, const PartMoments<K>& part, double hits, const Present<K>& t, Densities& a) {
  constexpr double kLeast = 1e-3;  // of m^2: of a pilot, m^2 may come out below mu^2; then not infinitely good
  if (part.integral == 0 || t.count == 0) return true;
  const double mu = double(part.integral) / hits;
  IntegrandMoments known;
  known.techniques = t.count;
  for (int k = 0; k < t.count; ++k) {
    const double second = double(part.second[t[k]]) / hits;
    if (!number(second)) return false;
    known.logSecond[static_cast<size_t>(k)] = std::log(second);
    known.variancePrim[static_cast<size_t>(k)] = std::max(second - mu * mu, kLeast * second);
  }
  const Densities shares = fractions(rule, known);
  double second = 0;  // integral f^2/q: at most this, by Jensen's inequality, and about that of equal counts
  for (int k = 0; k < t.count; ++k) second += shares[static_cast<size_t>(k)] * known.second(k);
  second = std::min(second, t.count * double(part.square) / hits);
  if (!number(second)) return false;
  for (int k = 0; k < t.count; ++k) a[t[k]] += std::sqrt(second) * shares[static_cast<size_t>(k)];
  return true;
}

// The same of light that each technique finds alone.
template <size_t K>
bool demandAlone(const PartMoments<K>& part, double hits, const Present<K>& t, Densities& a) {
  for (int k = 0; k < t.count; ++k) {
    const double second = double(part.second[t[k]]) / hits;
    if (second == 0) continue;
    if (!number(second)) return false;
    a[t[k]] += std::sqrt(second);
  }
  return true;
}

}  // namespace

template <size_t K>
Fractions<K> allocate(Allocation rule, const Moments<K>& m, TechniqueMask used, float minimum) {
  const Present<K> t(used);
  Fractions<K> equal{};
  for (int k = 0; k < t.count; ++k) equal[t[k]] = 1.0f / static_cast<float>(t.count);
  if (t.count == 0 || !needsMoments(rule) || !(m.hits > 0)) return equal;

  Fractions<K> a{};
  if (rule == Allocation::kSecondMoment || rule == Allocation::kInverseVariance) {
    constexpr TechniqueMask light = maskOf(Techniques<K>::kLight);
    Densities wanted{};
    const double hits = double(m.hits);
    if (!demand(rule, m.shared, hits, t, wanted) ||
        !demand(rule, m.unaimed, hits, Present<K>(used & static_cast<TechniqueMask>(~light)), wanted) ||
        !demandAlone(m.exclusive, hits, t, wanted))
      return equal;
    const double sum = std::accumulate(wanted.begin(), wanted.end(), 0.0);
    if (!number(sum)) return equal;
    for (size_t i = 0; i < K; ++i) a[i] = static_cast<float>(wanted[i] / sum);
  } else if (!fromAll(rule, m, t, a)) {
    return equal;
  }
  Densities shares{};
  for (int k = 0; k < t.count; ++k) shares[static_cast<size_t>(k)] = double(a[t[k]]);
  shares = clampFractions(shares, t.count, double(minimum));
  for (int k = 0; k < t.count; ++k) a[t[k]] = static_cast<float>(shares[static_cast<size_t>(k)]);
  return a;
}

template <size_t K>
Fractions<K> combineSplit(const PerIntegrand<Fractions<K>, K>& each) {
  constexpr size_t kLight = Techniques<K>::kLight;
  Fractions<K> a{};
  for (size_t own = 0; own < each.size(); ++own)
    a[own] = each[own][own], a[kLight] = std::max(a[kLight], each[own][kLight]);
  const float sum = std::accumulate(a.begin(), a.end(), 0.0f);
  for (float& x : a) x = sum > 0 ? x / sum : 0;
  return a;
}

template <size_t K>
Fractions<K> allocateSplit(Allocation rule, const PerIntegrand<Moments<K>, K>& moments, TechniqueMask available,
                           float minimum) {
  PerIntegrand<Fractions<K>, K> each{};
  for (size_t own = 0; own < each.size(); ++own)
    if (has(available, own))
      each[own] = allocate<K>(rule, moments[own], available & techniquesFor<K>(Integrand::kSplit, own), minimum);
  return restrict<K>(combineSplit<K>(each), available);
}

template <size_t K>
Fractions<K> wholeCounts(const Fractions<K>& a, int n, uint32_t visits) {
  constexpr uint32_t kLeast = 4, kMost = 64;
  visits = std::min(visits, kMost);
  if (visits < kLeast) return a;
  const float units = static_cast<float>(n) * static_cast<float>(visits);
  Fractions<K> counts{};
  size_t largest = 0;
  float sum = 0;
  for (size_t i = 0; i < K; ++i) {
    if (a[i] > 0) counts[i] = std::max(1.0f, std::round(a[i] * units));
    sum += counts[i];
    if (a[i] > a[largest]) largest = i;
  }
  counts[largest] += units - sum;  // at most one unit off the nearest
  for (float& c : counts) c /= units;
  return counts;
}

template <size_t K>
Fractions<K> restrict(const Fractions<K>& a, TechniqueMask available) {
  Fractions<K> r{};
  float sum = 0;
  for (size_t i = 0; i < K; ++i)
    if (has(available, i)) sum += r[i] = a[i];
  const float count = static_cast<float>(std::popcount(available));
  for (size_t i = 0; i < K; ++i)
    if (has(available, i)) r[i] = sum > 0 ? r[i] / sum : 1 / count;
  return r;
}

std::string_view name(Integrand r) {
  constexpr std::string_view names[] = {"split", "joint"};
  return names[static_cast<int>(r)];
}

#define WARDMIS_INSTANTIATE(K)                                                                                  \
  template Fractions<K> allocate<K>(Allocation, const Moments<K>&, TechniqueMask, float);                       \
  template Fractions<K> combineSplit<K>(const PerIntegrand<Fractions<K>, K>&);                                  \
  template Fractions<K> allocateSplit<K>(Allocation, const PerIntegrand<Moments<K>, K>&, TechniqueMask, float); \
  template Fractions<K> wholeCounts<K>(const Fractions<K>&, int, uint32_t);                                     \
  template Fractions<K> restrict<K>(const Fractions<K>&, TechniqueMask);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
