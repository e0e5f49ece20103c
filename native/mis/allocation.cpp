// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/allocation.h"

#include <algorithm>
#include <bit>

namespace wardmis {

Fractions allocate(AllocationRule rule, const Moments& m, TechniqueMask used, float minimum) {
  const int n = std::popcount(used);
  Fractions a{};
  const auto each = [&](auto&& f) {
    for (int i = 0; i < kTechniques; ++i)
      if ((used >> i & 1u) != 0) f(i);
  };
  const auto equal = [&] { each([&](int i) { a[i] = 1.0f / static_cast<float>(n); }); };
  if (n == 0) return a;
  if (!needsMoments(rule) || !(m.hits > 0)) return equal(), a;

  float sum = 0;
  bool usable = true;
  each([&](int i) {
    if (rule == AllocationRule::kVariance) {
      const float mean = m.mean[i] / m.hits, sigma2 = m.square[i] / m.hits - mean * mean;
      usable &= m.square[i] > 0 && std::isfinite(sigma2);
      a[i] = std::max(0.0f, sigma2);
    } else {
      usable &= m.second[i] > 0 && std::isfinite(m.second[i]);
      a[i] = m.hits / m.second[i];
    }
    sum += a[i];
  });
  if (!usable || !(sum > 0) || !std::isfinite(sum)) return equal(), a;

  // Clamp: what lies under the minimum is raised to it, at the cost of the others in proportion.
  const float floor = std::min(minimum, 1.0f / static_cast<float>(n));
  TechniqueMask raised = 0;
  for (bool again = true; again;) {
    again = false;
    float free = 0;
    each([&](int i) { free += (raised >> i & 1u) != 0 ? 0 : a[i]; });
    const float rest = 1 - floor * static_cast<float>(std::popcount(raised));
    each([&](int i) {
      if ((raised >> i & 1u) == 0 && a[i] * rest < floor * free * (1 - 1e-6f)) raised |= 1u << i, again = true;
    });
    if (!again) each([&](int i) { a[i] = (raised >> i & 1u) != 0 ? floor : a[i] * rest / free; });
  }
  return a;
}

Fractions combineSplit(const Fractions& specular, const Fractions& diffuse) {
  Fractions a{specular[kLobe], diffuse[kCosine], std::max(specular[kLight], diffuse[kLight])};
  const float sum = a[kLobe] + a[kCosine] + a[kLight];
  for (float& x : a) x = sum > 0 ? x / sum : 0;
  return a;
}

Fractions allocateSplit(AllocationRule rule, const Moments& specular, const Moments& diffuse, TechniqueMask available,
                        float minimum) {
  const auto one = [&](const Moments& m, Technique own, TechniqueMask used) {
    return (available & maskOf(own)) != 0 ? allocate(rule, m, available & used, minimum) : Fractions{};
  };
  const Fractions s = one(specular, kLobe, kSpecularTechniques), d = one(diffuse, kCosine, kDiffuseTechniques);
  return restrict(combineSplit(s, d), available);
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

std::string_view name(AllocationRule r) {
  constexpr std::string_view names[] = {"equal", "variance", "second-moment", "albedo"};
  return names[static_cast<int>(r)];
}
std::string_view name(WeightRule r) {
  constexpr std::string_view names[] = {"balance", "nonbalance", "power"};
  return names[static_cast<int>(r)];
}
std::string_view name(Integrand r) {
  constexpr std::string_view names[] = {"split", "joint"};
  return names[static_cast<int>(r)];
}

}  // namespace wardmis
