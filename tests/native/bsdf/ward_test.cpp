// SPDX-License-Identifier: GPL-3.0-or-later
// The BRDF, its density and its weights at single points: against 60-digit values, and at the ends of the number range.
#include "bsdf/ward.h"

#include <gtest/gtest.h>

#include <limits>

#include "golden.h"
#include "reference.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

template <class T>
constexpr double kEps = std::max(0x1p-52, double(std::numeric_limits<T>::epsilon()));  // the file holds doubles

// Values below the range of T: what e^-E loses there, times what stands before e^-E. float has no denormals of it.
template <class T>
double underflow(double value, double e) {
  const double lost = sizeof(T) == 4 ? double(std::numeric_limits<float>::min()) : 4 * 0x1p-1074;
  return lost * std::max(1.0, std::exp(std::log(value) + e));
}

template <class T>
void checkGoldenPoints(double toleranceFactor, bool onlyFloatInputs) {
  const double kUnderflow = sizeof(T) == 4 ? 88 : 760;  // e^-E is 0 beyond
  int checked = 0;
  for (const auto& point : golden()["brdf_points"]) {
    if (onlyFloatInputs && !point["float32_representable"].get<bool>()) continue;
    SCOPED_TRACE(point.dump());
    const auto& expect = point["expect"];
    const Vec3<T> wi = vec3<T>(point["wi"]), wo = vec3<T>(point["wo"]);
    const T ax = point["alpha_x"].get<T>(), ay = point["alpha_y"].get<T>();
    const bool above = wi.z > 0 && wo.z > 0;
    const double tolerance = above ? expect["suggested_reltol_double"].get<double>() * toleranceFactor : 0;
    const double e = above ? expect["E"].get<double>() : 0;
    const auto near = [&](double got, const char* key) {
      double exact = expect[key].get<double>();
      if (above && exact == 0)
        exact = std::exp(expect[std::string("ln_") + key].get<double>());  // the file has no denormals
      if (e > kUnderflow)
        EXPECT_EQ(got, 0) << key;
      else
        EXPECT_NEAR(got, exact, tolerance * exact + (above ? underflow<T>(exact, e) : 0)) << key;
    };
    for (const Variant& v : kVariants) {
      const WardValue<T> value = ward(v.type, wi, wo, ax, ay);
      const double f = above ? double(value.fCos) / double(wi.z) : double(value.fCos);
      near(f, v.point);
      near(double(value.pdf), "pdf");
      if (above) {
        const double weight = expect[v.weight].get<double>();
        EXPECT_NEAR(double(wardWeight(v.type, wi, wo)), weight, 8 * kEps<T> * weight) << v.weight;
        const double log = expect["ln_pdf"].get<double>();
        EXPECT_NEAR(double(wardLogPdf(wi, wo, 1 / ax, 1 / ay)), log, tolerance * std::max(1.0, std::abs(log)));
      } else {
        EXPECT_EQ(wardWeight(v.type, wi, wo), 0);
        EXPECT_EQ(wardLogPdf(wi, wo, T(1), T(1)), -std::numeric_limits<T>::infinity());
      }
    }
    ++checked;
  }
  EXPECT_GE(checked, 40);
}

TEST(Ward, GoldenPointsInDouble) { checkGoldenPoints<double>(1, false); }
TEST(Ward, GoldenPointsInFloat) { checkGoldenPoints<float>(5.4e8, true); }
TEST(Ward, GoldenPointsInLongDouble) { checkGoldenPoints<long double>(1, false); }

