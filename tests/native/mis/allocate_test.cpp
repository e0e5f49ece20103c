// SPDX-License-Identifier: GPL-3.0-or-later
// Fractions<3> from moments: the golden file's exact ones, clamps, and moments that say nothing.
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "ward_case.h"

namespace wardmis {
namespace {

using namespace test;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();

double sum(const Fractions<3>& a) { return double(a[0]) + double(a[1]) + double(a[2]); }

void expectFractions(const WardCase& c, Allocation rule, const char* key, const std::array<double, 3>& tolerance) {
  const Fractions<3> a = allocate<3>(rule, exactMoments(c), c.used, 0);
  for (size_t i = 0; i < static_cast<size_t>(c.techniques); ++i)
    EXPECT_NEAR(double(a[i]), c.expect["fractions"][key][i].get<double>(), tolerance[i]) << key << " technique " << i;
  EXPECT_NEAR(sum(a), 1, 1e-6);
}

void checkGolden(const WardCase& c) {
  SCOPED_TRACE(c.input.dump());
  std::array<double, 3> equal{}, second{}, variance{};
  double cancellation = 0;
  const Moments<3> m = exactMoments(c);
  for (size_t i = 0; i < static_cast<size_t>(c.techniques); ++i) {
    const double a = c.expect["fractions"]["inv_m2"][i].get<double>();
    equal[i] = 1e-7;
    second[i] = 1e-6 * a + 1e-30;
    // sigma^2 = square - mean^2 in float
    const double sigma2 = c.techniques == 3 ? c.expect["sigma2_eq"][i].get<double>()
                                            : c.expect["sigma2_" + std::to_string(i + 1) + "_eq"].get<double>();
    cancellation = std::max(cancellation, 3e-7 * double(m.square[i]) / sigma2);
  }
  expectFractions(c, Allocation::kEqual, "equal", equal);
  expectFractions(c, Allocation::kSecondMoment, "inv_m2", second);
  variance.fill(cancellation + 1e-6);
  if (cancellation < 0.1) {
    expectFractions(c, Allocation::kVariance, "sigma2", variance);
    expectFractions(c, Allocation::kStandardDeviation, "sigma", variance);
  }
}

// Full, planar, split, joint, Phong: fractions are fractions, whatever the integrand.
TEST(Allocate, GoldenFractions) {
  int checked = 0;
  for (const auto& c : golden()["estimator_cases"]) {
    const auto& first = c["expect"]["m2_1"];  // in joint mode beyond any float: nothing to allocate by
    if (!first.is_number() || first.get<double>() > 1e37 || !c["input"].contains("theta_o_deg")) continue;
    checkGolden(WardCase(c));
    ++checked;
  }
  EXPECT_GE(checked, 50);
}
TEST(Allocate, GoldenFractionsOfThreeTechniques) {
  for (const auto& c : golden()["three_technique_cases"]) checkGolden(WardCase(c));
}

// Def. 8's non-balance estimator has Def. 7's variance, in the exact values and with the fractions computed here:
// sum sigma_i^2/a_i with a_i proportional to sigma_i^2 is n sum sigma_i^2.
TEST(Allocate, VarianceRuleTiesWithEqual) {
  const char *def7 = "F_eq (Def 7)", *def8 = "nonbalance sigma2 (Def 8, Eq 14 weights)";
  for (const char* list : {"estimator_cases", "three_technique_cases"})
    for (const auto& json : golden()[list]) {
      if (json["input"]["model"] == "lafortune-phong" || !json["expect"]["NVar"][def8].is_number()) continue;
      const WardCase c(json);
      const double nVar = c.expect["NVar"][def7].get<double>();
      EXPECT_NEAR(c.expect["NVar"][def8].get<double>(), nVar, 1e-9 * nVar);
      if (c.techniques != 3) continue;
      const Fractions<3> a = allocate<3>(Allocation::kVariance, exactMoments(c), c.used, 0);
      double variance = 0;
      for (size_t i = 0; i < 3; ++i) variance += c.expect["sigma2_eq"][i].get<double>() / double(a[i]);
      EXPECT_NEAR(variance, nVar, 1e-4 * nVar);
    }
}

Moments<3> randomMoments(Random& random) {
  Moments<3> m;
  m.hits = static_cast<float>(random.integer(1, 1000));
  for (size_t i = 0; i < 3; ++i) {
    m.shared.second[i] = m.hits * static_cast<float>(random.logUniform(1e-8, 1e8));
    const double mean = random.logUniform(1e-3, 1), sigma2 = mean * mean * random.logUniform(1e-3, 1e3);
    m.mean[i] = m.hits * static_cast<float>(mean);
    m.square[i] = m.hits * static_cast<float>(mean * mean + sigma2);
    m.shared.integral += m.mean[i], m.shared.square += m.square[i];
  }
  return m;
}

constexpr Allocation kMomentRules[] = {Allocation::kVariance,         Allocation::kStandardDeviation,
                                       Allocation::kSecondMoment,     Allocation::kInverseVariance,
                                       Allocation::kRepresentativity, Allocation::kEqualised};

TEST(Allocate, ClampsAndSumsToOne) {
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const Moments<3> m = randomMoments(random);
    const auto used = static_cast<TechniqueMask>(random.integer(1, 7));
    const int n = std::popcount(used);
    const float minimum = k % 4 == 0 ? 0 : static_cast<float>(random.uniform(0, 0.6));  // also more than 1/n
    const double floor = std::min(double(minimum), 1.0 / n);
    for (Allocation rule : kMomentRules) {
      const Fractions<3> a = allocate<3>(rule, m, used, minimum), wanted = allocate<3>(rule, m, used, 0);
      EXPECT_NEAR(sum(a), 1, 1e-6);
      double ratio = 0;
      for (size_t i = 0; i < 3; ++i) {
        if ((used >> i & 1) == 0) {
          EXPECT_EQ(a[i], 0);
          continue;
        }
        EXPECT_GE(double(a[i]), floor * (1 - 2e-6));
        EXPECT_LE(double(a[i]), 1 - (n - 1) * floor + 1e-6);
        // what is above the minimum keeps its proportions
        if (double(a[i]) > floor * (1 + 1e-5)) {
          const double r = double(a[i]) / double(wanted[i]);
          if (ratio > 0) {
            EXPECT_NEAR(r, ratio, 1e-5 * ratio);
          }
          ratio = r;
        }
      }
    }
  }
}

TEST(Allocate, DoesNotDependOnTheScaleOfTheIntegrand) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    Moments<3> m = randomMoments(random);
    for (Allocation rule : kMomentRules) {
      const Fractions<3> a = allocate<3>(rule, m, Techniques<3>::kAll, 0.1f);
      Moments<3> bright = m;
      bright.shared.integral *= 0x1p10f, bright.shared.square *= 0x1p20f;
      for (size_t i = 0; i < 3; ++i)
        bright.shared.second[i] *= 0x1p20f, bright.square[i] *= 0x1p20f, bright.mean[i] *= 0x1p10f;
      const Fractions<3> b = allocate<3>(rule, bright, Techniques<3>::kAll, 0.1f);
      for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6);
    }
  }
}

