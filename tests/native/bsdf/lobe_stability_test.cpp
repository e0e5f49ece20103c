// SPDX-License-Identifier: GPL-3.0-or-later
// Float against double, at extreme roughness, angles and indices: no number that is none, and no error beyond what the
// rounding of directions to float makes in any formula.
#include <gtest/gtest.h>

#include "lobes.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

// Not inlined: with -fno-trapping-math GCC 12 leaves out the rounding of a double to float where it is widened again.
template <class T>
[[gnu::noinline]] Vec3<T> as(Vec3<double> v) {
  return {T(v.x), T(v.y), T(v.z)};
}
Vec3<double> grazing(Random& random) {
  const double degrees = random.uniform() < 0.3 ? 90 - random.logUniform(1e-4, 10) : random.uniform(0, 90);
  const double phi = random.uniform(0, 7), s = sinDegrees(degrees);
  return {s * std::cos(phi), s * std::sin(phi), cosDegrees(degrees)};
}
Lobe extreme(Random& random) {
  Lobe l;
  l.kind = static_cast<LobeKind>(random.integer(0, kLobeKinds - 1));
  const auto alpha = [&] { return float(random.uniform() < 0.2 ? 1 : random.logUniform(1e-6, 1)); };
  l.ax = alpha(), l.ay = random.uniform() < 0.5 ? l.ax : alpha();
  if (l.kind == LobeKind::kAshikhminShirley) l.ax = std::max(l.ax, 1e-4f), l.ay = std::max(l.ay, 1e-4f);
  const float etas[] = {0.3f, 0.9f, 0.9999f, 1.0001f, 1.5f, 3.0f, 20.0f};
  l.eta = etas[random.integer(0, 6)];
  l.fresnel = static_cast<Fresnel>(random.integer(0, 3)), l.masking = static_cast<Masking>(random.integer(0, 1));
  l.f0 = {float(random.uniform()), float(random.uniform()), float(random.uniform())};
  l.edge = {f82Edge(l.f0.x, 0), f82Edge(l.f0.y, float(random.uniform())), 0};
  l.a = float(random.uniform(0.01, 1)), l.b = float(random.uniform(-0.2, 0));
  if (l.kind == LobeKind::kOrenNayar || l.kind == LobeKind::kRoughTranslucent) {
    const auto model = OrenNayar<float>::of(float(random.uniform()));
    l.a = model.a, l.b = model.b;
  }
  return l;
}

template <class T>
void neverGivesNan() {
  Random random(1);
  const double ends[] = {0, 0x1p-24, 0.5, 1 - 0x1p-24};
  int finite = 0;
  for (int i = 0; i < 300000; ++i) {
    const Lobe l = extreme(random);
    const Vec3<T> wo = as<T>(grazing(random));
    Vec2<T> u = random.square<T>();
    if (i % 7 == 0) u = {T(ends[random.integer(0, 3)]), T(ends[random.integer(0, 3)])};
    const Vec3<T> wi = sample(l, wo, u, T(isGlass(l.kind) ? 0.999 * random.uniform() : 0));
    ASSERT_TRUE(isFinite(wi)) << testing::PrintToString(l) << " wo " << wo.x << " " << wo.y << " " << wo.z << " u "
                              << u.x << " " << u.y;
    ASSERT_NEAR(length(wi), 1, 1e-4) << testing::PrintToString(l);
    for (const Vec3<T> w : {wi, as<T>(grazing(random)), -as<T>(grazing(random))}) {
      const LobeValue<T> v = evaluate(l, w, wo);
      const Vec3<T> weighed = weight(l, w, wo);
      const T density = logPdf(l, w, wo);
      ASSERT_TRUE(isFinite(weighed) && std::min(weighed.x, std::min(weighed.y, weighed.z)) >= 0)
          << testing::PrintToString(l);
      ASSERT_TRUE(v.pdf >= 0 && !(v.fCos.x < 0) && !std::isnan(v.fCos.x) && !std::isnan(v.fCos.y) &&
                  !std::isnan(v.fCos.z))
          << testing::PrintToString(l) << " wo " << wo.x << " " << wo.y << " " << wo.z << " wi " << w.x << " " << w.y
          << " " << w.z;
      ASSERT_FALSE(std::isnan(density)) << testing::PrintToString(l);
      finite += isFinite(v.fCos);
    }
  }
  EXPECT_GT(finite, 890000);  // densities of alpha 1e-6 may leave the range of float, rarely
}
TEST(LobeStability, NeverGivesNanInFloat) { neverGivesNan<float>(); }
TEST(LobeStability, NeverGivesNanInDouble) { neverGivesNan<double>(); }

