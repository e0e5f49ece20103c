// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/surface.h"

#include <gtest/gtest.h>

#include "reference.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

template <class T>
class Surfaces : public testing::Test {};
using FloatAndDouble = testing::Types<float, double>;
TYPED_TEST_SUITE(Surfaces, FloatAndDouble);

// The vectorised loop says what the scalar functions say, bit for bit, for every batch size, above and below the
// horizon.
TYPED_TEST(Surfaces, BatchEqualsScalar) {
  using T = TypeParam;
  constexpr int kCapacity = 37;
  Random random(1);
  for (int round = 0; round < 300; ++round)
    for (const Variant& v : kVariants) {
      Surface s;
      s.variant = v.type;
      s.ax = static_cast<float>(random.logUniform(0.02, 2)), s.ay = static_cast<float>(random.logUniform(0.02, 2));
      const Vec3<double> o = round % 10 == 0 ? random.direction() : random.above();  // also from below
      const Vec3<T> wo{T(o.x), T(o.y), T(o.z)};
      LobeBatch<T, 1, kCapacity> batch;
      const int n = random.integer(0, kCapacity);
      for (int j = 0; j < kCapacity; ++j) {
        const Vec3<double> i = random.direction();
        batch.set(j,
                  j % 5 == 0 ? wardSample(wo, T(s.ax), T(s.ay), random.square<T>()) : Vec3<T>{T(i.x), T(i.y), T(i.z)});
        batch.fCos[0][j] = batch.pdf[0][j] = T(-7);
      }
      s.evaluateLobe(0, wo, batch, n);
      for (int j = 0; j < kCapacity; ++j) {
        if (j >= n) {
          EXPECT_TRUE(batch.fCos[0][j] == T(-7) && batch.pdf[0][j] == T(-7)) << "written past n";
          continue;
        }
        const Vec3<T> wi = batch.wi(j);
        const WardValue<T> w = ward(v.type, wi, wo, T(s.ax), T(s.ay)), single = s.evaluateLobe(0, wi, wo);
        EXPECT_EQ(batch.fCos[0][j], w.fCos);
        EXPECT_EQ(batch.pdf[0][j], w.pdf);
        EXPECT_EQ(single.fCos, w.fCos);
        EXPECT_EQ(single.pdf, w.pdf);
        if (wi.z <= 0 || wo.z <= 0) {
          EXPECT_EQ(batch.fCos[0][j], 0);
          EXPECT_EQ(batch.pdf[0][j], 0);
        }
      }
    }
}

TEST(Surface, KnowsItsParts) {
  Surface s;
  EXPECT_FALSE(s.hasDiffuse() || s.hasSpecular());
  s.diffuse = {0, 0, 0.1f};
  s.specular = {0.1f, 0, 0};
  EXPECT_TRUE(s.hasDiffuse() && s.hasSpecular());
  EXPECT_FALSE(s.needsDouble(1));
  s.ay = 1e-3f;
  EXPECT_TRUE(s.needsDouble(1));
}

// Why needsDouble() draws the line where it does: above it, the rounding of a float direction (half an ulp of a unit
// vector's components) moves ln pdf of a sampled direction by a few per cent at most, outside grazing angles.
TEST(Surface, FloatDirectionsSufficeAboveTheLine) {
  Random random(2);
  const double alpha = 2e-3;
  for (int i = 0; i < 20000; ++i) {
    const double theta = random.uniform(0, 1.4), phi = random.uniform(0, 7);
    const Vec3<double> wo{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    const Vec3<double> wi = wardSample(wo, alpha, alpha, random.square());
    const auto rounded = [](Vec3<double> d) {
      return Vec3f{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
    };
    const double exact = ward(WardVariant::kWardGmd, wi, wo, alpha, alpha).pdf;
    const double got = double(ward(WardVariant::kWardGmd, rounded(wi), rounded(wo), 2e-3f, 2e-3f).pdf);
    if (wi.z > 0.1) {
      EXPECT_NEAR(got / exact, 1, 0.01);
    }
  }
}

// As `wardmis stability` finds: float directions carry the lobe but for sharp ones, and wide ones that are sharp
// across.
TEST(Surface, NeedsDouble) {
  const auto needs = [](float ax, float ay, float cosThetaO = 1) {
    Surface s;
    s.ax = ax, s.ay = ay;
    return s.needsDouble(cosThetaO);
  };
  EXPECT_TRUE(needs(1e-4f, 1e-4f));
  EXPECT_TRUE(needs(1.9e-3f, 0.5f));
  EXPECT_FALSE(needs(2.1e-3f, 2.1e-3f));
  EXPECT_TRUE(needs(0.01f, 10));
  EXPECT_TRUE(needs(10, 0.01f));
  EXPECT_FALSE(needs(0.1f, 10));
  // at 89.99 and 89.9 degrees
  EXPECT_TRUE(needs(0.01f, 0.01f, 1.75e-4f));
  EXPECT_TRUE(needs(3, 0.01f, 1.75e-4f));
  EXPECT_FALSE(needs(0.01f, 0.01f, 1.75e-3f));
  EXPECT_FALSE(needs(0.1f, 0.1f, 1.75e-4f));
}

}  // namespace
}  // namespace wardmis