// The file takes e^-E = u1, the renderer 1 - u1.
TEST(Ward, GoldenSampling) {
  int below = 0;
  for (const auto& c : golden()["walter_sampling"]) {
    SCOPED_TRACE(c.dump());
    const auto& expect = c["expect"];
    const double u1 = c["u1"].get<double>(), ax = c["alpha_x"].get<double>(), ay = c["alpha_y"].get<double>();
    const Vec3<double> wo = vec3<double>(c["wo"]), exact = vec3<double>(expect["wi"]);
    const Vec3<double> wi = wardSample(wo, ax, ay, {1 - u1, c["u2"].get<double>()});
    const double e = -std::log(u1);
    // 1 - u1 is rounded to 2^-54: what that changes in the slopes' length, and some roundings of the direction
    const double step = kEps<double> * (8 + 1 / (u1 * std::max(e, 1e-9)));
    EXPECT_NEAR(wi.x, exact.x, step);
    EXPECT_NEAR(wi.y, exact.y, step);
    EXPECT_NEAR(wi.z, exact.z, step);
    EXPECT_EQ(wi.z <= 0, expect["below"].get<bool>());
    if (wi.z <= 0) {
      ++below;
      for (const Variant& v : kVariants) {
        EXPECT_EQ(ward(v.type, wi, wo, ax, ay).pdf, 0);
        EXPECT_EQ(wardWeight(v.type, wi, wo), 0);
        EXPECT_EQ(wardLogPdf(wi, wo, 1.0, 1.0), -std::numeric_limits<double>::infinity());
      }
      continue;
    }
    // a step of the direction in units of the lobe's width
    const double hz = wi.z + wo.z, slopes = std::hypot(1.0, std::hypot(wi.x + wo.x, wi.y + wo.y) / hz);
    const double relative = 1e-13 + step * (6 / hz + 1 / wi.z + 4 * std::sqrt(e) * slopes / (hz * std::min(ax, ay)));
    for (const Variant& v : kVariants) {
      const WardValue<double> value = ward(v.type, wi, wo, ax, ay);
      const double pdf = expect["pdf"].get<double>(), weight = expect[v.weight].get<double>();
      EXPECT_NEAR(value.pdf, pdf, relative * pdf);
      EXPECT_NEAR(wardWeight(v.type, wi, wo), weight, relative * weight);
      EXPECT_NEAR(value.fCos / value.pdf, weight, relative * weight);
    }
  }
  EXPECT_GT(below, 0);
}

template <class T>
class Numbers : public testing::Test {};
using FloatAndDouble = testing::Types<float, double>;
TYPED_TEST_SUITE(Numbers, FloatAndDouble);

// A direction at azimuth phi; z is kept as given, however small.
template <class T>
Vec3<T> direction(double z, double phi) {
  const double s = std::sqrt((1 - z) * (1 + z));
  return {static_cast<T>(s * std::cos(phi)), static_cast<T>(s * std::sin(phi)), static_cast<T>(z)};
}