// Of the same float directions, so that their own rounding does not count: what is left is forward error. In the
// exponent E of Gaussian lobes an error of E roundings is that of any formula.
TEST(LobeStability, FloatIsDoubleOfTheSameDirections) {
  Random random(2);
  double worst = 0;
  int compared = 0;
  for (int i = 0; i < 200000; ++i) {
    const Lobe l = extreme(random);
    if (isDelta(l.kind) || l.kind == LobeKind::kPhong) continue;
    const Vec3<float> wo = as<float>(grazing(random)), wi = drawn(l, wo, random);
    if (!(wi.z > 0 ? reflects(l.kind) : transmits(l.kind))) continue;
    // strays are told by how directions differ that are nearly opposite
    if (l.kind == LobeKind::kAshikhminShirley && dot(wi, wo) < -0.86f) continue;
    const LobeValue<float> f = evaluate(l, wi, wo);
    const LobeValue<double> d = evaluate(l, Vec3<double>{wi.x, wi.y, wi.z}, Vec3<double>{wo.x, wo.y, wo.z});
    if (!(d.pdf > 1e-30) || !(d.pdf < 1e30) || !(d.fCos.z > 1e-30)) continue;
    const double exponent = std::abs(logPdf(l, Vec3<double>{wi.x, wi.y, wi.z}, Vec3<double>{wo.x, wo.y, wo.z}));
    // wo + eta wi is rounded where the index is not near 1, which small alpha magnify as they do the directions' own
    const bool refracts =
        l.kind == LobeKind::kGgxRefraction || l.kind == LobeKind::kBeckmannRefraction || isGlass(l.kind);
    const double rounded = refracts ? 1e-6 / std::min(l.ax, l.ay) : 0;
    const double error = std::abs(f.pdf / d.pdf - 1) / (1 + exponent);
    if (rounded == 0) worst = std::max(worst, error);
    ASSERT_LT(error, 3e-5 + rounded) << testing::PrintToString(l) << " wo " << wo.x << " " << wo.y << " " << wo.z
                                     << " wi " << wi.x << " " << wi.y << " " << wi.z << ": " << f.pdf << " " << d.pdf;
    ASSERT_LT(std::abs(f.fCos.z / d.fCos.z - 1) / (1 + exponent), 3e-4 + rounded)
        << testing::PrintToString(l) << f.fCos.z << " " << d.fCos.z;
    ++compared;
  }
  EXPECT_GT(compared, 100000);
  RecordProperty("worst", std::to_string(worst));
}

// Fresnel near index 1 and at grazing angles: relative to double.
TEST(LobeStability, FresnelKeepsItsDigits) {
  Random random(3);
  for (int i = 0; i < 20000; ++i) {
    const float etas[] = {0.9f, 0.9999f, 1.0001f, 1.01f, 1.5f, 3.0f};
    const float eta = etas[random.integer(0, 5)],
                c = float(random.uniform() < 0.5 ? random.logUniform(1e-5, 1) : random.uniform());
    const double exact = fresnelDielectric(double(c), double(eta));
    const double g2 = etaSquaredMinus1(double(eta)) + double(c) * c;
    if (std::abs(g2) < 1e-6) continue;  // at the critical angle, which float does not hit
    EXPECT_NEAR(fresnelDielectric(c, eta), exact, 1e-4 * exact + 1e-7 * std::abs(double(eta) - 1)) << eta << " " << c;
  }
}

}  // namespace
}  // namespace wardmis
