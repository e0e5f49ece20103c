// SPDX-License-Identifier: GPL-3.0-or-later
// Principled as lobes: energy of the whole, the layers' order, and what each version makes of its inputs.
#include "bsdf/principled.h"

#include <gtest/gtest.h>

#include <vector>

#include "lobes.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;
using Vec = Vec3<double>;

std::vector<Lobe> lobesOf(const Principled& p, float mu) {
  std::vector<Lobe> all;
  expand(p, {1, 1, 1}, {mu, mu, mu, mu}, [&](const Lobe& l) { all.push_back(l); });
  return all;
}
std::vector<Lobe> lobesOf(const Principled3& p, float mu) {
  std::vector<Lobe> all;
  expand(p, {1, 1, 1}, mu, mu, [&](const Lobe& l) { all.push_back(l); });
  return all;
}
double albedoOf(const std::vector<Lobe>& lobes, double mu, Random& random, int n = 20000) {
  const Vec wo{std::sqrt(1 - mu * mu), 0, mu};
  double sum = 0;
  for (const Lobe& l : lobes) {
    Estimate e;
    for (int i = 0; i < n; ++i) e.add(weight(l, drawn(l, wo, random), wo).x);
    sum += e.mean();
  }
  return sum;
}
bool has(const std::vector<Lobe>& lobes, LobeKind kind) {
  return std::any_of(lobes.begin(), lobes.end(), [&](const Lobe& l) { return l.kind == kind; });
}

// White things in a white world are white, as far as Cycles' layers let them: 0.03 at views up to 84 degrees.
TEST(Principled, WhiteIsWhole) {
  Random random(1);
  for (const int version : {4, 5})
    for (const float mu : {0.1f, 0.5f, 1.0f})
      for (const float rough : {0.1f, 0.5f, 1.0f}) {
        Principled p;
        p.version = version, p.baseColor = {1, 1, 1}, p.roughness = rough;
        EXPECT_NEAR(albedoOf(lobesOf(p, mu), mu, random), 1, 0.03) << version << " " << mu << " " << rough;
        p.metallic = 1;
        EXPECT_NEAR(albedoOf(lobesOf(p, mu), mu, random), 1, 0.02) << version << " " << mu << " " << rough;
        p.metallic = 0, p.transmissionWeight = 1;
        EXPECT_NEAR(albedoOf(lobesOf(p, mu), mu, random), 1, 0.04) << version << " " << mu << " " << rough;
        p.transmissionWeight = 0, p.sheenWeight = 1, p.coatWeight = 0.5f;
        EXPECT_LT(albedoOf(lobesOf(p, mu), mu, random), 1.04) << version << " " << mu << " " << rough;
      }
}

TEST(Principled, ThinWallsLoseNothing) {
  Random random(2);
  for (const float mu : {0.2f, 0.6f, 1.0f}) {
    Principled p;
    p.version = 5, p.thinWall = true, p.baseColor = {1, 1, 1}, p.transmissionWeight = 1, p.roughness = 0.3f;
    EXPECT_NEAR(albedoOf(lobesOf(p, mu), mu, random), 1, 0.03);
    EXPECT_TRUE(has(lobesOf(p, mu), LobeKind::kThinTransmission));
    p.transmissionWeight = 0, p.subsurfaceWeight = 1, p.subsurfaceAnisotropy = 0.4f, p.specularIorLevel = 0;
    const std::vector<Lobe> lobes = lobesOf(p, mu);
    ASSERT_EQ(lobes.size(), 2u);
    EXPECT_NEAR(lobes[0].weight.x, 0.3, 1e-6);
    EXPECT_EQ(lobes[1].kind, LobeKind::kTranslucent);
    EXPECT_NEAR(lobes[1].weight.x, 0.7, 1e-6);
  }
}

