// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes point by point: against the textbook in 50 digits, their own parts, reciprocity, and ward.h and phong.h.
#include <gtest/gtest.h>

#include <fstream>

#include "bsdf/bump_shadow.h"
#include "golden.h"
#include "lobes.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;
using Vec = Vec3<double>;

// 300 points of all lobes with formulas of their own (tests/golden/lobes.py).
TEST(Lobe, IsTheTextbooks) {
  const nlohmann::json points = nlohmann::json::parse(std::ifstream(WARDMIS_TEST_DATA "/golden/lobes.json"));
  ASSERT_GE(points.size(), 250u);
  for (const auto& point : points) {
    SCOPED_TRACE(point.dump());
    const Lobe l = lobeOf(point["lobe"]);
    const Vec wi = vec3<double>(point["wi"]), wo = vec3<double>(point["wo"]), f = vec3<double>(point["f_cos"]);
    const LobeValue<double> v = evaluate(l, wi, wo);
    // rounding of directions to doubles is magnified by their part in the exponent, and by eta - 1
    const double magnified = 1 / (std::min(l.ax, l.ay) * (l.eta == 1 ? 1 : std::min(1.0f, std::abs(l.eta - 1))));
    const double close = 1e-13 * (10 + magnified * magnified);
    EXPECT_NEAR(v.fCos.x, f.x, close * f.x);
    EXPECT_NEAR(v.fCos.y, f.y, close * f.y);
    EXPECT_NEAR(v.fCos.z, f.z, close * f.z);
    EXPECT_NEAR(v.pdf, point["pdf"].get<double>(), close * point["pdf"].get<double>());
  }
}

// A pair of directions that the lobe connects: the second is sampled.
struct Pair {
  Vec wo, wi;
};
Pair pairOf(const Lobe& l, Random& random) {
  const Vec wo = random.above();
  return {wo, drawn(l, wo, random)};
}

TEST(Lobe, WeightIsWhatASampleBringsOverDensity) {
  Random random(1);
  for (const Lobe& l : roughLobes()) {
    SCOPED_TRACE(testing::PrintToString(l));
    for (int i = 0; i < 300; ++i) {
      const auto [wo, wi] = pairOf(l, random);
      const LobeValue<double> v = evaluate(l, wi, wo);
      const Vec w = weight(l, wi, wo);
      if (!(v.pdf > 1e-200)) {
        EXPECT_EQ(v.fCos.x, 0);
        continue;
      }
      const Vec all = brought(l, wi, wo);
      EXPECT_NEAR(w.x, all.x / v.pdf, 1e-9 * (1e-3 + w.x));
      EXPECT_NEAR(w.z, all.z / v.pdf, 1e-9 * (1e-3 + w.z));
      EXPECT_NEAR(logPdf(l, wi, wo), std::log(v.pdf), 1e-9 * (1 + std::abs(std::log(v.pdf))));
    }
  }
}

TEST(Lobe, LiesOnItsSideAlone) {
  Random random(2);
  for (const Lobe& l : roughLobes()) {
    SCOPED_TRACE(testing::PrintToString(l));
    const double side = transmits(l.kind) ? -1 : 1;
    for (int i = 0; i < 200; ++i) {
      const Vec wo = random.above(), wi = random.above() * -side, below = -random.above();
      if (!detail::seenFromBelow(l.kind)) {
        EXPECT_EQ(evaluate(l, random.above() * side, below).fCos.x, 0);  // wo below
      }
      if (isGlass(l.kind)) continue;
      EXPECT_EQ(evaluate(l, wi, wo).fCos.x, 0);
      if (l.refractsUp) continue;  // by strays
      EXPECT_EQ(weight(l, wi, wo).x, 0);
      if (l.kind != LobeKind::kPhong) {
        EXPECT_EQ(evaluate(l, wi, wo).pdf, 0);
      }
    }
  }
}

