// SPDX-License-Identifier: GPL-3.0-or-later
// The filters' quantile tables against the densities that filter.h states.
#include "film/filter.h"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <functional>

#include "math/number.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

struct Shape {
  FilterType type;
  float width;
  double radius;
  std::function<double(double)> density;  // not normalised
};

Shape gaussian(float width) {
  const double w = double(width);
  return {FilterType::kGaussian, width, 1.5 * w, [w](double v) { return std::exp(-8 * v * v / (w * w)); }};
}
// Harris 1978, the 92 dB window of four terms, from -1 to 1 times the width.
Shape blackmanHarris(float width) {
  const double w = double(width);
  return {FilterType::kBlackmanHarris, width, w, [w](double v) {
            const double t = kPi<double> * v / w;
            return 0.35875 + 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) + 0.01168 * std::cos(3 * t);
          }};
}
double integral(const std::function<double(double)>& f, double a, double b, int panels = 1) {
  double sum = 0;
  for (int i = 0; i < panels; ++i)
    sum += boost::math::quadrature::gauss<double, 20>::integrate(f, a + (b - a) * i / panels,
                                                                 a + (b - a) * (i + 1) / panels);
  return sum;
}

TEST(Filter, BoxIsOnePixel) {
  for (float width : {0.5f, 1.0f, 3.0f}) {
    const PixelFilter filter(FilterType::kBox, width);
    EXPECT_EQ(filter.sample({0, 0.5f}).x, -0.5f);
    EXPECT_EQ(filter.sample({0, 0.5f}).y, 0);
    EXPECT_EQ(filter.sample({0.75f, 0}).x, 0.25f);
    const float last = filter.sample({0x1.fffffep-1f, 0}).x;
    EXPECT_LE(last, 0.5f);
    EXPECT_GT(last, 0.4999f);
  }
}

// The cumulated density at each offset is u: a Kolmogorov-Smirnov distance without any sampling noise. Between the
// table's quantiles the density is taken as constant, which shows in the thin tails only.
TEST(Filter, QuantilesFollowTheDensity) {
  for (const Shape& s : {gaussian(1.5f), gaussian(0.01f), gaussian(10), blackmanHarris(1.5f), blackmanHarris(0.5f),
                         blackmanHarris(10)}) {
    const PixelFilter filter(s.type, s.width);
    const double total = integral(s.density, -s.radius, s.radius, 16);
    double cumulated = 0, at = -s.radius, before = -s.radius;
    for (int k = 0; k < 2048; ++k) {
      const float u = (static_cast<float>(k) + 0.5f) / 2048;
      const double v = double(filter.sample({u, 0}).x);
      ASSERT_GE(v, before);  // monotone
      ASSERT_LE(std::abs(v), s.radius * (1 + 1e-6));
      ASSERT_EQ(filter.sample({0, u}).y, filter.sample({u, 0}).x);
      cumulated += integral(s.density, at, v) / total;
      ASSERT_NEAR(cumulated, double(u), 2e-5) << "width " << s.width << " offset " << v;
      at = before = v;
    }
  }
}

TEST(Filter, DensityIsThatOfItsSamples) {
  for (const Shape& s : {gaussian(1.5f), gaussian(0.1f), blackmanHarris(1.5f), blackmanHarris(3)}) {
    const PixelFilter filter(s.type, s.width);
    const double total = integral(s.density, -s.radius, s.radius, 16);
    for (const double at : {-0.9, -0.4, 0.0, 0.1, 0.7}) {
      const double x = at * s.radius, y = 0.3 * s.radius;
      const double exact = s.density(x) / total * s.density(y) / total;
      EXPECT_NEAR(double(filter.density({static_cast<float>(x), static_cast<float>(y)})), exact, 1e-4 * exact);
    }
    EXPECT_EQ(filter.density({filter.radius() * 1.001f, 0}), 0);
  }
  const PixelFilter box(FilterType::kBox, 3);
  EXPECT_EQ(box.density({0.49f, -0.49f}), 1);
  EXPECT_EQ(box.density({0.51f, 0}), 0);
}

TEST(Filter, MeanIsZeroAndVarianceIsTheDensitys) {
  for (const Shape& s : {gaussian(1.5f), gaussian(3), blackmanHarris(1.5f), blackmanHarris(4)}) {
    const PixelFilter filter(s.type, s.width);
    double mean = 0, square = 0;
    constexpr int kPoints = 1 << 18;
    for (int k = 0; k < kPoints; ++k) {
      const double v = double(filter.sample({(static_cast<float>(k) + 0.5f) / kPoints, 0}).x);
      mean += v / kPoints, square += v * v / kPoints;
    }
    const double total = integral(s.density, -s.radius, s.radius, 16);
    const double exact = integral([&](double v) { return v * v * s.density(v); }, -s.radius, s.radius, 16) / total;
    EXPECT_NEAR(mean, 0, 1e-5 * s.radius);
    EXPECT_NEAR(square, exact, 2e-3 * exact) << "width " << s.width;
  }
}

TEST(Filter, EndsAreFinite) {
  for (FilterType type : {FilterType::kBox, FilterType::kGaussian, FilterType::kBlackmanHarris})
    for (float width : {1e-3f, 1.5f, 100.0f}) {
      const PixelFilter filter(type, width);
      for (float u : {0.0f, 0x1p-24f, 0x1.fffffep-1f})
        EXPECT_LE(std::abs(filter.sample({u, u}).x), std::max(0.5f, 1.5f * width * 1.0001f));
    }
}

}  // namespace
}  // namespace wardmis
