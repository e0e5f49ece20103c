// SPDX-License-Identifier: GPL-3.0-or-later
// Each map against its stated density. False alarms: 1e-4 a test for other seeds; these seeds are fixed.
#include "math/warp.h"

#include <gtest/gtest.h>

#include "statistics.h"

namespace wardmis {
namespace {

using test::Random;

constexpr int kCount = 200000;
constexpr double kAlarm = 1e-4, kPid = kPi<double>;

template <class T>
class Warp : public testing::Test {};
using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(Warp, Numbers);

TYPED_TEST(Warp, Disk) {
  Random random(1);
  const auto polar = [&]() -> std::optional<Vec2<double>> {
    const Vec2<TypeParam> p = toDisk(random.square<TypeParam>());
    return Vec2<double>{std::hypot(double(p.x), double(p.y)), std::atan2(double(p.y), double(p.x))};
  };
  const test::Fit fit = test::chiSquare(
      polar, [](double r, double) { return r / kPid; }, kCount, test::evenEdges(0, 1 + 1e-6, 16),
      test::evenEdges(-kPid, kPid, 16));
  EXPECT_GT(fit.p, kAlarm);
  EXPECT_NEAR(fit.mass, 1, 1e-5);
}

TYPED_TEST(Warp, CosineHemisphere) {
  Random random(2);
  const auto sample = [&] {
    const Vec3<TypeParam> d = toCosineHemisphere(random.square<TypeParam>());
    return Vec3<double>{double(d.x), double(d.y), double(d.z)};
  };
  const test::Fit fit = test::chiSquareHemisphere(
      sample, [](Vec3<double> d) { return d.z / kPid; }, kCount, 16);
  EXPECT_GT(fit.p, kAlarm);
  EXPECT_NEAR(fit.mass, 1, 1e-6);
}

// From a pencil of light to the whole sphere.
TYPED_TEST(Warp, Cone) {
  for (double size : {1e-8, 1e-3, 0.5, 1.0, 2.0}) {
    Random random(3);
    const auto polar = [&]() -> std::optional<Vec2<double>> {
      const Vec3<TypeParam> d = toCone(random.square<TypeParam>(), TypeParam(size));
      const double s2 = square(double(d.x)) + square(double(d.y));
      // 1 - cos from sin where that is the exact one
      const double h = d.z > 0 ? s2 / (1 + std::sqrt(std::max(0.0, 1 - s2))) : 1 - double(d.z);
      return Vec2<double>{h / size, std::atan2(double(d.y), double(d.x))};
    };
    const test::Fit fit = test::chiSquare(
        polar, [](double, double) { return 1 / (2 * kPid); }, kCount, test::evenEdges(0, 1 + 1e-5, 16),
        test::evenEdges(-kPid, kPid, 16));
    EXPECT_GT(fit.p, kAlarm) << size;
  }
}

TYPED_TEST(Warp, Triangle) {
  Random random(4);
  // chart: b1 + b2, and b2's part of it
  const auto chart = [&]() -> std::optional<Vec2<double>> {
    const Vec2<TypeParam> b = toTriangle(random.square<TypeParam>());
    EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= TypeParam(1));
    const double s = double(b.x) + double(b.y);
    return Vec2<double>{s, double(b.y) / s};
  };
  const test::Fit fit = test::chiSquare(
      chart, [](double s, double) { return 2 * s; }, kCount, test::evenEdges(0, 1, 16), test::evenEdges(0, 1, 16));
  EXPECT_GT(fit.p, kAlarm);
}

TYPED_TEST(Warp, DirectionsAreUnit) {
  Random random(5);
  for (int i = 0; i < 10000; ++i) {
    const Vec2<TypeParam> u = random.square<TypeParam>();
    EXPECT_NEAR(double(length(toCosineHemisphere(u))), 1, 4e-7);
    EXPECT_NEAR(double(length(toCone(u, TypeParam(random.uniform(0, 2))))), 1, 4e-7);
    EXPECT_GE(toCosineHemisphere(u).z, 0);
  }
}

// The test can tell: an exponent that is 6 % off is rejected.
TEST(ChiSquare, RejectsAWrongDensity) {
  Random random(6);
  const auto sample = [&] { return toCosineHemisphere(random.square()); };
  const auto wrong = [](Vec3<double> d) { return std::pow(d.z, 1.06) * 2.06 / (2 * kPid); };
  EXPECT_LT(test::chiSquareHemisphere(sample, wrong, kCount, 16).p, 1e-6);
}

}  // namespace
}  // namespace wardmis