TEST(Principled, LayersCoverThoseBelow) {
  Principled p;
  p.coatWeight = 1, p.coatTint = {0.5f, 1, 1};
  const float mu = 0.6f;
  Rgb emission = expand(p, {1, 1, 1}, {mu, mu, mu, mu}, [](const Lobe&) {});
  const float passes = 1 - fresnelDielectric(mu, 1.5f), depth = 1 / std::sqrt(1 - (1 - mu * mu) / 2.25f);
  EXPECT_NEAR(emission.y, passes, 1e-6);
  EXPECT_NEAR(emission.x, passes * std::pow(0.5f, depth), 1e-6);
  p.alpha = 0.25f;
  emission = expand(p, {1, 1, 1}, {mu, mu, mu, mu}, [](const Lobe&) {});
  EXPECT_NEAR(emission.y, 0.25f * passes, 1e-6);
  EXPECT_TRUE(has(lobesOf(p, mu), LobeKind::kTransparent));
  p.metallic = 1;  // nothing lies below metal
  for (const Lobe& l : lobesOf(p, mu))
    EXPECT_TRUE(l.kind != LobeKind::kLambert && !(l.fresnel == Fresnel::kBlended && l.frame == kBaseFrame));
}

TEST(Principled, SmoothLobesAreDeltas) {
  Principled p;
  p.roughness = 0, p.transmissionWeight = 1;
  EXPECT_TRUE(has(lobesOf(p, 0.5f), LobeKind::kMirror) && has(lobesOf(p, 0.5f), LobeKind::kSharpRefraction));
  Principled3 q;
  q.roughness = 0, q.transmission = 1;
  EXPECT_TRUE(has(lobesOf(q, 0.5f), LobeKind::kMirror) && has(lobesOf(q, 0.5f), LobeKind::kSharpRefraction));
}

TEST(Principled3, KeepsItsEnergyWhereItsLobesDo) {
  Random random(3);
  for (const float mu : {0.2f, 1.0f})
    for (const bool multiscatter : {false, true}) {
      Principled3 p;
      p.baseColor = {1, 1, 1}, p.metallic = 1, p.roughness = 0.6f, p.multiscatter = multiscatter;
      const double metal = albedoOf(lobesOf(p, mu), mu, random);
      EXPECT_NEAR(metal, multiscatter ? 1 : 0.87, multiscatter ? 0.01 : 0.12);
      p.metallic = 0, p.transmission = 1;
      EXPECT_LT(albedoOf(lobesOf(p, mu), mu, random), 1.02);
      EXPECT_GT(albedoOf(lobesOf(p, mu), mu, random), multiscatter ? 0.97 : 0.8);
    }
}

TEST(Principled3, SubsurfaceIsDiffuseOfItsColor) {
  Principled3 p;
  p.subsurface = 0.5f, p.baseColor = {1, 0, 0}, p.subsurfaceColor = {0, 1, 0}, p.specular = 0;
  const std::vector<Lobe> lobes = lobesOf(p, 0.5f);
  ASSERT_EQ(lobes.size(), 1u);
  EXPECT_EQ(lobes[0].kind, LobeKind::kLambert);
  EXPECT_EQ(lobes[0].weight, (Rgb{0.5f, 0.5f, 0}));
}

// Whatever the inputs: lobes are finite, not negative, and at most ten.
// Facets that are rough along one axis, of which 3.4 says that both together are smooth, send light along it.
TEST(Principled3, OfOneAxisIsNoMirror) {
  Principled3 p;
  p.metallic = 1, p.anisotropic = 1.2f;
  for (const bool multiscatter : {false, true}) {
    p.multiscatter = multiscatter;
    const std::vector<Lobe> lobes = lobesOf(p, 0.7f);
    ASSERT_EQ(lobes.size(), 1u);
    EXPECT_EQ(lobes[0].kind, LobeKind::kGgx);
    EXPECT_EQ(lobes[0].ax, 1);
    EXPECT_EQ(lobes[0].ay, 1e-4f);
    const Vec wo{0.6, 0, 0.8}, wi{-0.8, 0, 0.6};
    const LobeValue<double> v = evaluate(lobes[0], wi, wo);
    const double f = reflectance(lobes[0], 0.5 * length(wi + wo)).x;
    if (!multiscatter) {
      EXPECT_NEAR(v.fCos.x / (v.pdf * f), 1, 1e-6);
    }
  }
  p.roughness = 0.1f, p.anisotropic = 0;
  EXPECT_FALSE(has(lobesOf(p, 0.7f), LobeKind::kMirror));
  p.roughness = 0.01f;
  EXPECT_TRUE(has(lobesOf(p, 0.7f), LobeKind::kMirror));
}

