// SPDX-License-Identifier: GPL-3.0-or-later
// Weights and variances at the ends of the number range.
#include "mis/strategy.h"

#include <gtest/gtest.h>

#include <cmath>

namespace wardmis {
namespace {

constexpr Weights kRules[] = {Weights::kBalance, Weights::kNonbalance, Weights::kPower,
                              Weights::kCutoff,  Weights::kMaximum,    Weights::kVarianceAware};

// f = 2 p_0 down to the smallest denormal, where 1/p_0 is infinite: w f/p is a number, and the weights add up.
TEST(WeightedValue, IsFiniteWhereDensitiesAreDenormal) {
  for (Weights rule : kRules)
    for (double p : {4.94065645841246544e-324, 1e-320, 1e-309, 1e-300, 1.0})
      for (double other : {0.0, 1e-320, 1e-20, 1.0})
        for (double share : {1.0, 0.5, 1e-16}) {
          SCOPED_TRACE(testing::Message() << int(rule) << " p " << p << " other " << other << " share " << share);
          const Densities a{share, 1 - share}, densities{p, other}, v{1, 2};
          const double f = 2 * p;
          double sum = 0;
          for (int i = 0; i < 2; ++i) {
            const double value = weightedValue(rule, i, 2, f, densities, a, v);
            ASSERT_TRUE(std::isfinite(value)) << i;
            ASSERT_GE(value, 0) << i;
            sum += value * densities[static_cast<size_t>(i)];
          }
          if (p * share >= 1e-300) {  // denormal products have few digits
            EXPECT_NEAR(sum, f, 1e-12 * f);
          }
        }
}

// A value that is not a number must not pass as one of no variance.
TEST(LogVariance, KeepsNotANumber) {
  Points points;
  points.techniques = 2;
  for (double f : {1.0, 2.0, std::nan("")}) {
    Point x;
    x.f = f, x.w = 0.3, x.p = {1, 2}, x.logP = {0, std::log(2.0)};
    points.list.push_back(x);
  }
  const IntegrandMoments m = momentsOf(points);
  EXPECT_TRUE(std::isnan(logVariance(Weights::kBalance, {0.5, 0.5}, points, m)));
  EXPECT_TRUE(std::isnan(logVariance(Weights::kNonbalance, {0.5, 0.5}, points, m)));
}

}  // namespace
}  // namespace wardmis