// f(wi, wo) = f(wo, wi); of refraction f(wi, wo, eta) = eta^2 f(wo, wi, 1/eta) with the surface turned over. Not of the
// lobes that are not in Cycles either: fibres, and diffuse light reflected more than once, of which the colour is
// squared.
TEST(Lobe, IsReciprocal) {
  Random random(3);
  int lobes = 0;
  for (Lobe l : roughLobes()) {
    if (l.kind == LobeKind::kFibres || l.kind == LobeKind::kOrenNayar || l.kind == LobeKind::kRoughTranslucent)
      continue;
    SCOPED_TRACE(testing::PrintToString(l));
    Lobe back = l;
    if (isGlass(l.kind)) continue;  // its halves are
    const bool through = l.kind == LobeKind::kGgxRefraction || l.kind == LobeKind::kBeckmannRefraction;
    if (through) back.eta = 1 / l.eta;
    int pairs = 0;
    for (int i = 0; i < 300; ++i) {
      const auto [wo, wi] = pairOf(l, random);
      const LobeValue<double> v = evaluate(l, wi, wo);
      if (!(v.fCos.x > 1e-6)) continue;
      const Vec turnedI = transmits(l.kind) ? -wi : wi, turnedO = transmits(l.kind) ? -wo : wo;
      const double f = v.fCos.x / std::abs(wi.z);
      const double g = evaluate(back, turnedO, turnedI).fCos.x / wo.z;
      const double eta2 = through ? double(l.eta) * l.eta : 1;
      EXPECT_NEAR(f, eta2 * g, 1e-5 * f);  // 1/eta is rounded to float
      ++pairs;
    }
    EXPECT_GT(pairs, 80);
    ++lobes;
  }
  EXPECT_GE(lobes, 20);
}

TEST(Lobe, OrenNayarOfOneReflectionIsReciprocal) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec wi = random.above(), wo = random.above();
    EXPECT_DOUBLE_EQ(orenNayarF(wi, wo, 0.3, 0.2), orenNayarF(wo, wi, 0.3, 0.2));
  }
}

template <class T>
void wardAndPhongKeepTheirBits() {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Vec o = random.above(), d = random.above();
    const Vec3<T> wo{T(o.x), T(o.y), T(o.z)}, wi{T(d.x), T(d.y), T(d.z)};
    // volatile: with -fno-trapping-math GCC 12 leaves out the rounding of a double to float where it is widened again
    const volatile float narrow[2] = {float(random.logUniform(1e-3, 1)), float(random.logUniform(1e-3, 1))};
    const float ax = narrow[0], ay = narrow[1];
    const Vec2<T> u = random.square<T>();
    for (int k = 0; k < 3; ++k) {
      const auto variant = static_cast<WardVariant>(k);
      const Lobe l =
          lobe(static_cast<LobeKind>(int(LobeKind::kWard) + k), ax, ay, 1, Fresnel::kNone, Masking::kCorrelated);
      const WardValue<T> v = wardEvaluate(variant, wi, wo, T(1) / T(ax), T(1) / T(ay));
      EXPECT_EQ(evaluate(l, wi, wo).fCos.y, v.fCos);
      EXPECT_EQ(evaluate(l, wi, wo).pdf, v.pdf);
      EXPECT_EQ(sample(l, wo, u, T(0)), wardSample(wo, T(ax), T(ay), u));
      EXPECT_EQ(weight(l, wi, wo).z, wardWeight(variant, wi, wo));
      EXPECT_EQ(logPdf(l, wi, wo), wardLogPdf(wi, wo, T(1) / T(ax), T(1) / T(ay)));
    }
    Lobe phong;
    phong.kind = LobeKind::kPhong, phong.a = float(random.uniform(0, 100));
    const T gamma = phongCosGamma(wi, wo), m = T(phong.a);
    EXPECT_EQ(evaluate(phong, wi, wo).fCos.x, phongEvaluate(gamma, m).f * wi.z);
    EXPECT_EQ(evaluate(phong, wi, wo).pdf, phongEvaluate(gamma, m).pdf);
    EXPECT_EQ(sample(phong, wo, u, T(0)), phongSample(wo, m, u));
    EXPECT_EQ(weight(phong, wi, wo).x, phongWeight(gamma, wi.z, m));
  }
}
TEST(Lobe, WardAndPhongKeepTheirBitsInFloat) { wardAndPhongKeepTheirBits<float>(); }
TEST(Lobe, WardAndPhongKeepTheirBitsInDouble) { wardAndPhongKeepTheirBits<double>(); }

