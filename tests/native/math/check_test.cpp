// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/check.h"

#include <gtest/gtest.h>

#include <limits>

namespace wardmis {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

// Each value in each component.
void expectCounts(float value, uint64_t nan, uint64_t infinite, uint64_t negative) {
  for (int i = 0; i < 3; ++i) {
    Rgb v{0.25f, 0.5f, 1};
    (i == 0 ? v.x : i == 1 ? v.y : v.z) = value;
    RareCounts counts;
    EXPECT_EQ(counts.admit(v), nan + infinite + negative == 0) << value << " in component " << i;
    EXPECT_EQ(counts.nan, nan) << value << " in component " << i;
    EXPECT_EQ(counts.infinite, infinite) << value << " in component " << i;
    EXPECT_EQ(counts.negative, negative) << value << " in component " << i;
  }
}

TEST(RareCounts, AdmitsWhatIsFiniteAndNotNegative) {
  for (float v : {0.0f, -0.0f, 1e-45f, 1.0f, 1e38f, 3e38f}) expectCounts(v, 0, 0, 0);
}
TEST(RareCounts, CountsEachKind) {
  expectCounts(kNan, 1, 0, 0);
  expectCounts(-kNan, 1, 0, 0);
  expectCounts(kInf, 0, 1, 0);
  expectCounts(-kInf, 0, 1, 0);
  expectCounts(-1e-45f, 0, 0, 1);
  expectCounts(-1.0f, 0, 0, 1);
  expectCounts(-3e38f, 0, 0, 1);
}
TEST(RareCounts, CountsMixturesOnce) {
  RareCounts counts;
  EXPECT_FALSE(counts.admit({kNan, kInf, -1}));
  EXPECT_EQ(counts.nan, 1u);
  EXPECT_FALSE(counts.admit({kInf, 1, -1}));
  EXPECT_EQ(counts.infinite, 1u);
  EXPECT_EQ(counts.total(), 2u);
  RareCounts sum;
  sum += counts;
  sum += counts;
  EXPECT_EQ(sum.total(), 4u);
}
// Finite values whose sum is no float: no radiance that a scene can have. Dropped, and counted as infinite.
TEST(RareCounts, LargeValuesWhoseSumOverflows) {
  RareCounts counts;
  EXPECT_FALSE(counts.admit({2e38f, 2e38f, 2e38f}));
  EXPECT_EQ(counts.infinite, 1u);
  EXPECT_TRUE(counts.admit({1e38f, 1e38f, 1e38f}));
  EXPECT_EQ(counts.total(), 1u);
}

}  // namespace
}  // namespace wardmis
