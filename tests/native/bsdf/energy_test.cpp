// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of albedos against the lobes themselves, what compensation makes of them, and Cycles 3.4's walk from facet
// to facet beside it.
#include <gtest/gtest.h>

#include "bsdf/principled.h"
#include "lobes.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;
using Vec = Vec3<double>;

Vec at(double cosine) { return {std::sqrt(1 - cosine * cosine), 0, cosine}; }
Estimate meanWeight(const Lobe& l, const Vec& wo, Random& random, int n) {
  Estimate e;
  for (int i = 0; i < n; ++i) e.add(weight(l, drawn(l, wo, random), wo).x);
  return e;
}

// At 60 points of the grids: within 5 standard errors and the steps of 16 bits, 3e-5 false alarms.
TEST(Energy, TablesAreTheLobesAlbedos) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const float rough = float(random.integer(1, 31)) / 31, mu = float(random.integer(1, 31)) / 31;
    const Lobe l = lobe(LobeKind::kGgx, rough * rough, rough * rough, 1, Fresnel::kNone, Masking::kCorrelated);
    const Estimate e = meanWeight(l, at(mu), random, 20000);
    EXPECT_NEAR(reflectionAlbedo(rough, mu).directional, e.mean(), 5 * e.error() + 1e-4) << rough << " " << mu;
  }
  for (int i = 0; i < 20; ++i) {
    const float rough = float(random.integer(1, 15)) / 15, mu = float(random.integer(2, 15)) / 15;
    const float root = square(float(random.integer(1, 13)) / 15), eta = (1 + root) / (1 - root);
    Lobe l = lobe(LobeKind::kGgx, rough * rough, rough * rough, eta, Fresnel::kDielectric, Masking::kCorrelated);
    const Estimate up = meanWeight(l, at(mu), random, 40000);
    Lobe black = l;
    black.fresnel = Fresnel::kBlended, black.f0 = {0, 0, 0};
    const Estimate blended = meanWeight(black, at(mu), random, 40000);
    l.kind = LobeKind::kGgxRefraction;
    const Estimate down = meanWeight(l, at(mu), random, 40000);
    EXPECT_NEAR(glassAlbedo(rough, mu, eta).directional, up.mean() + down.mean(),
                5 * (up.error() + down.error()) + 1e-4)
        << rough << " " << mu << " " << eta;
    // the mean blend counts each facet once, masked or not: a bound
    EXPECT_GE(blendAlbedo(rough, mu, eta) + 5 * blended.error() + 1e-4, blended.mean());
  }
}

TEST(Energy, MeansAreOverTheHemisphere) {
  for (const float rough : {0.2f, 0.5f, 1.0f}) {
    double mean = 0;
    const int n = 400;
    for (int i = 0; i < n; ++i) {
      const float mu = (float(i) + 0.5f) / n;
      mean += 2 * mu * reflectionAlbedo(rough, mu).directional / n;
    }
    EXPECT_NEAR(reflectionAlbedo(rough, 0.5f).mean, mean, 1e-3);
  }
}

// White facets lose nothing, coloured ones are darker than their colour: multiplied more than once.
TEST(Energy, CompensatedReflectionIsWhole) {
  Random random(2);
  for (const float rough : {0.1f, 0.4f, 0.7f, 1.0f})
    for (const float mu : {0.1f, 0.5f, 1.0f}) {
      const auto albedo = [&](Rgb color) {
        Estimate e;
        addGlossy(4, Glossy::kMultiGgx, color, color, rough * rough, rough * rough, mu,
                  [&](const Lobe& l) { e = meanWeight(l, at(mu), random, 20000); });
        return e;
      };
      const Estimate white = albedo({1, 1, 1}), half = albedo({0.5f, 0.5f, 0.5f});
      EXPECT_NEAR(white.mean(), 1, 5 * white.error() + 4e-3) << rough << " " << mu;
      EXPECT_LT(half.mean(), 0.5 + 5 * half.error() + 2e-3);
      EXPECT_GT(half.mean(), 0.2);
    }
}