// Glass sends the light of the two lobes that it is made of, and its two densities are theirs, shared out by what a
// facet sends to either side.
TEST(Glass, IsItsTwoLobes) {
  Random random(7);
  int pairs = 0;
  for (const Lobe& l : roughLobes()) {
    if (!isGlass(l.kind)) continue;
    SCOPED_TRACE(testing::PrintToString(l));
    const std::vector<Lobe> parts = halves(l);
    for (int i = 0; i < 1000; ++i) {
      const Vec wo = random.above(), wi = drawn(parts[static_cast<size_t>(i % 2)], wo, random);
      const LobeValue<double> v = evaluate(l, wi, wo);
      Vec sum;
      double density = 0;
      for (const Lobe& part : parts) sum += evaluate(part, wi, wo).fCos, density += evaluate(part, wi, wo).pdf;
      EXPECT_DOUBLE_EQ(v.fCos.x, sum.x);
      EXPECT_DOUBLE_EQ(v.fCos.z, sum.z);
      if (!(density > 0)) continue;
      const auto strength = [](Vec c) { return c.x + c.y + c.z; };
      const Vec h = wi.z > 0 ? wi + wo : refractionHalf(wi, wo, double(l.eta));
      const double c = std::min(dot(wo, h) / length(h), 1.0), up = strength(rgb<double>(l.weight) * reflectance(l, c)),
                   down = strength(rgb<double>(l.through) * transmittance(l, c));
      EXPECT_NEAR(v.pdf, density * (wi.z > 0 ? up : down) / (up + down), 1e-9 * density);
      ++pairs;
    }
  }
  EXPECT_GT(pairs, 3000);
}

// Walter's formula with the half vector as it comes out, where no facet refracts so; nothing where one does.
TEST(Lobe, UnseenIsTheFormulaWhereNoFacetRefracts) {
  Random random(8);
  for (Lobe l : roughLobes()) {
    if (!isGlass(l.kind) && l.kind != LobeKind::kGgxRefraction && l.kind != LobeKind::kBeckmannRefraction) continue;
    SCOPED_TRACE(testing::PrintToString(l));
    const bool ggx = l.kind == LobeKind::kGgxRefraction || l.kind == LobeKind::kGgxGlass;
    const double alpha = l.ax, a2 = alpha * alpha, eta = l.eta;
    l.ay = l.ax;
    Lobe closed = l;
    l.unseenFacets = true;
    int found = 0;
    double grazing = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec wo = random.above(), wi = -random.above();
      EXPECT_EQ(unseen(closed, wi, wo).fCos.x, 0);
      const LobeValue<double> v = unseen(l, wi, wo);
      Vec h = -(wi * eta + wo);
      const double l2 = dot(h, h);
      h = h / std::sqrt(l2);
      if (dot(h, wo) < 0) h = -h;
      if (h.z > 0 && dot(h, wi) < 0) {
        EXPECT_EQ(v.fCos.x, 0);
        EXPECT_EQ(v.pdf, 0);
        continue;
      }
      const auto lambda = [&](Vec w) {
        const double t = alpha * std::sqrt(1 - w.z * w.z) / std::abs(w.z), a = 1 / t;
        if (ggx) return (std::sqrt(1 + t * t) - 1) / 2;
        return a < 1.6 ? (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a) : 0;
      };
      const double c2 = h.z * h.z, cosine = dot(h, wo), o = lambda(wo), in = lambda(wi),
                   d = ggx ? a2 / (kPi<double> * std::pow(1 - c2 + a2 * c2, 2))
                           : std::exp((1 - 1 / c2) / a2) / (kPi<double> * a2 * c2 * c2),
                   g = l.masking == Masking::kSeparable ? 1 / ((1 + o) * (1 + in)) : 1 / (1 + o + in);
      const Rgb color = isGlass(l.kind) ? l.through : l.weight;
      const double expected =
          color.y * transmittance(l, cosine).y * d * g * eta * eta / l2 * cosine * std::abs(dot(h, wi)) / wo.z;
      EXPECT_NEAR(v.fCos.y, expected, 1e-5 * expected + 1e-200);
      if (expected > 1e-200) {
        EXPECT_GT(v.pdf, 0);
      }
      EXPECT_EQ(evaluate(l, wi, wo).fCos.y, 0);
      EXPECT_EQ(unseen(l, -wi, wo).fCos.y, 0);
      EXPECT_EQ(unseen(l, wi, -wo).fCos.y, 0);
      grazing = std::max(grazing, v.fCos.y);
      ++found;
    }
    EXPECT_GT(found, 100);
    if (ggx) {
      EXPECT_GT(grazing, 1e-3);
    }
  }
}

