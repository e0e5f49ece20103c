// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot's pooled moments against the golden file's exact m_i^2 and sigma^2_i,eq.
#include "mis/moments.h"

#include <gtest/gtest.h>

#include "ward_case.h"

namespace wardmis {
namespace {

using namespace test;

// 5 standard errors of 500 batches; 4 or 6 comparisons a case, 1e-4 false alarms in all.
void check(const WardCase& c, int perTechnique, uint64_t seed) {
  SCOPED_TRACE(c.input.dump());
  Random random(seed);
  const Moments<3> exact = exactMoments(c);
  Fractions<3> n{};
  for (int i = 0; i < c.techniques; ++i) n[static_cast<size_t>(i)] = static_cast<float>(perTechnique + i);  // unequal
  Estimate second[3], variance[3];
  for (int batch = 0; batch < 500; ++batch) {
    Moments<3> m;
    for (int hit = 0; hit < 16; ++hit) {
      Moments<3> one;
      for (int i = 0; i < c.techniques; ++i)
        for (int j = 0; j < perTechnique + i; ++j) {
          const Sampled s = c.sample(i, random);
          one.add(s.f, s.p, n, c.used);
        }
      one.hits = 1;
      m += one;
    }
    ASSERT_EQ(m.hits, 16);
    for (size_t i = 0; i < static_cast<size_t>(c.techniques); ++i) {
      second[i].add(double(m.second(static_cast<int>(i))) / 16);
      // sigma^2 about the known mean: the estimate is linear, so without bias
      const double mean = double(exact.mean[i]);
      variance[i].add(double(m.square[i]) / 16 - 2 * mean * double(m.mean[i]) / 16 + mean * mean);
    }
  }
  for (size_t i = 0; i < static_cast<size_t>(c.techniques); ++i) {
    const double sigma2 = c.techniques == 3 ? c.expect["sigma2_eq"][i].get<double>()
                                            : c.expect["sigma2_" + std::to_string(i + 1) + "_eq"].get<double>();
    EXPECT_NEAR(second[i].mean(), double(exact.shared.second[i]), 5 * second[i].error()) << "m^2 of " << i;
    EXPECT_NEAR(variance[i].mean(), sigma2, 5 * variance[i].error()) << "sigma^2 of " << i;
    EXPECT_LT(second[i].error(), 0.1 * second[i].mean());  // the comparison says something
  }
}

TEST(Moments, PooledEstimatesAgreeWithTheExactOnes) {
  uint64_t seed = 1;
  int checked = 0;
  for (const auto& json : golden()["estimator_cases"]) {
    if (!WardCase::is(json)) continue;
    const WardCase c(json);
    if (c.alpha() < 0.05) continue;
    check(c, 4, seed++);
    ++checked;
  }
  EXPECT_GE(checked, 12);
}
TEST(Moments, OfThreeTechniques) {
  uint64_t seed = 100;
  for (const auto& json : golden()["three_technique_cases"]) {
    const WardCase c(json);
    if (c.alpha() >= 0.05) check(c, 4, seed++);
  }
}

TEST(Moments, ZerosAndUnusedTechniquesAddNothing) {
  Moments<3> m;
  m.add(0, {1, 1, 1}, {1, 1, 1}, Techniques<3>::kAll);
  EXPECT_EQ(m.shared.second, (Fractions<3>{}));
  m.add(2, {0.25f, 0.5f, 7}, {4, 4, 4}, maskOf(0) | maskOf(1));
  EXPECT_EQ(m.unaimed.second, (Fractions<3>{2 / 0.25f * 2 / 3, 2 / 0.5f * 2 / 3, 0}));
  EXPECT_EQ(m.mean[2], 0);
  EXPECT_EQ(m.square[2], 0);
}

// Each sample is of the part that its densities say. Where the lobe's density is no float there is light that it does
// not find: its second moment is beyond all, not what is left without that light.
TEST(Moments, KnowWhatTheLightTechniqueFinds) {
  const Fractions<3> n{2, 2, 2};
  Moments<3> m;
  m.add(1, {1, 0, 1}, n, TechniqueMask(0b101));
  m.add(1, {1, 0, 0}, n, TechniqueMask(0b101));
  m.add(1, {0, 0, 1}, n, maskOf(2));
  EXPECT_EQ(m.shared.second, (Fractions<3>{0.25f, 0, 0.25f}));
  EXPECT_EQ(m.unaimed.second, (Fractions<3>{0.5f, 0, 0}));
  EXPECT_EQ(m.exclusive.second, (Fractions<3>{0, 0, 0.5f}));
  EXPECT_EQ(m.shared.integral, 0.25f);
  EXPECT_EQ(m.shared.square, 0.125f);
  EXPECT_EQ(m.mean, (Fractions<3>{0.125f + 0.5f, 0, 0.125f + 0.5f}));
  Moments<3> joint;
  joint.add(1, {0, 1, 1}, n, Techniques<3>::kAll);
  EXPECT_GE(joint.shared.second[0], 1e29f);
}

}  // namespace
}  // namespace wardmis
