// SPDX-License-Identifier: GPL-3.0-or-later
// `auto`: what it chooses from pilot samples, and that it falls back to equal counts where it cannot know.
#include "mis/candidates.h"

#include <gtest/gtest.h>

#include "mis/adaptive.h"
#include "ward_case.h"

namespace wardmis {
namespace {

using namespace test;

constexpr int kSamples = 12;  // at a hit
const CandidateLists<3> lists(kSamples);
const CandidateList<3>& all = lists.of(Techniques<3>::kAll);

// The choice from a pilot of so many hits, each of two samples a technique.
Fractions<3> choose(const WardCase& c, int hits, const Fractions<3>& cost, uint64_t seed) {
  Random random(seed);
  const Mixture<3> equal({1.0f / 3, 1.0f / 3, 1.0f / 3}, 3 * kSets, Weights::kBalance);
  CandidateSums<3> sums;
  for (int h = 0; h < hits; ++h) {
    CandidateHit<3> hit(all);
    for (int i = 0; i < 3; ++i)
      for (int set = 0; set < kSets; ++set) {
        const Sampled s = c.sample(i, random);
        hit.add(s.f, s.p, equal.n, Techniques<3>::kAll, set);
      }
    hit.addTo(sums, {0, cost});
  }
  SurfaceScatter<3> surface;
  return chooseCandidate<3>(sums, surface += sums, all, {0, cost});
}

// Measured N Var of one estimate with these fractions.
double variance(const WardCase& c, const Fractions<3>& a, uint64_t seed) {
  Random random(seed);
  const int n = 4 * kSamples;  // whole counts: rounded at random, they would be noise of their own
  const Mixture<3> mixture(a, n, Weights::kBalance);
  Estimate e;
  for (int k = 0; k < 4000; ++k)
    e.add(estimate(c, mixture, systematicCounts<3>(a, n, random.square<float>().x), random));
  return n * e.variance();
}

TEST(Candidates, EqualOnesComeFirstAndAllSumToOne) {
  for (unsigned mask = 1; mask <= Techniques<3>::kAll; ++mask) {
    const CandidateList<3>& list = lists.of(static_cast<TechniqueMask>(mask));
    EXPECT_EQ(list.at(0), restrict<3>({1, 1, 1}, static_cast<TechniqueMask>(mask)));
    for (int c = 0; c < kCandidates<3>; ++c) {
      const Fractions<3> a = list.at(c);
      EXPECT_NEAR(double(a[0]) + double(a[1]) + double(a[2]), 1, 1e-6);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(a[static_cast<size_t>(k)] > 0, (mask >> k & 1u) != 0);
    }
  }
}

// Sobol's points want counts that are few powers of two: quarters of a sample, whatever the samples of a hit.
TEST(Candidates, AreWholeQuartersOfASample) {
  for (int samples : {1, 2, 3, 4, 7, 16, 256}) {
    const CandidateLists<3> some(samples);
    for (unsigned mask = 1; mask <= Techniques<3>::kAll; ++mask)
      for (int c = 1; c < kCandidates<3>; ++c)
        for (float share : some.of(static_cast<TechniqueMask>(mask)).at(c)) {
          const float quarters = 4 * static_cast<float>(samples) * share;
          EXPECT_NEAR(quarters, std::round(quarters), 1e-3) << samples << " samples, techniques " << mask;
        }
  }
}

// 1500 hits are what 7 x 7 pixels of 32 samples give: then the choice is better than equal counts, by what theory says.
TEST(Candidates, BeatEqualCountsWhereTheoryDoes) {
  int better = 0, cases = 0;
  for (const auto& json : golden()["three_technique_cases"]) {
    const WardCase c(json);
    const Fractions<3> a = choose(c, 1500, {1, 1, 1}, 1);
    const double chosen = variance(c, a, 2), equal = variance(c, {1.0f / 3, 1.0f / 3, 1.0f / 3}, 2);
    EXPECT_LT(chosen, 1.05 * equal) << json["input"].dump();
    better += chosen < 0.7 * equal ? 1 : 0;
    ++cases;
  }
  EXPECT_EQ(cases, 6);
  EXPECT_GE(better, 4);
}

TEST(Candidates, FallBackToEqualCountsWhereTheGainIsNoise) {
  const Fractions<3> equal = all.at(0);
  EXPECT_EQ(chooseCandidate<3>({}, {}, all, {1, 1, 1}), equal);
  int fallen = 0;
  for (const auto& json : golden()["three_technique_cases"])
    for (uint64_t seed = 0; seed < 10; ++seed) fallen += choose(WardCase(json), 1, {1, 1, 1}, seed) == equal ? 1 : 0;
  EXPECT_GE(fallen, 57);  // of 60; a single hit proves nothing
}

// The sums are what they are said to be: of a light sample that serves two integrands, Var[f_s/q_s + f_d/q_d]. Lobe,
// cosine and light are uniform on [0, 1] here, with f_s = 2x and f_d = 1 + x; all is `shade` times that at a hit, which
// is no scatter that whole counts could change.
TEST(Candidates, PredictTheVarianceOfSplitIntegrands) {
  const Fractions<3> n{2, 2, 2}, p{1, 1, 1};
  Random random(4);
  CandidateSums<3> sums;
  const int hits = 200000;
  for (int h = 0; h < hits; ++h) {
    CandidateHit<3> hit(all);
    const float shade = random.square<float>().x < 0.5f ? 2 : 0;
    for (int t = 0; t < 3; ++t)
      for (int set = 0; set < kSets; ++set) {
        const float x = random.square<float>().x, fs = shade * 2 * x, fd = shade * (1 + x);
        if (t != 1) hit.add(fs, p, n, TechniqueMask(0b101), set);
        if (t != 0) hit.add(fd, p, n, TechniqueMask(0b110), set);
        hit.addBoth(0, fs, 1, fd, p, n);
      }
    hit.addTo(sums, {1, 1, 1});
  }
  for (int c = 0; c < kCandidates<3>; ++c) {
    const Fractions<3> a = all.at(c);
    const double s = 1.0 / double(a[0] + a[2]), d = 1.0 / double(a[1] + a[2]), l = double(a[2]);
    // E f_s^2 = 4/3, E f_d^2 = 7/3, E f_s f_d = 5/3; E f_s = 1, E f_d = 3/2; E shade = 1, E shade^2 = 2
    const double second = s * 4 / 3 + d * 7 / 3 + 2 * l * s * d * 5 / 3;
    const double means[] = {s, 1.5 * d, s + 1.5 * d};
    double expected = second;
    for (size_t i = 0; i < 3; ++i)
      expected -= (double(a[i]) - double(all.spread[i][static_cast<size_t>(c)])) * means[i] * means[i];
    EXPECT_NEAR(double(sums.within[c]) / hits, 2 * expected, 0.03 * second) << c;
    EXPECT_NEAR(double(sums.mean[0][c]) / hits, s, 0.02 * s);
    EXPECT_NEAR(double(sums.mean[1][c]) / hits, 1.5 * d, 0.02 * d);
  }
  EXPECT_NEAR(double(sums.integral) / hits, 2.5, 0.03);
}

// What is rare and bright: the neighbourhood did not meet it, the rest of its surface did.
TEST(Candidates, AGainHasTheScatterOfItsSurface) {
  const Fractions<3> n{2, 2, 2};
  const auto add = [&](CandidateSums<3>& sums, float f, const Fractions<3>& p) {
    CandidateHit<3> hit(all);
    for (int set = 0; set < kSets; ++set) hit.add(f, p, n, Techniques<3>::kAll, set);
    hit.addTo(sums, {1, 1, 1});
  };
  CandidateSums<3> here;
  for (int h = 0; h < 200; ++h) add(here, h % 2 == 0 ? 1.0f : 1.1f, {4, 0.1f, 0.1f});
  SurfaceScatter<3> calm, rare;
  calm += here;
  CandidateSums<3> elsewhere = here;
  add(elsewhere, 1000, {0, 0.1f, 4});  // the light alone finds it
  rare += elsewhere;
  EXPECT_GT(chooseCandidate<3>(here, calm, all, {1, 1, 1})[0], 0.5f);
  EXPECT_EQ(chooseCandidate<3>(here, rare, all, {1, 1, 1}), all.at(0));
}

// Few samples do where a hit's all tell the same, as before a mirror, however much hits differ from each other; not
// where one of them may miss, nor where the rest of the surface has what is rare.
TEST(Candidates, FewSamplesSufficeWhereAllTellTheSame) {
  const Fractions<3> n{2, 2, 2};
  // miss: what each technique's second sample finds less
  const auto add = [&](CandidateSums<3>& sums, float f, float miss) {
    CandidateHit<3> hit(all);
    for (int set = 0; set < kSets; ++set)
      for (int technique = 0; technique < 3; ++technique)
        hit.add(set == 0 ? f : f - miss, {1, 1, 1}, n, Techniques<3>::kAll, set);
    hit.addTo(sums, {0, {1, 1, 1}});
  };
  CandidateSums<3> mirror, few, soft, dark;
  for (int h = 0; h < 100; ++h) {
    const float f = h % 2 == 0 ? 1.0f : 1.2f;
    add(mirror, f, 0), add(soft, f, 0.1f), add(dark, 0, 0);
    if (h < 4) add(few, f, 0);
  }
  const auto surfaceOf = [](const CandidateSums<3>& sums) {
    SurfaceScatter<3> surface;
    return surface += sums;
  };
  EXPECT_TRUE(suffice(2, mirror, surfaceOf(mirror)));
  EXPECT_FALSE(suffice(2, soft, surfaceOf(soft)));
  EXPECT_FALSE(suffice(2, few, surfaceOf(few)));
  EXPECT_FALSE(suffice(2, dark, surfaceOf(dark)));
  CandidateSums<3> elsewhere = mirror;
  add(elsewhere, 1000, 500);
  EXPECT_FALSE(suffice(2, mirror, surfaceOf(elsewhere)));
}

// A slit far away sees the edge of a light under 1e-25: the square of that is no float, and a single NaN among the sums
// was all that the surface said.
TEST(Candidates, HitsBeyondFloatDoNotSpoilTheOthers) {
  const Fractions<3> n{2, 2, 2};
  CandidateSums<3> sums;
  for (const Fractions<3>& p : {Fractions<3>{1e-18f, 1e-25f, 1e-25f}, Fractions<3>{1e-24f, 1e-25f, 1e-25f},
                                Fractions<3>{0, 0, 1e-30f}, Fractions<3>{1, 1, 1}}) {
    CandidateHit<3> hit(all);
    for (int set = 0; set < kSets; ++set) {
      hit.add(1e-18f, p, n, TechniqueMask(0b101), set), hit.add(1e-18f, p, n, TechniqueMask(0b110), set);
      hit.addBoth(0, 1e-18f, 1, 1e-18f, p, n);
    }
    hit.addTo(sums, {1, 1, 1});
    for (int c = 0; c < kCandidates<3>; ++c) EXPECT_TRUE(std::isfinite(sums.gain2[c]) && std::isfinite(sums.within[c]));
  }
  EXPECT_EQ(sums.hits, 3);  // all but the third
}

TEST(Candidates, AnExpensiveTechniqueGetsLess) {
  const WardCase c(golden()["three_technique_cases"][1]);
  const Fractions<3> a = choose(c, 3000, {1, 1, 1}, 3), b = choose(c, 3000, {1, 1, 30}, 3);
  EXPECT_LE(b[2], a[2]);
  EXPECT_LE(b[2], 0.1f);
}

TEST(ClampFractions, RaisesAndKeepsTheSum) {
  const Densities a = clampFractions({0.98, 0.02, 0}, 3, 0.05);
  EXPECT_DOUBLE_EQ(a[0] + a[1] + a[2], 1);
  EXPECT_DOUBLE_EQ(a[1], 0.05);
  EXPECT_DOUBLE_EQ(a[2], 0.05);
}

}  // namespace
}  // namespace wardmis
