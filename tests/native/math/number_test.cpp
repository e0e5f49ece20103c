// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/number.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace wardmis {
namespace {

using Limits = std::numeric_limits<float>;
constexpr float kInf = Limits::infinity();

// Distance in units of the last place that a float of the exact value has; denormals have the least one.
double ulps(float got, double exact) {
  const double last = exact == 0 ? 0x1p-149 : std::max(0x1p-149, std::ldexp(1.0, std::ilogb(exact) - 23));
  return std::abs(double(got) - exact) / last;
}

// The largest error over every `stride`-th float of [lo, hi], both of one sign.
template <class F>
double worst(float lo, float hi, uint32_t stride, F&& error) {
  uint32_t a = std::bit_cast<uint32_t>(lo), b = std::bit_cast<uint32_t>(hi);
  if (a > b) std::swap(a, b);
  double w = 0;
  for (uint32_t i = a; i <= b; i += stride) w = std::max(w, error(std::bit_cast<float>(i)));
  return w;
}

TEST(Exp, FloatWithinTwoUlp) {
  const auto error = [](float x) { return ulps(exp(x), std::exp(double(x))); };
  EXPECT_LT(worst(0.0f, 88.7228317f, 1013, error), 2);
  EXPECT_LT(worst(-0.0f, -87.3365402f, 1013, error), 2);
}
// A denormal result costs many times what a normal one does.
TEST(Exp, FloatIsZeroInPlaceOfADenormal) {
  const auto error = [](float x) {
    const float got = exp(x);
    return got == 0 ? std::exp(double(x)) / Limits::min() : got < Limits::min() ? 2 : 0;
  };
  EXPECT_LT(worst(-87.0f, -89.0f, 1, error), 1 + 1e-5);
  EXPECT_GT(exp(-87.33654f), 0);
  EXPECT_EQ(exp(-87.34f), 0);
  EXPECT_EQ(exp(-1e30f), 0);
  EXPECT_EQ(exp(-kInf), 0);
}
TEST(Exp, FloatEnds) {
  EXPECT_EQ(exp(0.0f), 1);
  EXPECT_EQ(exp(-0.0f), 1);
  EXPECT_EQ(exp(Limits::denorm_min()), 1);
  EXPECT_GT(exp(88.7228317f), 3.4e38f);
  EXPECT_TRUE(std::isfinite(exp(88.7228317f)));
  EXPECT_GT(exp(1e30f), 3.4e38f);
  EXPECT_GT(exp(kInf), 3.4e38f);
}

TEST(Log, FloatWithinTwoUlp) {
  const auto error = [](float x) { return ulps(log(x), std::log(double(x))); };
  EXPECT_LT(worst(Limits::min(), Limits::max(), 2011, error), 2);
  EXPECT_LT(worst(0.5f, 2.0f, 11, error), 2);       // where the result cancels
  EXPECT_LT(worst(0.9999f, 1.0001f, 1, error), 2);  // every float around 1
}
TEST(Log, FloatEnds) {
  EXPECT_EQ(log(1.0f), 0);
  EXPECT_LT(ulps(log(Limits::min()), std::log(double(Limits::min()))), 2);
  EXPECT_LT(ulps(log(Limits::max()), std::log(double(Limits::max()))), 2);
}

// Over the numbers that the samplers give, k 2^-24: 1 - u is exact, so that log's bound holds.
TEST(MinusLog1m, FloatWithinTwoUlpOfEveryNumberOfASampler) {
  double w = 0;
  for (uint32_t k = 0; k < 1u << 24; k += 7) {
    const float u = static_cast<float>(k) * 0x1p-24f;
    w = std::max(w, ulps(minusLog1m(u), -std::log1p(-double(u))));
  }
  EXPECT_LT(w, 2);
  EXPECT_EQ(minusLog1m(0.0f), 0);
  EXPECT_NEAR(minusLog1m(0x1.fffffep-1f), 24 * std::log(2.0), 4e-6);
}
TEST(MinusLog1m, DoubleKeepsSmallNumbers) {
  EXPECT_EQ(minusLog1m(0.0), 0);
  EXPECT_DOUBLE_EQ(minusLog1m(1e-300), 1e-300);
  EXPECT_DOUBLE_EQ(minusLog1m(1e-12), 1e-12 + 0.5e-24);
}

TEST(SinCos, FloatWithin2em7) {
  double w = 0, norm = 0;
  for (uint32_t k = 0; k <= 1u << 24; k += 5) {
    const float u = static_cast<float>(k) * 0x1p-24f;
    float s, c;
    sincos2Pi(u, s, c);
    const double angle = 2 * kPi<double> * double(u);
    w = std::max({w, std::abs(double(s) - std::sin(angle)), std::abs(double(c) - std::cos(angle))});
    norm = std::max(norm, std::abs(double(s) * s + double(c) * c - 1));
  }
  EXPECT_LT(w, 2e-7);
  EXPECT_LT(norm, 4e-7);
}
TEST(SinCos, FloatIsExactAtTheQuadrants) {
  const float expected[5][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}, {0, 1}};
  for (int q = 0; q <= 4; ++q) {
    float s, c;
    sincos2Pi(0.25f * static_cast<float>(q), s, c);
    EXPECT_EQ(s, expected[q][0]) << q;
    EXPECT_EQ(c, expected[q][1]) << q;
  }
}
TEST(SinCos, FloatKeepsTinyAngles) {
  float s, c;
  sincos2Pi(1e-30f, s, c);
  EXPECT_NEAR(s / 1e-30f, 2 * kPi<double>, 1e-6);
  EXPECT_EQ(c, 1);
}

TEST(Atan2, FloatWithin3em7Relative) {
  double w = 0;
  for (int k = 0; k <= 1 << 20; ++k) {
    const double angle = 2 * kPi<double> * k / (1 << 20) - kPi<double>;
    for (const double r : {1.0, 1e-18, 1e18}) {
      const float x = static_cast<float>(r * std::cos(angle)), y = static_cast<float>(r * std::sin(angle));
      const double exact = std::atan2(double(y), double(x));
      w = std::max(w, std::abs(double(atan2(y, x)) - exact) / std::max(std::abs(exact), 1e-30));
    }
  }
  EXPECT_LT(w, 3e-7);
}
TEST(Atan2, FloatOnTheAxes) {
  EXPECT_EQ(atan2(0.0f, 1.0f), 0);
  EXPECT_EQ(atan2(1.0f, 0.0f), 0.5f * kPi<float>);
  EXPECT_EQ(atan2(-1.0f, 0.0f), -0.5f * kPi<float>);
  EXPECT_EQ(atan2(0.0f, -1.0f), kPi<float>);
  EXPECT_EQ(atan2(-0.0f, -1.0f), -kPi<float>);
  EXPECT_EQ(atan2(0.0f, 0.0f), 0);
  EXPECT_EQ(atan2(1e-38f, 1.0f), 1e-38f);
}

}  // namespace
}  // namespace wardmis
