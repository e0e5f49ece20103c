// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/piecewise2d.h"

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

PiecewiseConstant2D tableOf(const std::vector<double>& w, int width) {
  const auto columns = static_cast<size_t>(width);
  return {w.size() / columns, width, [&](size_t y, double* row) { std::copy_n(&w[y * columns], columns, row); }};
}

struct Grid {
  size_t rows;
  int width;
};
constexpr Grid kGrids[] = {{1, 1}, {1, 2}, {3, 1}, {20, 50}, {1024, 2048}};

TEST(PiecewiseConstant2D, ProbabilitiesAreThoseOfTheWeights) {
  test::Random random(1);
  for (const Grid& g : kGrids) {
    const std::vector<double> w = weights(g.rows * static_cast<size_t>(g.width), random);
    const PiecewiseConstant2D table = tableOf(w, g.width);
    double sum = 0;
    for (uint32_t i = 0; i < w.size(); ++i) {
      const auto p = double(table.probability(i));
      sum += p;
      if (w[i] == 0) {
        EXPECT_EQ(p, 0) << i;
      }
      const double* row = &w[i / static_cast<uint32_t>(g.width) * static_cast<size_t>(g.width)];
      const double whole = std::accumulate(row, row + g.width, 0.0) / table.sum();
      ASSERT_NEAR(p, w[i] / table.sum(), 1e-6 * (w[i] / table.sum()) + 0x1p-24 * whole) << i;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

// The cells by their weight's power of ten, and what is left of both coordinates in each: chi-square with 2^22 draws.
// Fixed seeds; by chance 5 in 10^5 others would fail.
TEST(PiecewiseConstant2D, DrawsWhatItSays) {
  test::Random random(2);
  for (const Grid& g : kGrids) {
    const std::vector<double> w = weights(g.rows * static_cast<size_t>(g.width), random);
    const PiecewiseConstant2D table = tableOf(w, g.width);
    constexpr int kClasses = 17, kParts = 4, kDraws = 1 << 22;
    const auto classOf = [&](uint32_t i) { return static_cast<int>(std::floor(std::log10(w[i]))) + 13; };
    std::vector<double> expected(kClasses * kParts, 0), observed(kClasses * kParts, 0);
    for (uint32_t i = 0; i < w.size(); ++i)
      for (int part = 0; part < kParts && w[i] > 0; ++part)
        expected[static_cast<size_t>(classOf(i) * kParts + part)] += double(table.probability(i)) * kDraws / kParts;
    for (int k = 0; k < kDraws; ++k) {
      ChoicePoint u{random.uniform(), static_cast<float>(std::floor(random.uniform() * 0x1p24) * 0x1p-24)};
      table.prefetch(u);
      const uint32_t i = table.sample(u);
      ASSERT_GT(table.probability(i), 0);
      ASSERT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
      // cells of few multiples of 2^-24 have few places within
      const int part = table.probability(i) > 1e-4f ? (u.x < 0.5 ? 0 : 1) + (u.y < 0.5f ? 0 : 2) : k % kParts;
      ++observed[static_cast<size_t>(classOf(i) * kParts + part)];
    }
    double statistic = 0;
    int cells = 0;
    for (size_t c = 0; c < expected.size(); ++c) {
      if (expected[c] < 5) continue;
      statistic += (observed[c] - expected[c]) * (observed[c] - expected[c]) / expected[c];
      ++cells;
    }
    const boost::math::chi_squared distribution(std::max(1, cells - 1));
    EXPECT_GT(boost::math::cdf(boost::math::complement(distribution, statistic)), 1e-5) << g.rows << ' ' << g.width;
  }
}

// Of N even points a part of the grid gets its share, and not that of independent ones, which scatter by the root of
// N p (1 - p) = 3.5: of a sun in a sky a table that hopped about gave every pixel another number.
TEST(PiecewiseConstant2D, KeepsPointsEven) {
  constexpr int kWidth = 64, kRows = 32;
  std::vector<double> w(size_t{kWidth} * kRows, 1);
  double sun = 0;
  for (int y = 20; y < 22; ++y)
    for (int x = 30; x < 32; ++x) sun += w[static_cast<size_t>(y * kWidth + x)] = 900;
  const PiecewiseConstant2D table = tableOf(w, kWidth);
  const double share = sun / table.sum();
  double most = 0, squares = 0;
  constexpr uint32_t kPixels = 200, kPoints = 64;
  const Sampler sampler(SamplerType::kSobol, 3, kPoints);
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    double drawn = 0;
    for (uint32_t s = 0; s < kPoints; ++s) {
      ChoicePoint u = sampler.getChoice(sampler.pixelKey(pixel, 1), 5, s);
      const uint32_t cell = table.sample(u);
      drawn += w[cell] > 1 ? 1 : 0;
    }
    const double off = drawn - share * kPoints;
    most = std::max(most, std::abs(off)), squares += off * off / kPixels;
  }
  EXPECT_LT(most, 4);
  EXPECT_LT(std::sqrt(squares), 0.4 * std::sqrt(kPoints * share * (1 - share)));
}

TEST(PiecewiseConstant2D, IsEmptyWithoutWeight) {
  EXPECT_TRUE(PiecewiseConstant2D().empty());
  EXPECT_TRUE(tableOf({0, 0}, 2).empty());
}

}  // namespace
}  // namespace wardmis
