// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

using Numbers = std::vector<std::array<double, 2>>;

// Floats, and their squares, of many magnitudes, with a zero, negative ones and some on the bounds between cuts.
Numbers numbers(Random& random, size_t count) {
  Numbers list{{0, 0}};
  while (list.size() < count) {
    const auto x = static_cast<float>(random.logUniform(1e-12, 1e12) * (random.uniform() < 0.3 ? -1 : 1));
    list.push_back({double(x), double(x) * double(x)});
    if (random.uniform() < 0.2) list.back() = {std::ldexp(1.0, 27), -std::ldexp(1.0, -29)};
  }
  return list;
}

ExactSum<2> sumOf(const Numbers& list, size_t from, size_t to) {
  ExactSum<2> sum;
  for (size_t i = from; i < to; ++i) sum.add(list[i]);
  return sum;
}

TEST(ExactSum, OrderAndPartsDoNotMatter) {
  Random random(1);
  std::mt19937_64 shuffler(1);
  for (int k = 0; k < 300; ++k) {
    Numbers list = numbers(random, 60);
    const ExactSum<2> whole = sumOf(list, 0, list.size());
    for (int turn = 0; turn < 5; ++turn) {
      std::shuffle(list.begin(), list.end(), shuffler);
      EXPECT_EQ(sumOf(list, 0, list.size()), whole);
      const auto a = static_cast<size_t>(random.uniform() * 30), b = 30 + static_cast<size_t>(random.uniform() * 30);
      ExactSum<2> parts = sumOf(list, a, b);
      parts += sumOf(list, 0, a);
      parts += sumOf(list, b, list.size());
      EXPECT_EQ(parts, whole);
    }
  }
}

TEST(ExactSum, IsAsExactAsAFloatNeeds) {
  Random random(2);
  for (int k = 0; k < 300; ++k) {
    const Numbers list = numbers(random, 1000);
    const ExactSum<2> sum = sumOf(list, 0, list.size());
    for (size_t c = 0; c < 2; ++c) {
      long double exact = 0, magnitude = 0;
      for (const auto& x : list) exact += x[c], magnitude += std::abs(x[c]);
      EXPECT_NEAR(sum[c], double(exact), 1e-9 * double(magnitude));
    }
  }
}

// Numbers of one magnitude lose nothing, of none are zero, and the other channel's do not matter.
TEST(ExactSum, SmallNumbersAreKept) {
  ExactSum<2> sum;
  EXPECT_EQ(sum[0], 0);
  for (int i = 0; i < 1000; ++i) sum.add({0x1.234568p-100, 0x1p200});
  EXPECT_EQ(sum[0], 1000 * 0x1.234568p-100);
  EXPECT_EQ(sum[1], 1000 * 0x1p200);
}

TEST(UnitSum, OrderDoesNotMatter) {
  Random random(3);
  std::mt19937_64 shuffler(3);
  std::vector<double> list(1000);
  for (double& x : list) x = 2 * random.uniform() - 1;
  UnitSum<1> whole, shuffled;
  for (double x : list) whole.add({x});
  std::shuffle(list.begin(), list.end(), shuffler);
  for (double x : list) shuffled.add({x});
  EXPECT_EQ(shuffled, whole);
  long double exact = 0;
  for (double x : list) exact += x;
  EXPECT_NEAR(whole[0], double(exact), 1e-4);
}

}  // namespace
}  // namespace wardmis