// Cosines down to 1e-38, every alpha that a scene may have, backscatter, forward, across: right to rounding, so never
// NaN or negative, and infinite only where the true value is no T (alpha 1e-6 under cosines below 1e-27).
TYPED_TEST(Numbers, Extremes) {
  using T = TypeParam;
  const double cosines[] = {1e-38, 2e-38, 1e-33, 1e-27, 1e-20, 1e-12, 1e-8, 1e-4, 1e-2, 0.3, 1};
  const double alphas[][2] = {{1e-6, 1e-6}, {1e-5, 1e-4}, {2e-3, 2e-3}, {0.01, 0.3},
                              {0.1, 0.1},   {1, 1},       {10, 10},     {1e-6, 10}};
  const double azimuths[] = {0, 1e-9, 1e-3, 1, kPi<double> / 2, 3, kPi<double> - 1e-6, kPi<double>};
  for (double ci : cosines)
    for (double co : cosines)
      for (const auto& alpha : alphas)
        for (double azimuth : azimuths)
          for (double turn : {0.0, 0.7}) {
            const double ax = alpha[0], ay = alpha[1];
            const Vec3<T> wi = direction<T>(ci, azimuth + turn), wo = direction<T>(co, turn);
            for (const Variant& v : kVariants) {
              const WardValue<T> got = ward(v.type, wi, wo, T(ax), T(ay));
              const test::Reference exact = reference(v.type, wi, wo, T(ax), T(ay));
              const auto check = [&](T value, long double reference, const char* what) {
                const auto context = [&] {
                  return testing::Message()
                         << what << " of " << v.point << " cosines " << ci << " " << co << " alpha " << ax << " " << ay
                         << " azimuth " << azimuth << " E " << double(exact.e) << " reference " << double(reference);
                };
                ASSERT_GE(value, 0) << context();  // not NaN either
                if (reference > 0.9L * std::numeric_limits<T>::max()) return;
                ASSERT_TRUE(std::isfinite(value)) << context();
                if (exact.e > 1e6L) {
                  ASSERT_EQ(value, 0) << context();
                  return;
                }
                const double e = double(exact.e), r = double(reference);
                // beyond the sum of the roundings: where e^-E, or the result, is a denormal number
                const double smallest = double(std::numeric_limits<T>::min());
                const double slack = e > (sizeof(T) == 4 ? 87 : 708) || r < smallest
                                         ? 2 * smallest * std::max(1.0, std::exp(std::log(r) + e))
                                         : 0;
                ASSERT_NEAR(double(value), r, (12 + 8 * e) * kEps<T> * r + slack) << context();
              };
              check(got.fCos, exact.fCos, "f cos");
              check(got.pdf, exact.pdf, "pdf");
              if (const double log = double(exact.logPdf); exact.e < std::numeric_limits<T>::max()) {
                ASSERT_NEAR(double(wardLogPdf(wi, wo, 1 / T(ax), 1 / T(ay))), log,
                            16 * kEps<T> * std::max(30.0, std::abs(log) + double(exact.e)));
              }
              const double weight = double(wardWeight(v.type, wi, wo)), ratio = double(exact.weight);
              if (ratio < double(std::numeric_limits<T>::max())) {
                ASSERT_NEAR(weight, ratio, 16 * kEps<T> * ratio + 4 * double(std::numeric_limits<T>::min()));
              }
              if (v.type == WardVariant::kWardGmd) {
                ASSERT_LE(weight, 2);
              }
            }
          }
}

// Cosines below the normal numbers: no NaN, and the weight is right where it is a number.
TYPED_TEST(Numbers, DenormalCosines) {
  using T = TypeParam;
  using Limits = std::numeric_limits<T>;
  for (T ci : {Limits::denorm_min(), Limits::min() / 4, Limits::min(), T(0.5)})
    for (T co : {Limits::denorm_min(), Limits::min() / 4, T(1e-20), T(0.5)})
      for (T side : {T(-1), T(0), T(1)})  // forward (h.x = 0), across, backward
        for (double alpha : {1e-6, 0.1, 10.0}) {
          const Vec3<T> wi{side, side == T(0) ? T(1) : T(0), ci}, wo{1, 0, co};
          for (const Variant& v : kVariants) {
            SCOPED_TRACE(testing::Message()
                         << v.point << " cosines " << ci << " " << co << " side " << side << " alpha " << alpha);
            const WardValue<T> value = ward(v.type, wi, wo, T(alpha), T(alpha));
            EXPECT_GE(value.fCos, 0);  // not NaN either
            EXPECT_GE(value.pdf, 0);
            EXPECT_GE(wardWeight(v.type, wi, wo), 0);
            if (side != T(-1)) continue;
            const double exact = double(wardWeight<long double>(v.type, {wi.x, wi.y, wi.z}, {wo.x, wo.y, wo.z}));
            if (exact > double(Limits::min()) && exact < double(Limits::max())) {
              EXPECT_NEAR(double(wardWeight(v.type, wi, wo)), exact,
                          (ci > Limits::min() ? 8 : 1e-3 / kEps<T>)*kEps<T> * exact);
            }
          }
        }
}

