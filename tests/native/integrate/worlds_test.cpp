// SPDX-License-Identifier: GPL-3.0-or-later
// Skies for some kinds of ray alone: who sees them, what they light, how far along a path. The seeds are fixed; an
// image is allowed five of its standard errors, which for other seeds would fail once in 1.7 million images.
#include <gtest/gtest.h>

#include "integrate/setup.h"
#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

constexpr float kDiffuse = 0.5f;

RenderSettings settings(Integrand integrand, Integrator integrator, uint32_t spp = 256) {
  RenderSettings s;
  s.spp = spp;
  s.integrand = integrand;
  s.integrator = integrator;
  s.allocation = Allocation::kEqual;
  s.threads = 2;
  return s;
}

// A plane that reflects in both ways, under a sky, constant or as the cosine to the zenith.
Scene glossyPlane(bool image) {
  Scene scene;
  scene.materials = {ward({kDiffuse, kDiffuse, kDiffuse}, {0.4f, 0.4f, 0.4f}, 0.3f, WardVariant::kWardGmd)};
  addPlane(scene, 100, 0);
  lookFrom(scene, 0.5f, 0.005f, 16);
  if (image)
    addCosineSky(scene, 64);
  else
    worldOf(scene).radiance = {1, 1, 1};
  return scene;
}

struct Mode {
  Integrand integrand;
  Integrator integrator;
};
constexpr Mode kModes[] = {{Integrand::kSplit, Integrator::kDirect},
                           {Integrand::kJoint, Integrator::kDirect},
                           {Integrand::kJoint, Integrator::kPath}};

// Diffuse rays alone bring the diffuse part, whoever shares the samples; glossy ones bring the rest, the camera
// nothing.
TEST(Worlds, LightTheLobesThatSeeThem) {
  for (const bool image : {false, true})
    for (const Mode& mode : kModes) {
      const auto seenBy = [&](int visibility) {
        Scene scene = glossyPlane(image);
        worldOf(scene).visibility = static_cast<uint8_t>(visibility);
        return measure(renderScene(scene, settings(mode.integrand, mode.integrator)));
      };
      const Measured all = seenBy(kSeenByAll), diffuse = seenBy(kSeenByDiffuse), glossy = seenBy(kSeenByGlossy);
      const double want = double(kDiffuse) * (image ? 2 / 3.0 : 1);
      EXPECT_NEAR(diffuse.mean, want, 5 * diffuse.error + 1e-3 * want)
          << image << int(mode.integrand) << int(mode.integrator);
      EXPECT_NEAR(diffuse.mean + glossy.mean, all.mean, 5 * (all.error + diffuse.error + glossy.error) + 1e-4);
      EXPECT_GT(glossy.mean, 0.2 * want);
      EXPECT_LT(all.error + diffuse.error + glossy.error, 0.02 * want);
      EXPECT_EQ(seenBy(kSeenByCamera).mean, 0);
      EXPECT_EQ(seenBy(0).mean, 0);
    }
}

// The same of a lamp that surfaces meet.
TEST(Worlds, LampsLightTheLobesThatSeeThem) {
  for (const Mode& mode : kModes) {
    const auto seenBy = [&](int visibility) {
      Scene scene = glossyPlane(false);
      scene.worlds.clear();
      Light area;
      area.type = LightType::kArea;
      area.sizeX = area.sizeY = 8;
      area.toWorld.t = {0, 0, 2};
      area.visibility = static_cast<uint8_t>(visibility);
      scene.lights = {area};
      lookFrom(scene, 0.5f, 0.005f, 16);
      scene.camera->toWorld.t = scene.camera->toWorld.z * 1.5f;
      return measure(renderScene(scene, settings(mode.integrand, mode.integrator)));
    };
    const Measured all = seenBy(kSeenByAll), diffuse = seenBy(kSeenByDiffuse), glossy = seenBy(kSeenByGlossy);
    // of a square seen from below its middle: E = 4 a/sqrt(1 + a^2) atan(a/sqrt(1 + a^2)), a half side by distance
    const double a = 2, s = std::sqrt(1 + a * a);
    const double want = double(kDiffuse) / kPi<double> * 4 * a / s * std::atan(a / s);
    EXPECT_NEAR(diffuse.mean, want, 5 * diffuse.error + 1e-3 * want) << int(mode.integrand) << int(mode.integrator);
    EXPECT_NEAR(diffuse.mean + glossy.mean, all.mean, 5 * (all.error + diffuse.error + glossy.error) + 1e-4);
    EXPECT_GT(glossy.mean, 0.2 * want);
  }
}