// A zero, a NaN or an infinity in what a rule reads of any technique: equal fractions.
TEST(Allocate, EqualWhereTheMomentsSayNothing) {
  Random random(3);
  const auto isEqual = [](const Fractions<3>& a) { return a == Fractions<3>{1.0f / 3, 1.0f / 3, 1.0f / 3}; };
  for (size_t i = 0; i < 3; ++i) {
    for (float bad : {0.0f, kNan, kInf, -kInf, -1.0f}) {
      Moments<3> m = randomMoments(random);
      m.shared.second[i] = bad;
      EXPECT_TRUE(isEqual(allocate<3>(Allocation::kSecondMoment, m, Techniques<3>::kAll, 0))) << "second " << bad;
      EXPECT_FALSE(isEqual(allocate<3>(Allocation::kVariance, m, Techniques<3>::kAll, 0)));  // does not read it
      m = randomMoments(random);
      m.square[i] = bad;
      EXPECT_TRUE(isEqual(allocate<3>(Allocation::kVariance, m, Techniques<3>::kAll, 0))) << "square " << bad;
      EXPECT_FALSE(isEqual(allocate<3>(Allocation::kSecondMoment, m, Techniques<3>::kAll, 0)));
    }
    for (float bad : {kNan, kInf, -kInf}) {
      Moments<3> m = randomMoments(random);
      m.mean[i] = bad;
      EXPECT_TRUE(isEqual(allocate<3>(Allocation::kVariance, m, Techniques<3>::kAll, 0))) << "mean " << bad;
    }
  }
  for (Allocation rule : kMomentRules) {
    for (float hits : {0.0f, -1.0f, kNan}) {
      Moments<3> m = randomMoments(random);
      m.hits = hits;
      EXPECT_TRUE(isEqual(allocate<3>(rule, m, Techniques<3>::kAll, 0.1f))) << hits;
    }
    EXPECT_TRUE(isEqual(allocate<3>(rule, {}, Techniques<3>::kAll, 0.1f)));
    // no variance at all: every technique is exact, none is better
    Moments<3> m;
    m.hits = 1, m.square = m.mean = {1, 1, 1};
    EXPECT_TRUE(isEqual(allocate<3>(Allocation::kVariance, m, Techniques<3>::kAll, 0)));
    // a technique out of use may hold anything
    m = randomMoments(random);
    m.shared.second[1] = m.square[1] = m.mean[1] = kNan;
    const Fractions<3> a = allocate<3>(rule, m, TechniqueMask(0b101), 0);
    EXPECT_EQ(a[1], 0);
    EXPECT_NEAR(sum(a), 1, 1e-6);
    EXPECT_NE(a[0], 0.5f);
    EXPECT_EQ(allocate<3>(rule, m, 0, 0.1f), (Fractions<3>{}));
  }
}