// Snell, Fresnel and the sum of both halves of sharp glass.
TEST(Delta, GlassReflectsOrRefracts) {
  Random random(6);
  for (const float eta : {0.5f, 0.7f, 0.9f, 1.0f, 1.0001f, 1.5f, 3.0f})
    for (int i = 0; i < 200; ++i) {
      const Vec wo = random.above();
      Lobe l = lobe(LobeKind::kMirror, 0, 0, eta, Fresnel::kBlended, Masking::kCorrelated);
      l.f0 = gray(fresnelNormal(eta));
      const Vec mirror = sample(l, wo, {0, 0}, 0.0);
      EXPECT_EQ(mirror.x, -wo.x);
      EXPECT_EQ(evaluate(l, mirror, wo).pdf, 0);
      const double reflected = weight(l, mirror, wo).x;
      EXPECT_NEAR(reflected, fresnelDielectric(wo.z, double(eta)), 1e-6);
      l.kind = LobeKind::kSharpRefraction;
      EXPECT_TRUE(isDelta(l.kind) && transmits(l.kind));
      const Vec wi = sample(l, wo, {0, 0}, 0.0);
      const double sine2 = (1 - wo.z * wo.z) / (double(eta) * eta);
      EXPECT_NEAR(length(wi), 1, 1e-12);
      if (sine2 >= 1) {
        EXPECT_GT(wi.z, 0);
        EXPECT_EQ(weight(l, wi, wo).x, 0);
        EXPECT_EQ(reflected, 1);
      } else {
        EXPECT_NEAR(wi.x * eta, -wo.x, 1e-12);
        EXPECT_NEAR(wi.z, -std::sqrt(1 - sine2), 1e-12);
        EXPECT_NEAR(weight(l, wi, wo).x, 1 - reflected, 1e-9);
      }
    }
}

TEST(Delta, TransparentGoesStraightOn) {
  Lobe l;
  l.kind = LobeKind::kTransparent, l.weight = {0.1f, 0.2f, 0.3f};
  const Vec wo{0.6, 0, 0.8};
  EXPECT_EQ(sample(l, wo, {0.5, 0.5}, 0.0), -wo);
  EXPECT_EQ(weight(l, -wo, wo).y, double(0.2f));
}

TEST(Fresnel, KnowsF82) {
  for (const float f0 : {0.1f, 0.5f, 0.95f})
    for (const float tint : {0.0f, 0.3f, 1.0f}) {
      const double c = 1.0 / 7, schlick = f0 + (1 - f0) * std::pow(1 - c, 5);
      EXPECT_NEAR(fresnelF82(c, double(f0), double(f82Edge(f0, tint))), schlick * tint, 1e-6);
      EXPECT_NEAR(fresnelF82(1.0, double(f0), double(f82Edge(f0, tint))), f0, 1e-7);
    }
}

}  // namespace
// A normal turned by 45 degrees: light between the surface and it, and light that leaves the surface on the other side.
TEST(BumpShadow, DarkensWhatGoesThroughForLightSamplesAlone) {
  const float turned = std::sqrt(0.5f);
  for (int version : {3, 4, 5})
    for (float side : {1.0f, -1.0f}) {
      const BumpShadow low = bumpShadow(version, LobeKind::kLambert, 0.2f * side, turned, 0.8f * side),
                       other = bumpShadow(version, LobeKind::kLambert, -0.2f * side, turned, 0.5f * side),
                       facets = bumpShadow(version, LobeKind::kGgx, -0.2f * side, turned, 0.5f * side);
      EXPECT_GT(low.byLight, 0.1);
      EXPECT_LT(low.byLight, 0.9);
      EXPECT_EQ(low.bySurface, side > 0 ? low.byLight : 1);
      EXPECT_EQ(other.byLight, 0);
      EXPECT_EQ(other.bySurface, side > 0 ? 0 : 1);
      EXPECT_EQ(facets.byLight, 0);
      EXPECT_EQ(facets.bySurface, 1);
    }
}

}  // namespace wardmis