TYPED_TEST(Numbers, NothingBelowTheHorizon) {
  using T = TypeParam;
  Random random(1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3<double> up = random.above(), other = random.above();
    const auto make = [](Vec3<double> d, double sign) { return Vec3<T>{T(d.x), T(d.y), T(d.z * sign)}; };
    const double z = i % 3 == 0 ? 0 : -1;  // the horizon itself is dark
    for (const Variant& v : kVariants) {
      for (auto [wi, wo] : {std::pair(make(up, z), make(other, 1)), std::pair(make(up, 1), make(other, z)),
                            std::pair(make(up, z), make(up, z))}) {
        const WardValue<T> value = ward(v.type, wi, wo, T(0.3), T(0.1));
        EXPECT_EQ(value.fCos, 0);
        EXPECT_EQ(value.pdf, 0);
        EXPECT_EQ(wardWeight(v.type, wi, wo), 0);
        EXPECT_EQ(wardLogPdf(wi, wo, T(1), T(1)), -std::numeric_limits<T>::infinity());
      }
    }
  }
}

TYPED_TEST(Numbers, IsReciprocal) {
  using T = TypeParam;
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const Vec3<double> a = random.above(), b = random.above();
    const Vec3<T> wi{T(a.x), T(a.y), T(a.z)}, wo{T(b.x), T(b.y), T(b.z)};
    const T ax = T(random.logUniform(0.05, 10)), ay = T(random.logUniform(0.05, 10));
    for (const Variant& v : kVariants) {
      const double there = double(ward(v.type, wi, wo, ax, ay).fCos) / double(wi.z);
      const double back = double(ward(v.type, wo, wi, ax, ay).fCos) / double(wo.z);
      EXPECT_NEAR(there, back, 8 * kEps<T> * there + 1e-36);
    }
  }
}

TYPED_TEST(Numbers, WeightIsTheRatio) {
  using T = TypeParam;
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    const Vec3<double> o = random.above();
    const Vec3<T> wo{T(o.x), T(o.y), T(o.z)};
    const T ax = T(random.logUniform(1e-3, 2)), ay = T(random.logUniform(1e-3, 2));
    const Vec3<T> wi = wardSample(wo, ax, ay, random.square<T>());
    for (const Variant& v : kVariants) {
      const WardValue<T> value = ward(v.type, wi, wo, ax, ay);
      const double weight = double(wardWeight(v.type, wi, wo));
      EXPECT_GE(weight, 0);
      if (v.type == WardVariant::kWardGmd) {
        EXPECT_LE(weight, 2);
      }
      if (double(value.pdf) > 1e-30) {
        EXPECT_NEAR(double(value.fCos) / double(value.pdf), weight, 16 * kEps<T> * weight);
      }
    }
  }
}

// Samples are unit vectors, mirrored about a half vector whose E is what the number says.
TYPED_TEST(Numbers, SamplesAreUnit) {
  using T = TypeParam;
  Random random(4);
  for (int i = 0; i < 20000; ++i) {
    const Vec3<double> o = random.above();
    const Vec3<T> wo = normalize(Vec3<T>{T(o.x), T(o.y), T(o.z)});
    const Vec3<T> wi =
        wardSample(wo, T(random.logUniform(1e-6, 10)), T(random.logUniform(1e-6, 10)), random.square<T>());
    EXPECT_NEAR(double(length(wi)), 1, 16 * kEps<T>);
  }
  for (Vec2<T> u : {Vec2<T>{0, 0}, Vec2<T>{T(0x1.fffffep-1), 0}, Vec2<T>{0, T(0x1.fffffep-1)},
                    Vec2<T>{T(0x1.fffffep-1), T(0x1.fffffep-1)}}) {
    const Vec3<T> wi = wardSample(Vec3<T>{0, 0, 1}, T(10), T(1e-6), u);
    EXPECT_NEAR(double(length(wi)), 1, 16 * kEps<T>);
  }
}

}  // namespace
}  // namespace wardmis
