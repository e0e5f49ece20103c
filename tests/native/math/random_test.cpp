// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/random.h"

#include <gtest/gtest.h>

#include <numeric>
#include <set>

#include "statistics.h"

namespace wardmis {
namespace {

constexpr SamplerType kTypes[] = {SamplerType::kIndependent, SamplerType::kStratified, SamplerType::kSobol};

// Number of a unit interval's equal cells that holds v.
uint32_t cellOf(float v, uint32_t cells) { return static_cast<uint32_t>(double(v) * cells); }

TEST(Sobol, AlignedBlocksAreNets) {
  const Sampler sampler(SamplerType::kSobol, 1, 16);
  for (uint32_t pixel = 0; pixel < 5; ++pixel)
    for (uint32_t dimension = 0; dimension < 4; ++dimension)
      for (uint32_t m = 0; m <= 9; ++m)
        for (uint32_t block = 0; block < 3; ++block) {
          const uint32_t n = 1u << m, key = sampler.pixelKey(pixel, 3 * pixel);
          for (uint32_t a = 0; a <= m; ++a) {  // every elementary interval 2^-a x 2^-(m-a) holds exactly one point
            std::vector<int> hits(n, 0);
            for (uint32_t j = 0; j < n; ++j) {
              const Vec2f p = sampler.get2D(key, dimension, block * n + j);
              ++hits[(cellOf(p.x, 1u << a) << (m - a)) + cellOf(p.y, 1u << (m - a))];
            }
            ASSERT_EQ(std::count(hits.begin(), hits.end(), 1), n) << "m " << m << " a " << a << " block " << block;
          }
        }
}

TEST(Sobol, AlignedBlocksAreNetsInOneDimension) {
  const Sampler sampler(SamplerType::kSobol, 7, 1);
  for (uint32_t m = 0; m <= 12; ++m) {
    std::set<uint32_t> cells;
    for (uint32_t j = 0; j < 1u << m; ++j) cells.insert(cellOf(sampler.get1D(5, 2, (3u << m) + j), 1u << m));
    EXPECT_EQ(cells.size(), 1u << m);
  }
}

// Number of the 2^a x 2^(m-a) intervals that hold none of the points that `of` gives, of 2^m visits.
template <class Of>
size_t emptyCells(uint32_t m, uint32_t a, const Of& of) {
  std::set<uint32_t> cells;
  for (uint32_t j = 0; j < 1u << m; ++j)
    of(j, [&](Vec2f p) { cells.insert((cellOf(p.x, 1u << a) << (m - a)) + cellOf(p.y, 1u << (m - a))); });
  return (size_t{1} << m) - cells.size();
}

// Of a technique all points are a net, and two points a visit fill twice as many intervals along each axis.
TEST(Visit, PointsAreNets) {
  const Sampler sampler(SamplerType::kSobol, 1, 16);
  for (uint32_t pixel = 0; pixel < 5; ++pixel)
    for (uint32_t m = 0; m <= 8; ++m) {
      const auto visit = [&](uint32_t j) { return Sampler::Visit(sampler, sampler.pixelKey(pixel, 3), 7, j); };
      for (uint32_t a = 0; a <= m; ++a)
        EXPECT_EQ(emptyCells(m, a, [&](uint32_t j, const auto& add) { add(visit(j).point<Vec2f>(9, 0)); }), 0u);
      for (uint32_t a : {0u, m + 1}) {
        const auto both = [&](uint32_t j, const auto& add) {
          if (j % 2 == 0)  // emptyCells counts 2^(m + 1) points
            for (uint32_t k : {0u, 1u}) add(visit(j / 2).point<Vec2f>(9, k));
        };
        EXPECT_EQ(emptyCells(m + 1, a, both), 0u) << m;
      }
    }
}

// Where one number decides which visits there are, the points of these are as even as three dimensions can be: of 2^m
// visits half remain, and each fourth of an interval holds one at least. With orders of their own a random half
// remains.
TEST(Visit, PointsOfSomeVisitsAreEven) {
  const Sampler sampler(SamplerType::kSobol, 1, 16);
  for (uint32_t pixel = 0; pixel < 20; ++pixel)
    for (uint32_t half = 0; half < 3; ++half)
      for (uint32_t m = 6; m <= 9; ++m) {
        std::set<uint32_t> x, y;
        for (uint32_t j = 0; j < 1u << m; ++j) {
          const Sampler::Visit visit(sampler, sampler.pixelKey(pixel, 3), 0, j);
          const Vec2f film = visit.film(0), point = visit.point<Vec2f>(4, 0);
          if ((half == 0 ? visit.counts(2) : half == 1 ? film.x : film.y) >= 0.5f) continue;
          x.insert(cellOf(point.x, 1u << (m - 3))), y.insert(cellOf(point.y, 1u << (m - 3)));
        }
        EXPECT_EQ(x.size(), 1u << (m - 3)) << half << ' ' << m;
        EXPECT_EQ(y.size(), 1u << (m - 3)) << half << ' ' << m;
      }
}

TEST(Stratified, FillsEveryCell) {
  for (uint32_t block : {1u, 2u, 3u, 5u, 16u, 37u, 256u}) {
    const Sampler sampler(SamplerType::kStratified, 3, block);
    const auto columns = static_cast<uint32_t>(std::sqrt(block)), rows = (block + columns - 1) / columns,
               cells = rows * columns;
    for (uint32_t pass = 0; pass < 3; ++pass) {
      std::set<uint32_t> filled, line;
      for (uint32_t j = 0; j < cells; ++j) {
        const Vec2f p = sampler.get2D(11, 4, pass * cells + j);
        filled.insert(cellOf(p.y, rows) * columns + cellOf(p.x, columns));
      }
      for (uint32_t j = 0; j < block; ++j) line.insert(cellOf(sampler.get1D(11, 4, pass * block + j), block));
      EXPECT_EQ(filled.size(), cells) << block;
      EXPECT_EQ(line.size(), block) << block;
    }
  }
}

// (cell + jitter) of the last column rounds up to the number of columns about once in 2^25 points; here is one.
TEST(Stratified, StaysBelowOne) {
  const Sampler sampler(SamplerType::kStratified, 1, 16);
  EXPECT_LT(sampler.get2D(sampler.pixelKey(746194, 0), 0, 2).x, 1);
  EXPECT_LT(inCell(15, 0x1.fffffep-1f, 16), 1);
  EXPECT_LT(inCell(0, 0x1.fffffep-1f, 1), 1);
}

// A new order for each block, else pixels would repeat a pattern.
TEST(Stratified, BlocksDiffer) {
  const Sampler sampler(SamplerType::kStratified, 3, 16);
  const auto order = [&](uint32_t block) {
    std::vector<uint32_t> cells;
    for (uint32_t j = 0; j < 16; ++j) cells.push_back(cellOf(sampler.get1D(11, 4, block * 16 + j), 16));
    return cells;
  };
  EXPECT_NE(order(0), order(1));
}

class EachSampler : public testing::TestWithParam<SamplerType> {};
INSTANTIATE_TEST_SUITE_P(Sampler, EachSampler, testing::ValuesIn(kTypes));

TEST_P(EachSampler, IsUniformAndUncorrelated) {
  const Sampler sampler(GetParam(), 42, 16);
  constexpr int kPoints = 1 << 20;
  // mean, variance and correlations: x with y, with the next point, the next dimension, the next pixel. Across pixels
  // every family is independent; within a pixel, stratified and Sobol' points repel, so only pixels are averaged over.
  double mean[2] = {}, square[2] = {}, products[4] = {};
  for (uint32_t i = 0; i < kPoints; ++i) {
    const uint32_t px = i & 1023, py = i >> 10, key = sampler.pixelKey(px, py), index = mix(i) & 63;
    const Vec2f p = sampler.get2D(key, 3, index);
    ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
    const double x = double(p.x) - 0.5, y = double(p.y) - 0.5;
    mean[0] += x, mean[1] += y, square[0] += x * x, square[1] += y * y;
    products[0] += x * y;
    products[1] += x * (double(sampler.get1D(key, 7, index)) - 0.5);
    products[2] += x * (double(sampler.get2D(key, 4, index).x) - 0.5);
    products[3] += x * (double(sampler.get2D(sampler.pixelKey(px + 1, py), 3, index).x) - 0.5);
  }
  const double root = std::sqrt(double(kPoints));
  for (int i = 0; i < 2; ++i) {
    EXPECT_LT(std::abs(mean[i] / kPoints) * root, 5 * std::sqrt(1.0 / 12));
    EXPECT_LT(std::abs(square[i] / kPoints - 1.0 / 12) * root, 5 * std::sqrt(1.0 / 180));
  }
  for (double c : products) EXPECT_LT(std::abs(c / kPoints) * root, 5.0 / 12);
}

TEST_P(EachSampler, IsUniformWithinOnePixel) {
  const Sampler sampler(GetParam(), 42, 256);
  std::vector<int> cells(64, 0);
  for (uint32_t i = 0; i < 1 << 16; ++i) {
    const Vec2f p = sampler.get2D(99, 0, i);
    ++cells[cellOf(p.x, 8) * 8 + cellOf(p.y, 8)];
  }
  double statistic = 0;
  for (int c : cells) statistic += (c - 1024.0) * (c - 1024.0) / 1024;
  EXPECT_LT(statistic, 63 + 5 * std::sqrt(2 * 63.0));
}

TEST_P(EachSampler, DependsOnEveryKeyAndOnNothingElse) {
  const SamplerType type = GetParam();
  const uint64_t seed = 0x123456789abcdefull;
  const auto at = [&](uint64_t s, uint32_t x, uint32_t y, uint32_t dimension, uint32_t index) {
    const Sampler sampler(type, s, 16);
    const Vec2f p = sampler.get2D(sampler.pixelKey(x, y), dimension, index);
    return std::pair(p.x, p.y);
  };
  const auto base = at(seed, 10, 20, 3, 5);
  EXPECT_EQ(base, at(seed, 10, 20, 3, 5));
  for (int bit = 0; bit < 64; ++bit) EXPECT_NE(base, at(seed ^ (1ull << bit), 10, 20, 3, 5)) << bit;
  EXPECT_NE(base, at(seed, 11, 20, 3, 5));
  EXPECT_NE(base, at(seed, 10, 21, 3, 5));
  EXPECT_NE(base, at(seed, 20, 10, 3, 5));
  EXPECT_NE(base, at(seed, 10, 20, 4, 5));
  EXPECT_NE(base, at(seed, 10, 20, 3, 6));
  const Sampler sampler(type, seed, 16);
  const uint32_t key = sampler.pixelKey(1, 2);
  EXPECT_NE(sampler.get1D(key, 1, 0), sampler.get1D(key, 2, 0));
  EXPECT_NE(sampler.get1D(key, 1, 0), sampler.get1D(key, 1, 1));
}

// Neighbouring seeds must not shift or mirror one another's points.
TEST_P(EachSampler, SeedsAreUncorrelated) {
  const Sampler a(GetParam(), 1, 16), b(GetParam(), 2, 16), c(GetParam(), 1ull << 32 | 1, 16);
  double ab = 0, ac = 0;
  constexpr int kPixels = 1 << 16;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const auto x = [&](const Sampler& s) { return double(s.get2D(s.pixelKey(i & 255, i >> 8), 0, 0).x) - 0.5; };
    ab += x(a) * x(b), ac += x(a) * x(c);
  }
  EXPECT_LT(std::abs(ab) / std::sqrt(double(kPixels)), 5.0 / 12);
  EXPECT_LT(std::abs(ac) / std::sqrt(double(kPixels)), 5.0 / 12);
}

TEST(Permute, IsAPermutation) {
  test::Random random(5);
  for (uint32_t n : {1u, 2u, 3u, 4u, 5u, 7u, 16u, 17u, 100u, 255u, 256u, 257u, 1000u})
    for (int k = 0; k < 40; ++k) {
      // keys of every kind, also those where i + key passes 2^32
      const uint32_t key =
          k < 8 ? 0u - static_cast<uint32_t>(k) * (n / 4 + 1) : static_cast<uint32_t>(random.uniform() * 0x1p32);
      std::vector<uint32_t> image;
      for (uint32_t i = 0; i < n; ++i) image.push_back(Sampler::permute(i, n, key));
      std::sort(image.begin(), image.end());
      std::vector<uint32_t> all(n);
      std::iota(all.begin(), all.end(), 0u);
      ASSERT_EQ(image, all) << "n " << n << " key " << key;
    }
}

TEST(Permute, EveryImageIsEquallyLikely) {
  constexpr uint32_t kN = 10, kKeys = 100000;
  int counts[kN][kN] = {};
  for (uint32_t key = 0; key < kKeys; ++key)
    for (uint32_t i = 0; i < kN; ++i) ++counts[i][Sampler::permute(i, kN, mix(key))];
  for (auto& row : counts)
    for (int c : row) EXPECT_NEAR(c, kKeys / kN, 6 * std::sqrt(kKeys / kN));
}

TEST(Bits, ReverseAndUnit) {
  EXPECT_EQ(reverseBits(1u), 0x80000000u);
  EXPECT_EQ(reverseBits(0x12345678u), 0x1e6a2c48u);
  EXPECT_EQ(toUnit(0), 0);
  EXPECT_EQ(toUnit(0xffffffffu), 0x1.fffffep-1f);
  EXPECT_EQ(toUnit(0x80000000u), 0.5f);
}

}  // namespace
}  // namespace wardmis