// A lamp that the light technique finds with three times the digits of the cosine technique, under light that it does
// not aim at: blind to that light it got nearly all. Quadrature on [0, 1]: p_cosine = 1, p_light = 10 on [0, .1]; the
// lamp is 10 there, the sky `sky` everywhere.
TEST(Allocate, LightThatIsNotAimedAtKeepsItsTechnique) {
  const auto fractionsUnder = [](Allocation rule, float sky) {
    Moments<3> m;
    const Fractions<3> n{0, 0.5f, 0.5f};
    m.hits = 1;
    constexpr int kNodes = 1000;
    const auto add = [&](float f, float light) {  // weighted, so that the sum over the nodes is the integral
      Moments<3> one;
      const float q = 0.5f + 0.5f * light;
      one.add(f, {0, 1, light}, n, TechniqueMask(0b110));
      const auto scale = [&](PartMoments<3>& part) {
        for (float& x : part.second) x *= q / kNodes;
        part.square *= q / kNodes, part.integral *= q / kNodes;
      };
      scale(one.shared), scale(one.unaimed);
      for (size_t i = 0; i < 3; ++i) one.square[i] *= q / kNodes, one.mean[i] *= q / kNodes;
      m += one;
    };
    for (int k = 0; k < kNodes; ++k) {
      if (k < kNodes / 10) add(10, 10);
      if (sky > 0) add(sky, 0);
    }
    return allocate<3>(rule, m, TechniqueMask(0b110), 0);
  };
  for (Allocation rule : {Allocation::kSecondMoment, Allocation::kInverseVariance}) {
    const float none = fractionsUnder(rule, 0)[1];
    EXPECT_LT(none, 0.12f) << name(rule);
    float last = none;
    for (float sky : {0.1f, 1.0f, 10.0f, 100.0f}) {
      const float cosine = fractionsUnder(rule, sky)[1];
      EXPECT_GT(cosine, last) << name(rule) << ' ' << sky;
      last = cosine;
    }
    EXPECT_GT(fractionsUnder(rule, 1)[1], 0.45f) << name(rule);  // as much light as the lamp's
    EXPECT_GT(last, 0.95f) << name(rule);
  }
}

TEST(Allocate, ExtremeMoments) {
  for (Allocation rule : kMomentRules) {
    for (float big : {1e30f, 3e38f}) {
      for (float small : {1e-45f, 1e-38f, 1e-30f}) {
        Moments<3> m;
        m.hits = 1, m.shared.second = m.square = {small, big, big};
        m.shared.integral = small, m.shared.square = big;
        const Fractions<3> a = allocate<3>(rule, m, Techniques<3>::kAll, 0.1f);
        EXPECT_NEAR(sum(a), 1, 1e-5);
        for (float x : a) EXPECT_GE(x, 0.0999f);
      }
    }
  }
}

