// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/alias.h"

#include <gtest/gtest.h>

#include "../statistics.h"

namespace wardmis {
namespace {

// Weights over fifteen powers of ten, some of them 0.
std::vector<double> weights(size_t n, test::Random& random) {
  std::vector<double> w(n);
  for (double& x : w) x = random.uniform() < 0.2 ? 0 : random.logUniform(1e-12, 1e3);
  w[n / 2] = 1;
  return w;
}

TEST(AliasTable, ProbabilitiesAreThoseOfTheWeights) {
  test::Random random(1);
  for (size_t n : {size_t{1}, size_t{2}, size_t{3}, size_t{1000}, size_t{1} << 21}) {
    const std::vector<double> w = weights(n, random);
    const AliasTable table(w);
    double sum = 0;
    for (uint32_t i = 0; i < n; ++i) {
      const auto p = double(table.probability(i));
      sum += p;
      EXPECT_EQ(p > 0, w[i] > 0) << i;
      // what a heavy entry gets of many light ones has their rounding
      ASSERT_NEAR(p, w[i] / table.sum(), 1e-6 * (w[i] / table.sum()) + 1e-7 / static_cast<double>(n)) << n << ' ' << i;
    }
    EXPECT_NEAR(sum, 1, 1e-6) << n;
  }
}

// The entries by their weight's power of ten, and what is left of u in each: chi-square over both with 2^22 draws. With
// u of 24 bits the table of 2^21 fails with p < 10^-300. Fixed seeds; by chance 4 in 10^5 others would fail.
TEST(AliasTable, DrawsWhatItSays) {
  test::Random random(2);
  for (size_t n : {size_t{1}, size_t{5}, size_t{1000}, size_t{1} << 21}) {
    const std::vector<double> w = weights(n, random);
    const AliasTable table(w);
    constexpr int kClasses = 17, kParts = 4, kDraws = 1 << 22;
    const auto classOf = [&](uint32_t i) { return static_cast<int>(std::floor(std::log10(w[i]))) + 13; };
    std::vector<double> expected(kClasses * kParts, 0), observed(kClasses * kParts, 0);
    for (uint32_t i = 0; i < n; ++i)
      for (int part = 0; part < kParts && w[i] > 0; ++part)
        expected[static_cast<size_t>(classOf(i) * kParts + part)] += double(table.probability(i)) * kDraws / kParts;
    for (int k = 0; k < kDraws; ++k) {
      double u = random.uniform();
      const uint32_t i = table.sample(u);
      ASSERT_GT(w[i], 0);
      ASSERT_TRUE(u >= 0 && u < 1);
      ++observed[static_cast<size_t>(classOf(i) * kParts + static_cast<int>(u * kParts))];
    }
    double statistic = 0;
    int cells = 0;
    for (size_t c = 0; c < expected.size(); ++c) {
      if (expected[c] < 5) continue;
      statistic += (observed[c] - expected[c]) * (observed[c] - expected[c]) / expected[c];
      ++cells;
    }
    const boost::math::chi_squared distribution(std::max(1, cells - 1));
    EXPECT_GT(boost::math::cdf(boost::math::complement(distribution, statistic)), 1e-5) << n;
  }
}

TEST(AliasTable, IsEmptyWithoutWeight) {
  EXPECT_TRUE(AliasTable(std::vector<double>{}).empty());
  EXPECT_TRUE(AliasTable(std::vector<double>{0, 0}).empty());
}

}  // namespace
}  // namespace wardmis
