// SPDX-License-Identifier: GPL-3.0-or-later
// How far paths go, by kind of bounce and by lamp, where the image is known: in a closed sphere.
#include <gtest/gtest.h>

#include "integrate/path.h"
#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

constexpr float kAlbedo = 0.5f;

Scene inside(const Material& wall) {
  Scene scene;
  scene.materials = {wall};
  addSphere(scene, 48, 0);
  scene.meshes[0].parts[0].normals = {};
  lookFrom(scene, 0.3f, 0.2f, 16);
  scene.camera->toWorld.t = {0, 0, 0};
  return scene;
}
Scene diffuseInside() { return inside(ward({kAlbedo, kAlbedo, kAlbedo}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)); }

RenderSettings settings(int depth) {
  RenderSettings s;
  s.allocation = Allocation::kEqual;
  s.spp = 64, s.maxDepth = depth;
  return s;
}

bool same(const FilmBuffer& a, const FilmBuffer& b) {
  for (size_t i = 0; i < a.pixels.size(); ++i)
    if (luminance(a.mean(a.pixels[i])) != luminance(b.mean(b.pixels[i]))) return false;
  return a.pixels.size() == b.pixels.size();
}

// Roulette of a first hit's samples: those of half the mean worth and more go on as they are, of others as many as they
// are worth, for all.
TEST(Bounces, GoOnByTheirWorth) {
  for (const float worth : {0.01f, 0.1f, 0.249f, 0.25f, 1.0f, 3.0f}) {
    const int trials = 1 << 12;
    double sum = 0;
    int gone = 0;
    for (int k = 0; k < trials; ++k) {
      Continuation<3> c;
      c.weight = {worth, 0.5f * worth, 0}, c.scale = 2;
      if (!goesOn(c, 0.5f, (static_cast<float>(k) + 0.5f) / trials)) continue;
      ++gone;
      sum += double(c.weight.x);
      EXPECT_FLOAT_EQ(c.weight.y, 0.5f * c.weight.x);
      EXPECT_FLOAT_EQ(c.scale / 2, c.weight.x / worth);
    }
    EXPECT_NEAR(sum / trials, double(worth), 1e-3 * double(worth) + 1.0 / trials);
    EXPECT_NEAR(double(gone) / trials, std::min(1.0, 4 * double(worth)), 1.0 / trials);
  }
}

// Walls that glow by 1: 1 for the camera, and rho^i for what is reflected i times, B + 1 times at most.
TEST(Bounces, OfEachKindEndPathsOfThatKindAlone) {
  Scene diffuse = diffuseInside();
  diffuse.materials[0].emission.value = {1, 1, 1};
  Scene glossy = inside(ward({0, 0, 0}, {0.9f, 0.9f, 0.9f}, 0.3f, WardVariant::kWardGmd));
  glossy.materials[0].emission.value = {1, 1, 1};
  for (int bounces : {0, 1, 3}) {
    RenderSettings s = settings(8);
    s.maxDiffuse = bounces, s.maxGlossy = 1;
    double expected = 1;
    for (int i = 1; i <= bounces + 1; ++i) expected += std::pow(double(kAlbedo), i);
    EXPECT_NEAR(measure(renderScene(diffuse, s)).mean, expected, 2e-3 * expected) << bounces;
    EXPECT_TRUE(same(renderScene(diffuse, s), renderScene(diffuse, settings(bounces + 1)))) << bounces;

    s.maxDiffuse = 1, s.maxGlossy = bounces;
    EXPECT_TRUE(same(renderScene(glossy, s), renderScene(glossy, settings(bounces + 1)))) << bounces;
    EXPECT_FALSE(same(renderScene(glossy, s), renderScene(glossy, settings(bounces + 2)))) << bounces;
  }
}

// Both lobes on each wall: what one limit leaves the other does not take.
TEST(Bounces, AreCountedByWhatIsSampled) {
  Scene scene = inside(ward({0.3f, 0.3f, 0.3f}, {0.4f, 0.4f, 0.4f}, 0.4f, WardVariant::kWardGmd));
  scene.materials[0].emission.value = {1, 1, 1};
  const auto mean = [&](int diffuse, int glossy) {
    RenderSettings s = settings(6);
    s.maxDiffuse = diffuse, s.maxGlossy = glossy;
    return measure(renderScene(scene, s)).mean;
  };
  const double none = mean(0, 0), all = mean(9, 9), noDiffuse = mean(0, 9), noGlossy = mean(9, 0);
  EXPECT_LT(none, std::min(noDiffuse, noGlossy) - 0.05);
  EXPECT_GT(all, std::max(noDiffuse, noGlossy) + 0.05);
  // one bounce more, of either kind: the paths of the two kinds are disjoint
  EXPECT_NEAR(
      mean(1, 0) + mean(0, 1) - none,
      [&] {
        RenderSettings s = settings(2);
        return measure(renderScene(scene, s)).mean;
      }(),
      0.12);
  // no bounces at all are no path: the kernel without them
  RenderSettings s = settings(6);
  s.maxDiffuse = s.maxGlossy = 0;
  Statistics statistics;
  EXPECT_TRUE(same(renderScene(scene, s, &statistics), renderScene(scene, settings(1))));
  EXPECT_EQ(statistics.kernel & kNeedsBounces, 0u);
}

// A lamp with a limit is, where it is alone, the same as paths of that length; beside another, that one goes on.
TEST(Bounces, OfALamp) {
  Scene scene = diffuseInside();
  Light point;
  point.type = LightType::kPoint;
  point.emitted = {1, 1, 1};
  point.visibility = kSeenByAll & ~kSeenByCamera;
  Light ball = point, area = point, other = point;
  ball.radius = 0.2f, ball.facing = false;
  area.type = LightType::kArea, area.sizeX = area.sizeY = 0.5f;
  other.toWorld.t = {0, 0, 0.1f};
  for (const Light& kind : {point, ball, area})
    for (int bounces : {1, 3}) {
      Light limited = kind;
      limited.maxBounces = bounces;
      scene.lights = {limited};
      const FilmBuffer film = renderScene(scene, settings(6));
      scene.lights = {kind};
      EXPECT_TRUE(same(film, renderScene(scene, settings(bounces + 1))));
      EXPECT_FALSE(same(film, renderScene(scene, settings(6))));

      const double both = [&] {
        scene.lights = {limited, other};
        return measure(renderScene(scene, settings(6))).mean;
      }();
      scene.lights = {other};
      EXPECT_NEAR(both, measure(film).mean + measure(renderScene(scene, settings(6))).mean, 0.02 * both);
    }
  // irradiance 1/r^2, reflected once and up to three times
  const double rho = double(kAlbedo);
  for (const auto& [bounces, reflected] : {std::pair{0, rho}, {2, rho + rho * rho + rho * rho * rho}}) {
    point.maxBounces = bounces;
    scene.lights = {point};
    EXPECT_NEAR(measure(renderScene(scene, settings(6))).mean * kPi<double>, reflected, 0.01);
  }
}

}  // namespace
}  // namespace wardmis