// lobe : light as the specular integrand wants, cosine : light as the diffuse one.
// Of a common budget, each integrand gets at least the half that is its own, shared as it asked; light samples serve
// both.
TEST(CombineSplit, MeetsBothDemands) {
  Random random(4);
  for (int k = 0; k < 1000; ++k) {
    const auto x = static_cast<float>(random.logUniform(1e-30, 0.999)),
               y = static_cast<float>(random.logUniform(1e-30, 0.999));
    const bool flip = k % 2 == 0;
    const Fractions<3> specular{flip ? 1 - x : x, 0, flip ? x : 1 - x}, diffuse{0, 1 - y, y};
    const Fractions<3> a = combineSplit<3>({specular, diffuse});
    EXPECT_NEAR(sum(a), 1, 1e-6);
    EXPECT_GE(a[0], 0.5f * specular[0] * (1 - 1e-6f));
    EXPECT_GE(a[1], 0.5f * diffuse[1] * (1 - 1e-6f));
    EXPECT_GE(a[2], 0.5f * std::max(specular[2], diffuse[2]) * (1 - 1e-6f));
    EXPECT_NEAR(double(a[0]) * double(diffuse[1]), double(a[1]) * double(specular[0]), 1e-6);
  }
}
// Def. 7 for both integrands at once.
TEST(CombineSplit, EqualIsEqual) {
  const Fractions<3> a = combineSplit<3>({{{0.5f, 0, 0.5f}, {0, 0.5f, 0.5f}}});
  for (float x : a) EXPECT_FLOAT_EQ(x, 1.0f / 3);
}
TEST(AllocateSplit, AbsentIntegrandsAskForNothing) {
  const auto equal = [](TechniqueMask m) { return allocateSplit<3>(Allocation::kEqual, {}, m, 0.1f); };
  EXPECT_EQ(equal(TechniqueMask(0b110)), (Fractions<3>{0, 0.5f, 0.5f}));
  EXPECT_EQ(equal(TechniqueMask(0b101)), (Fractions<3>{0.5f, 0, 0.5f}));
  EXPECT_EQ(equal(maskOf(2)), (Fractions<3>{0, 0, 1}));
  EXPECT_EQ(equal(0), (Fractions<3>{}));
}
TEST(CombineSplit, WithoutLightHalfForEach) {
  EXPECT_EQ(combineSplit<3>({{{1, 0, 0}, {0, 1, 0}}}), (Fractions<3>{0.5f, 0.5f, 0}));
  EXPECT_EQ(combineSplit<3>({{{1, 0, 0}, {0, 0, 0}}}), (Fractions<3>{1, 0, 0}));
  EXPECT_EQ(combineSplit<3>({{{0, 0, 0}, {0, 1, 0}}}), (Fractions<3>{0, 1, 0}));
  EXPECT_EQ(combineSplit<3>({{{0, 0, 0}, {0, 0, 0}}}), (Fractions<3>{}));
  EXPECT_EQ(combineSplit<3>({{{0.5f, 0, 0.5f}, {0, 0, 0}}}), (Fractions<3>{0.5f, 0, 0.5f}));
}
// With no minimum a light's share may be next to nothing.
TEST(CombineSplit, TinyShares) {
  for (float x : {1e-45f, 1e-40f, 1e-38f, 1e-20f})
    for (float y : {1e-45f, 1e-40f, 1e-38f, 1e-20f, 0.5f}) {
      const Fractions<3> a = combineSplit<3>({{{1 - x, 0, x}, {0, 1 - y, y}}});
      EXPECT_NEAR(sum(a), 1, 1e-6) << x << " " << y;
    }
}

TEST(Restrict, KeepsProportions) {
  const Fractions<3> a{0.2f, 0.3f, 0.5f};
  const Fractions<3> r = restrict<3>(a, TechniqueMask(0b101));
  EXPECT_FLOAT_EQ(r[0], 0.2f / 0.7f);
  EXPECT_EQ(r[1], 0);
  EXPECT_FLOAT_EQ(r[2], 0.5f / 0.7f);
  EXPECT_EQ(restrict<3>({1, 0, 0}, TechniqueMask(0b110)), (Fractions<3>{0, 0.5f, 0.5f}));  // nothing known of these
  EXPECT_EQ(restrict<3>({1, 0, 0}, maskOf(2)), (Fractions<3>{0, 0, 1}));
  EXPECT_EQ(restrict<3>(a, 0), (Fractions<3>{}));
}

TEST(Names, AreTheCommandLinesOwn) {
  EXPECT_EQ(name(Allocation::kSecondMoment), "second-moment");
  EXPECT_EQ(name(Allocation::kAlbedo), "albedo");
  EXPECT_EQ(name(Weights::kNonbalance), "nonbalance");
  EXPECT_EQ(name(Integrand::kJoint), "joint");
}

}  // namespace
}  // namespace wardmis
