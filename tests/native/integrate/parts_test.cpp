// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of an image that are rendered apart add up to those rendered together, to the bit.
#include <gtest/gtest.h>

#include "film/part.h"
#include "integrate/setup.h"
#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

// Edges, an area lamp, a point and a sky; depth of field; a plane that catches shadows.
Scene mixed(bool catchers) {
  Scene scene;
  scene.materials = {ward({0.6f, 0.5f, 0.4f}, {0.2f, 0.2f, 0.2f}, 0.2f, WardVariant::kWardGmd),
                     ward({0, 0, 0}, {0.9f, 0.8f, 0.7f}, 0.05f, WardVariant::kWard)};
  addPlane(scene, 3, 0);
  addSphere(scene, 16, 1);
  worldOf(scene).radiance = {0.2f, 0.3f, 0.4f};
  Light area;
  area.type = LightType::kArea;
  area.sizeX = area.sizeY = 1;
  area.emitted = {9, 8, 7};
  area.toWorld.t = {1, 1, 3};
  Light point;
  point.emitted = {20, 20, 20};
  point.toWorld.t = {-2, 1, 2};
  scene.lights = {area, point};
  lookFrom(scene, 0.9f, 2, 13);
  scene.camera->lensRadius = 0.05f, scene.camera->focusDistance = 3;
  if (catchers) scene.instances[0].shadowCatcher = true;
  return scene;
}

bool same(const FilmBuffer& a, const FilmBuffer& b) {
  if (a.samples != b.samples) return false;
  const auto x = wordsOf(a), y = wordsOf(b);
  if (x.size() != y.size()) return false;
  for (size_t k = 0; k < x.size(); ++k)
    if (x[k].values != y[k].values) return false;
  return true;
}

FilmBuffer inParts(const BuiltScene& built, RenderSettings s, std::initializer_list<uint32_t> cuts, Counts& counts) {
  FilmBuffer whole;
  uint32_t from = 0;
  for (uint32_t to : cuts) {
    s.part = SampleRange{from, to};
    s.threads = s.threads == 1 ? 7 : 1;
    Statistics statistics;
    const FilmBuffer film = render(built, s, statistics);
    EXPECT_EQ(film.first, from);
    EXPECT_EQ(film.samples, to - from);
    if (from == 0)
      whole = film;
    else
      append(whole, film);
    for (size_t t = 0; t < kMaxTechniques; ++t)
      counts.samples[t] += statistics.counts.samples[t] - statistics.pilotCounts.samples[t];
    if (to == *(cuts.end() - 1) && !statistics.pilotKept) counts += statistics.pilotCounts;
    from = to;
  }
  return whole;
}

TEST(Parts, AddUpToTheWhole) {
  for (bool catchers : {false, true}) {
    const Scene scene = mixed(catchers);
    const BuiltScene built(scene, 1);
    for (Allocation allocation :
         {Allocation::kEqual, Allocation::kAuto, Allocation::kSecondMoment, Allocation::kAlbedo})
      for (SamplerType sampler : {SamplerType::kSobol, SamplerType::kStratified, SamplerType::kIndependent}) {
        RenderSettings s;
        s.allocation = allocation, s.sampler = sampler, s.spp = 19, s.seed = 5, s.threads = 2;
        s.data = s.light = true;
        Statistics statistics;
        const FilmBuffer whole = render(built, s, statistics);
        for (const std::initializer_list<uint32_t> cuts :
             {std::initializer_list<uint32_t>{19}, {1, 19}, {2, 3, 19}, {4, 19}, {7, 11, 18, 19}}) {
          Counts counts;
          EXPECT_TRUE(same(inParts(built, s, cuts, counts), whole))
              << name(allocation) << ' ' << name(sampler) << ' ' << *cuts.begin() << ' ' << catchers;
          EXPECT_EQ(counts.samples, statistics.counts.samples) << name(allocation);
        }
      }
  }
}

// Of sharp and joint integrands, of negative light, and where no path goes on.
TEST(Parts, OfOtherIntegrals) {
  Scene scene = mixed(false);
  scene.lights[1].emitted = {-5, 1, 1};
  scene.materials[1].alphaX.value = scene.materials[1].alphaY.value = 1e-4f;
  const BuiltScene built(scene, 1);
  for (Integrand integrand : {Integrand::kSplit, Integrand::kJoint})
    for (Integrator integrator : {Integrator::kDirect, Integrator::kPath}) {
      RenderSettings s;
      s.integrand = integrand, s.integrator = integrator, s.spp = 16, s.samplesPerHit = 5;
      Statistics statistics;
      const FilmBuffer whole = render(built, s, statistics);
      Counts counts;
      EXPECT_TRUE(same(inParts(built, s, {3, 16}, counts), whole)) << name(integrand) << ' ' << name(integrator);
    }
}

}  // namespace
}  // namespace wardmis
