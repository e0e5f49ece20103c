// SPDX-License-Identifier: GPL-3.0-or-later
// systematicCounts: fractions to numbers of samples.
#include <gtest/gtest.h>

#include <numeric>

#include "math/random.h"
#include "mis/allocation.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

Fractions<3> randomFractions(Random& random) {
  double a[3], sum = 0;
  do {
    sum = 0;
    for (double& x : a) sum += x = random.uniform() < 0.3 ? 0 : random.logUniform(1e-3, 1);
  } while (sum == 0);
  return {static_cast<float>(a[0] / sum), static_cast<float>(a[1] / sum), static_cast<float>(a[2] / sum)};
}

TEST(SystematicCounts, RoundUpOrDownAndSumUp) {
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const Fractions<3> a = randomFractions(random);
    const int n = random.integer(1, k % 2 == 0 ? 8 : 300);
    const float u = k % 16 == 0 ? 0 : k % 16 == 1 ? 0x1.fffffep-1f : random.square<float>().x;
    const auto counts = systematicCounts<3>(a, n, u);
    ASSERT_EQ(std::accumulate(counts.begin(), counts.end(), 0), n);
    for (size_t i = 0; i < 3; ++i) {
      const double expected = double(a[i]) * n, rounding = 2e-7 * n;  // of the fractions' running sum
      ASSERT_GE(counts[i], std::floor(expected - rounding)) << a[i] << " of " << n << " u " << u;
      ASSERT_LE(counts[i], std::ceil(expected + rounding)) << a[i] << " of " << n << " u " << u;
      if (a[i] == 0) {
        ASSERT_EQ(counts[i], 0) << "a technique without a share, u " << u;
      }
    }
  }
}

// The mean over u is n a_i: the counts are steps in u, so that the midpoint rule over M points errs by 1/M at most.
TEST(SystematicCounts, AreRightInTheMean) {
  Random random(2);
  constexpr int kSteps = 1 << 14;
  for (int k = 0; k < 30; ++k) {
    const Fractions<3> a = randomFractions(random);
    const int n = random.integer(1, 40);
    double sum[3] = {};
    for (int j = 0; j < kSteps; ++j) {
      const auto counts = systematicCounts<3>(a, n, (static_cast<float>(j) + 0.5f) / kSteps);
      for (size_t i = 0; i < 3; ++i) sum[i] += counts[i];
    }
    for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(sum[i] / kSteps, double(a[i]) * n, 1.0 / kSteps + 4e-7 * n);
  }
}

// What makes a pixel's counts whole: over the visits 2^k ... 2^(k+1) - 1 each technique gets exactly its share.
TEST(WholeCounts, AreExactOverBlocksOfVisits) {
  Random random(3);
  const Sampler sampler(SamplerType::kIndependent, 7, 1);
  for (uint32_t k = 0; k < 40; ++k) {
    const Fractions<3> a = randomFractions(random);
    const int n = random.integer(3, 12);
    for (uint32_t block : {4u, 8u, 16u, 32u, 64u, 128u}) {
      const Fractions<3> whole = wholeCounts<3>(a, n, block);
      const float units = static_cast<float>(n) * static_cast<float>(std::min(block, 64u));
      std::array<int, 3> total{};
      for (uint32_t visit = block; visit < 2 * block; ++visit) {
        const auto counts = systematicCounts<3>(whole, n, sampler.spread1D(k, 2, visit));
        for (size_t i = 0; i < 3; ++i) total[i] += counts[i];
      }
      for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(total[i], std::lround(whole[i] * static_cast<float>(n) * static_cast<float>(block))) << i;
        EXPECT_EQ(whole[i] > 0, a[i] > 0);
        EXPECT_NEAR(whole[i], a[i], 2.01f / units);
      }
    }
  }
  const Fractions<3> a{0.1f, 0.2f, 0.7f};
  EXPECT_EQ(wholeCounts<3>(a, 3, 2), a) << "too few visits for shares: rounding would change them too much";
}

TEST(SystematicCounts, WholeSharesDoNotVary) {
  for (float u : {0.0f, 0.1f, 0.5f, 0x1.fffffep-1f}) {
    EXPECT_EQ(systematicCounts<3>({0.25f, 0.5f, 0.25f}, 8, u), (std::array<int, 3>{2, 4, 2}));
    EXPECT_EQ(systematicCounts<3>({1, 0, 0}, 5, u), (std::array<int, 3>{5, 0, 0}));
    EXPECT_EQ(systematicCounts<3>({0, 1, 0}, 5, u), (std::array<int, 3>{0, 5, 0}));
    EXPECT_EQ(systematicCounts<3>({0, 0, 1}, 5, u), (std::array<int, 3>{0, 0, 5}));
    // fractions whose float sum misses 1
    const auto third = systematicCounts<3>({1.0f / 3, 1.0f / 3, 1.0f / 3}, 300, u);
    for (int c : third) EXPECT_NEAR(c, 100, u == 0 ? 1 : 0);
  }
}

}  // namespace
}  // namespace wardmis
