// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/allocation.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "mis/adaptive.h"

namespace wardmis {

namespace {

bool number(double x) { return x > 0 && std::isfinite(x); }

// The techniques of a mask, in their order.
struct Techniques {
  std::array<int, kTechniques> which{};
  int count = 0;

  explicit Techniques(TechniqueMask mask) {
    for (int i = 0; i < kTechniques; ++i)
      if ((mask >> i & 1u) != 0) which[static_cast<size_t>(count++)] = i;
  }
  int operator[](int k) const { return which[static_cast<size_t>(k)]; }
};

// From the moments of all light. False where they say nothing: what the rule reads of each technique must be a number
// above zero, since a technique that has only seen zeros has no variance, which would give it everything.
bool fromAll(Allocation rule, const Moments& m, const Techniques& t, Fractions& a) {
  IntegrandMoments known;
  known.techniques = t.count;
  const double hits = double(m.hits);
  for (int k = 0; k < t.count; ++k) {
    const auto at = static_cast<size_t>(k), i = static_cast<size_t>(t[k]);
    const double mean = double(m.mean[i]) / hits, square = double(m.square[i]) / hits;
    if (!(rule == Allocation::kRepresentativity ? number(mean) : number(square) && std::isfinite(mean))) return false;
    known.mean[at] = mean, known.square[at] = square, known.variance[at] = std::max(0.0, square - mean * mean);
  }
  const Densities shares = fractions(rule, known);
  for (int k = 0; k < t.count; ++k) a[static_cast<size_t>(t[k])] = static_cast<float>(shares[static_cast<size_t>(k)]);
  return true;
}

// Adds one part's demand for samples, the root of what its second moment then is, times its fractions by the rule.
// False where its moments say nothing.
bool demand(Allocation rule, const PartMoments& part, double hits, const Techniques& t, Densities& a) {
  constexpr double kLeast = 1e-3;  // of m^2: of a pilot, m^2 may come out below mu^2; then not infinitely good
  if (part.integral == 0 || t.count == 0) return true;
  const double mu = double(part.integral) / hits;
  IntegrandMoments known;
  known.techniques = t.count;
  for (int k = 0; k < t.count; ++k) {
    const double second = double(part.second[static_cast<size_t>(t[k])]) / hits;
    if (!number(second)) return false;
    known.logSecond[static_cast<size_t>(k)] = std::log(second);
    known.variancePrim[static_cast<size_t>(k)] = std::max(second - mu * mu, kLeast * second);
  }
  const Densities shares = fractions(rule, known);
  double second = 0;  // integral f^2/q: at most this, by Jensen's inequality, and about that of equal counts
  for (int k = 0; k < t.count; ++k) second += shares[static_cast<size_t>(k)] * known.second(k);
  second = std::min(second, t.count * double(part.square) / hits);
  if (!number(second)) return false;
  for (int k = 0; k < t.count; ++k) a[static_cast<size_t>(t[k])] += std::sqrt(second) * shares[static_cast<size_t>(k)];
  return true;
}

}  // namespace

Fractions allocate(Allocation rule, const Moments& m, TechniqueMask used, float minimum) {
  constexpr TechniqueMask light = maskOf(kLight);
  const Techniques t(used);
  Fractions equal{};
  for (int k = 0; k < t.count; ++k) equal[static_cast<size_t>(t[k])] = 1.0f / static_cast<float>(t.count);
  if (t.count == 0 || !needsMoments(rule) || !(m.hits > 0)) return equal;

  Fractions a{};
  if (rule == Allocation::kSecondMoment || rule == Allocation::kInverseVariance) {
    Densities wanted{};
    const double hits = double(m.hits);
    if (!demand(rule, m.shared, hits, t, wanted) ||
        !demand(rule, m.unaimed, hits, Techniques(used & static_cast<TechniqueMask>(~light)), wanted) ||
        !demand(rule, m.exclusive, hits, Techniques(used & light), wanted))
      return equal;
    const double sum = wanted[0] + wanted[1] + wanted[2];
    if (!number(sum)) return equal;
    for (size_t i = 0; i < kTechniques; ++i) a[i] = static_cast<float>(wanted[i] / sum);
  } else if (!fromAll(rule, m, t, a)) {
    return equal;
  }
  Densities shares{};
  for (int k = 0; k < t.count; ++k) shares[static_cast<size_t>(k)] = double(a[static_cast<size_t>(t[k])]);
  shares = clampFractions(shares, t.count, double(minimum));
  for (int k = 0; k < t.count; ++k) a[static_cast<size_t>(t[k])] = static_cast<float>(shares[static_cast<size_t>(k)]);
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