TEST(Energy, CompensatedGlassIsWhole) {
  Random random(3);
  for (const float rough : {0.2f, 0.6f, 1.0f})
    for (const float mu : {0.3f, 0.7f, 1.0f})
      for (const float eta : {1 / 1.5f, 1.2f, 1.5f}) {
        double sum = 0, error = 0;
        addGlass(4, Glossy::kMultiGgx, {1, 1, 1}, {1, 1, 1}, rough * rough, eta, mu, [&](const Lobe& l) {
          const Estimate e = meanWeight(l, at(mu), random, 20000);
          sum += e.mean(), error += e.error();
        });
        // from inside, light refracted to above counts in the tables, as in Cycles', but not in the lobe
        EXPECT_LT(sum, 1 + 5 * error + 0.02) << rough << " " << mu << " " << eta;
        EXPECT_GT(sum, (eta < 1 ? 0.8 : 0.98) - 5 * error) << rough << " " << mu << " " << eta;
      }
}

// The walk of Heitz, Hanika, d'Eon and Dachsbacher 2016 ("Multiple-scattering microfacet BSDFs with the Smith model"),
// which Cycles 3.4 takes, for a colour per reflection: the light that leaves, and its mean cosine.
struct Walk {
  Estimate albedo, cosine;
};
Walk walk(double alpha, double mu, double color, int n) {
  Random random(4);
  Walk result;
  const auto lambda = [&](Vec w) {
    const double t = std::sqrt(1 + alpha * alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z));
    return 0.5 * (w.z > 0 ? t - 1 : -t - 1);
  };
  for (int i = 0; i < n; ++i) {
    Vec w = -at(mu);
    double height = 1, weight = 1, left = 0;  // height as a share of the facets that lie lower
    for (int order = 0; order < 40; ++order) {
      const double l = lambda(w), u = random.uniform();
      if (w.z > 0 && u > 1 - std::pow(height, l)) {
        left = weight;
        break;
      }
      height = w.z > 0 ? std::min(1.0, height * std::pow(1 - u, -1 / l)) : height * std::pow(1 - u, -1 / l);
      w = mirrored(-w, sampleNormal<Distribution::kGgx>(-w, alpha, alpha, random.square()));
      weight *= color;
    }
    result.albedo.add(left);
    result.cosine.add(left > 0 ? left * w.z : 0);
  }
  return result;
}

// Compensation beside the walk: the same albedo of white facets, within 0.03 and the noise for grey ones; light that is
// reflected more than once leaves as light reflected once does, which is a mean cosine within 0.12 of the walk's.
TEST(Energy, IsThatOfTheWalkFromFacetToFacet) {
  Random random(5);
  double worst = 0, bent = 0;
  for (const double rough : {0.4, 0.7, 1.0})
    for (const double mu : {0.2, 0.6, 1.0})
      for (const float color : {1.0f, 0.7f, 0.3f}) {
        const Walk exact = walk(rough * rough, mu, color, 20000);
        addGlossy(3, Glossy::kMultiGgx, gray(color), gray(color), float(rough * rough), float(rough * rough), float(mu),
                  [&](const Lobe& l) {
                    Estimate albedo, cosine;
                    for (int i = 0; i < 20000; ++i) {
                      const Vec wi = drawn(l, at(mu), random);
                      const double w = weight(l, wi, at(mu)).x;
                      albedo.add(w), cosine.add(w * wi.z);
                    }
                    worst = std::max(worst, std::abs(albedo.mean() - exact.albedo.mean()));
                    bent = std::max(bent, std::abs(cosine.mean() - exact.cosine.mean()));
                    EXPECT_NEAR(albedo.mean(), exact.albedo.mean(),
                                5 * (albedo.error() + exact.albedo.error()) + (color == 1 ? 0.005 : 0.03))
                        << rough << " " << mu << " " << color;
                    EXPECT_NEAR(cosine.mean(), exact.cosine.mean(), 5 * (cosine.error() + exact.cosine.error()) + 0.12)
                        << rough << " " << mu << " " << color;
                  });
      }
  RecordProperty("albedo", std::to_string(worst));
  RecordProperty("cosine", std::to_string(bent));
  if (std::getenv("WARDMIS_SHOW")) std::printf("worst albedo %g, mean cosine %g\n", worst, bent);
}

}  // namespace
}  // namespace wardmis