// Of an index at which Cycles 3.4 divides 0 by 0.
TEST(Principled3, OfGlassWithoutAnIndexIsBlack) {
  Principled3 p;
  p.transmission = 0.5f, p.ior = -1;
  EXPECT_TRUE(lobesOf(p, 0.7f).empty());
  p.backfacing = true;
  EXPECT_FALSE(lobesOf(p, 0.7f).empty());
  p.backfacing = false, p.ior = 0.01f;
  EXPECT_FALSE(lobesOf(p, 0.7f).empty());
}

TEST(Principled, AnyInputsMakeLobes) {
  Random random(4);
  const auto v = [&](float high) {
    return random.uniform() < 0.2 ? (random.uniform() < 0.5 ? 0.0f : high) : float(random.uniform(0, high));
  };
  const auto c = [&] { return Rgb{v(1), v(1), v(1)}; };
  for (int i = 0; i < 20000; ++i) {
    Principled p;
    p.version = 4 + i % 2, p.baseColor = c(), p.metallic = v(1), p.roughness = v(1), p.ior = v(3), p.alpha = v(1);
    p.diffuseRoughness = v(1), p.subsurfaceWeight = v(1), p.subsurfaceAnisotropy = v(2) - 1, p.specularIorLevel = v(2);
    p.anisotropic = v(1), p.specularTint = c() * 2, p.transmissionWeight = v(1), p.coatWeight = v(2),
    p.coatRoughness = v(1);
    p.coatIor = v(3), p.coatTint = c(), p.sheenWeight = v(2), p.sheenRoughness = v(1), p.sheenTint = c();
    p.multiscatter = random.integer(0, 1) != 0, p.thinWall = random.integer(0, 3) == 0,
    p.backfacing = random.integer(0, 1) != 0;
    Principled3 q;
    q.baseColor = c(), q.subsurfaceColor = c(), q.subsurface = v(1), q.metallic = v(1), q.specular = v(2),
    q.specularTint = v(1);
    q.roughness = v(1), q.anisotropic = v(1), q.sheen = v(1), q.sheenTint = v(1), q.clearcoat = v(1),
    q.clearcoatRoughness = v(1);
    q.ior = v(3), q.transmission = v(1), q.transmissionRoughness = v(1), q.multiscatter = p.multiscatter,
    q.backfacing = p.backfacing;
    const float mu = std::max(v(1), 1e-4f);
    for (const std::vector<Lobe>& lobes : {lobesOf(p, mu), lobesOf(q, mu)}) {
      ASSERT_LE(lobes.size(), 10u);
      for (const Lobe& l : lobes) {
        ASSERT_TRUE(isFinite(l.weight) && std::min(l.weight.x, std::min(l.weight.y, l.weight.z)) >= 0)
            << testing::PrintToString(l);
        ASSERT_TRUE(isFinite(l.f0) && isFinite(l.edge) && std::isfinite(l.eta) && l.eta > 0 && l.ax >= 0 && l.ax <= 1)
            << testing::PrintToString(l);
        const Vec3f wo{std::sqrt(1 - mu * mu), 0, mu}, wi = drawn(l, wo, random);
        ASSERT_TRUE(isFinite(weight(l, wi, wo))) << testing::PrintToString(l);
      }
    }
  }
}

}  // namespace
}  // namespace wardmis
