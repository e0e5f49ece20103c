// SPDX-License-Identifier: GPL-3.0-or-later
// Sharing between more than three techniques: the same as between three where the others are absent, and unbiased where
// all are there.
#include <gtest/gtest.h>

#include "mis/allocation.h"
#include "mis/candidates.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

constexpr Allocation kRules[] = {
    Allocation::kEqual,           Allocation::kVariance,  Allocation::kStandardDeviation, Allocation::kSecondMoment,
    Allocation::kInverseVariance, Allocation::kEqualised, Allocation::kRepresentativity};

// Of [0, 1): technique i has density proportional to 1 + slope_i x; f is a smooth function, and the light, the last,
// does not see a part of it.
template <size_t K>
struct Line {
  TechniqueMask available = Techniques<K>::kAll;

  static float slope(size_t i) { return 3 * static_cast<float>(i) - 0.5f; }
  static float f(float x) { return 0.3f + x * x * x; }
  Fractions<K> densities(float x) const {
    Fractions<K> p{};
    for (size_t i = 0; i < K; ++i)
      if (has(available, i)) p[i] = (1 + slope(i) * x) / (1 + slope(i) / 2);
    if (x < 0.25f) p[K - 1] = 0;
    return p;
  }
  // By inversion; the light's below a quarter is thrown away, so that its density is not normalised: zeros that count.
  float sample(size_t i, Random& random) const {
    const float u = random.square<float>().x, s = slope(i), c = u * (1 + s / 2);
    return (-1 + std::sqrt(1 + 2 * s * c)) / s;
  }
};

template <size_t K>
Moments<K> momentsOf(const Line<K>& line, Random& random, int hits) {
  Moments<K> m;
  Fractions<K> n;
  n.fill(1);
  for (int h = 0; h < hits; ++h) {
    for (size_t i = 0; i < K; ++i) {
      if (!has(line.available, i)) continue;
      const float x = line.sample(i, random);
      const Fractions<K> p = line.densities(x);
      if (p[i] > 0) m.add(Line<K>::f(x), p, n, line.available);
    }
    m.hits += 1;
  }
  return m;
}

template <size_t K>
void isUnbiasedFor(Allocation rule, Weights weights) {
  const Line<K> line;
  Random random(1);
  const Fractions<K> a = allocate<K>(rule, momentsOf(line, random, 400), line.available, 0.02f);
  const int samples = 24;
  const Mixture<K> mixture(a, samples, weights);
  Estimate e;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::array<int, K> n = systematicCounts<K>(a, samples, random.square<float>().x);
    double sum = 0;
    for (size_t i = 0; i < K; ++i)
      for (int j = 0; j < n[i]; ++j) {
        const float x = line.sample(i, random);
        const Fractions<K> p = line.densities(x);
        if (p[i] > 0) sum += double(Line<K>::f(x) * mixture.scale(i, p, line.available));
      }
    e.add(sum);
  }
  EXPECT_LT(std::abs(e.mean() - 0.55) / e.error(), 4.5) << K << ' ' << name(rule) << ' ' << name(weights);
}

// 2 x 7 x 5 statistics of |z| < 4.5: a false alarm in 2100 runs.
TEST(TechniqueCounts, EveryRuleIsUnbiased) {
  for (Allocation rule : kRules)
    for (Weights w : {Weights::kBalance, Weights::kNonbalance, Weights::kPower, Weights::kCutoff, Weights::kMaximum}) {
      isUnbiasedFor<5>(rule, w);
      isUnbiasedFor<8>(rule, w);
    }
}

// Techniques 0, K - 2 and K - 1 of K are the lobe, cosine and light of three.
template <size_t K>
void agreesWithThree() {
  const auto to = [](size_t i) { return i == 0 ? size_t{0} : K - 3 + i; };
  const TechniqueMask mask = static_cast<TechniqueMask>(maskOf(0) | maskOf(K - 2) | maskOf(K - 1));
  Random random(2);
  Moments<3> few;
  Moments<K> many;
  CandidateLists<3> fewLists(12);
  CandidateLists<K> manyLists(12);
  CandidateSums<3> fewSums;
  CandidateSums<K> manySums;
  for (int h = 0; h < 60; ++h) {
    CandidateHit<3> fewHit(fewLists.of(0b111));
    CandidateHit<K> manyHit(manyLists.of(mask));
    for (int k = 0; k < 6; ++k) {
      Fractions<3> p{};
      Fractions<K> q{};
      for (size_t i = 0; i < 3; ++i) q[to(i)] = p[i] = static_cast<float>(random.logUniform(0.01, 10));
      const auto f = static_cast<float>(random.logUniform(0.01, 10));
      few.add(f, p, {2, 2, 2}, 0b111);
      Fractions<K> n;
      n.fill(2);
      many.add(f, q, n, mask);
      fewHit.add(f, p, {2, 2, 2}, 0b111, k % 2);
      manyHit.add(f, q, n, mask, k % 2);
    }
    few.hits += 1, many.hits += 1;
    fewHit.addTo(fewSums, {}), manyHit.addTo(manySums, {});
  }
  const auto same = [&](const Fractions<3>& a, const Fractions<K>& b, std::string_view what) {
    for (size_t i = 0; i < 3; ++i) EXPECT_FLOAT_EQ(a[i], b[to(i)]) << K << ' ' << what << ' ' << i;
  };
  for (Allocation rule : kRules)
    same(allocate<3>(rule, few, 0b111, 0.1f), allocate<K>(rule, many, mask, 0.1f), name(rule));
  SurfaceScatter<3> fewGains;
  SurfaceScatter<K> manyGains;
  same(chooseCandidate<3>(fewSums, fewGains += fewSums, fewLists.of(0b111), {}),
       chooseCandidate<K>(manySums, manyGains += manySums, manyLists.of(mask), {}), "auto");
}
TEST(TechniqueCounts, AbsentTechniquesChangeNothing) {
  agreesWithThree<5>();
  agreesWithThree<8>();
}

// Light that each technique finds alone keeps its share: that of the root of its second moment.
TEST(TechniqueCounts, WhatOneAloneFindsKeepsItsShare) {
  Moments<5> m;
  Fractions<5> n;
  n.fill(1);
  for (const auto& [t, f] : {std::pair<size_t, float>{1, 4}, {2, 2}, {4, 1}}) {
    Fractions<5> p{};
    p[t] = 1;
    m.add(f, p, n, maskOf(t));
  }
  m.hits = 1;
  const Fractions<5> a = allocate<5>(Allocation::kSecondMoment, m, 0b10110, 0);
  EXPECT_FLOAT_EQ(a[1], 4.0f / 7);
  EXPECT_FLOAT_EQ(a[2], 2.0f / 7);
  EXPECT_FLOAT_EQ(a[4], 1.0f / 7);
}

TEST(TechniqueCounts, CandidatesCoverAndSumToOne) {
  const CandidateLists<8> lists(16);
  for (unsigned mask = 1; mask <= Techniques<8>::kAll; ++mask)
    for (int c = 0; c < kCandidates<8>; ++c) {
      const Fractions<8> a = lists.of(static_cast<TechniqueMask>(mask)).at(c);
      float sum = 0;
      for (size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(a[i] > 0, has(static_cast<TechniqueMask>(mask), i));
        sum += a[i];
      }
      EXPECT_NEAR(sum, 1, 1e-5);
    }
}

}  // namespace
}  // namespace wardmis