// A sky for each kind of ray: the sum of what each brings.
TEST(Worlds, LieOverEachOther) {
  const auto of = [](float camera, float diffuse, float glossy, bool image) {
    Scene scene = glossyPlane(image);
    const World sky = worldOf(scene);
    scene.worlds.clear();
    for (const auto& [strength, visibility] :
         {std::pair{camera, kSeenByCamera}, {diffuse, kSeenByDiffuse}, {glossy, kSeenByGlossy}}) {
      World w = sky;
      w.radiance = w.radiance * strength;
      w.visibility = visibility;
      if (visibility == kSeenByCamera) w.texture = -1;
      scene.worlds.push_back(w);
    }
    return scene;
  };
  for (const bool image : {false, true}) {
    const auto mean = [&](float camera, float diffuse, float glossy) {
      return measure(renderScene(of(camera, diffuse, glossy, image), settings(Integrand::kSplit, Integrator::kDirect)));
    };
    const Measured sum = mean(7, 2, 3), diffuse = mean(0, 1, 0), glossy = mean(0, 0, 1);
    EXPECT_NEAR(sum.mean, 2 * diffuse.mean + 3 * glossy.mean, 5 * (sum.error + 2 * diffuse.error + 3 * glossy.error));
    // and beside the plane the camera's own
    Scene aside = of(7, 2, 3, image);
    aside.camera->toWorld.t.y = 1000;
    EXPECT_FLOAT_EQ(
        static_cast<float>(measure(renderScene(aside, settings(Integrand::kSplit, Integrator::kDirect, 4))).mean), 7);
  }
}

TEST(Worlds, HiddenFromTheCameraAreBlackThere) {
  Scene scene = glossyPlane(true);
  scene.camera->toWorld.t.y = 1000;
  worldOf(scene).visibility = kSeenBySurfaces;
  const FilmBuffer film = renderScene(scene, settings(Integrand::kSplit, Integrator::kDirect, 4));
  EXPECT_EQ(measure(film).mean, 0);
  EXPECT_EQ(film.pixels[0].alpha[0], 4);  // of a film that is not transparent
}

// What no surface sees is not aimed at, and asks for no rays.
TEST(Worlds, SeenByTheCameraAloneCostNothing) {
  Scene scene = glossyPlane(true);
  worldOf(scene).visibility = kSeenByCamera;
  const BuiltScene built(scene, 2);
  EXPECT_FALSE(built.emitters.any());
  EXPECT_FALSE(built.environments[0].sampled());
  Statistics statistics;
  renderScene(scene, settings(Integrand::kSplit, Integrator::kDirect, 4), &statistics);
  EXPECT_EQ(statistics.counts.allRays(), statistics.counts.cameraRays);
}

// A sky with a limit is, where it is alone, the same as paths of that length.
TEST(Worlds, LightAPathAsFarAsTheyMay) {
  for (const bool image : {false, true}) {
    Scene scene = glossyPlane(image);
    addSphere(scene, 24, 0);
    scene.instances.back().toWorld.t.z = 1;
    lookFrom(scene, 0.9f, 2, 16);
    const auto film = [&](int limit, int depth) {
      worldOf(scene).maxBounces = limit;
      RenderSettings s = settings(Integrand::kSplit, Integrator::kPath, 8);
      s.maxDepth = depth;
      return renderScene(scene, s);
    };
    for (const int bounces : {0, 1}) {
      const FilmBuffer limited = film(bounces, 5), same = film(1024, bounces + 1);
      for (size_t i = 0; i < limited.pixels.size(); ++i)
        EXPECT_NEAR(luminance(limited.mean(limited.pixels[i])), luminance(same.mean(same.pixels[i])), 1e-5f) << i;
      EXPECT_LT(measure(limited).mean, 0.98 * measure(film(1024, 5)).mean);
    }
  }
}

}  // namespace
}  // namespace wardmis
