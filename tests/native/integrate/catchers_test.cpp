// SPDX-License-Identifier: GPL-3.0-or-later
// Shadow catchers, where what they catch is known.
#include <gtest/gtest.h>

#include "integrate/memory.h"
#include "scenes.h"

namespace wardmis::test {
namespace {

RenderSettings settings(uint32_t spp) {
  RenderSettings s;
  s.spp = spp;
  s.threads = 1;
  s.integrator = Integrator::kDirect;  // nothing by way of the roof
  return s;
}

FilmBuffer renderScene(const Scene& scene, const RenderSettings& s) {
  Statistics statistics;
  return render(scene, s, statistics);
}

Light sun(Vec3f to, float irradiance) {
  Light l;
  l.type = LightType::kSun;
  const Vec3f z = normalize(to), x = normalize(cross(Vec3f{0, 1, 0}, z));
  l.toWorld = {x, cross(z, x), z, {0, 0, 0}};
  l.emitted = {irradiance, irradiance, irradiance};
  return l;
}

// A catcher as large as the view, seen at a slant, under a sun; above it, out of the camera's view, there is room.
Scene catcher() {
  Scene scene;
  scene.materials = {ward({0.5f, 0.5f, 0.5f}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  addPlane(scene, 50, 0);
  scene.instances[0].shadowCatcher = true;
  lookFrom(scene, 0.7f, 1, 4);
  scene.film.transparent = true;
  scene.lights = {sun({0, 0, 1}, 2)};
  return scene;
}

// What the sun does not pass, over all that the camera sees.
void addRoof(Scene& scene) { addPlane(scene, 2, 0, 10); }

double meanAlpha(const FilmBuffer& film) {
  double sum = 0;
  for (size_t i = 0; i < film.pixels.size(); ++i) sum += double(film.combined(i)[3]) / double(film.pixels.size());
  return sum;
}

TEST(Catchers, WithoutShadowsAreNotThere) {
  Scene scene = catcher();
  worldOf(scene).radiance = {0.3f, 0.3f, 0.3f};
  const FilmBuffer film = renderScene(scene, settings(4));
  for (size_t i = 0; i < film.pixels.size(); ++i)
    for (const float v : film.combined(i)) EXPECT_EQ(v, 0);
}

TEST(Catchers, WholeShadowsAreBlack) {
  Scene scene = catcher();
  addRoof(scene);
  const FilmBuffer film = renderScene(scene, settings(4));
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    const auto c = film.combined(i);
    EXPECT_EQ(c[0], 0);
    EXPECT_EQ(c[3], 1);
  }
}

TEST(Catchers, HalfOfTheLightIsHalfAShadow) {
  Scene scene = catcher();
  addRoof(scene);
  scene.lights.push_back(sun({8, 0, 1}, 2 * std::sqrt(65.0f)));  // of the same irradiance on the plane, below the roof
  EXPECT_NEAR(meanAlpha(renderScene(scene, settings(256))), 0.5, 0.002);
}

TEST(Catchers, BeforeASkyDarkenIt) {
  Scene scene = catcher();
  addRoof(scene);
  scene.film.transparent = false;
  worldOf(scene).radiance = {0.25f, 0.5f, 1};
  scene.lights[0].emitted = {3, 3, 3};
  // the roof is small and far: of the sky's light pi L nearly all is there
  const FilmBuffer film = renderScene(scene, settings(4096));
  double lit = 0;
  for (const float l : {0.25f, 0.5f, 1.0f}) lit += double(l) * 3.14159265 / (double(l) * 3.14159265 + 3) / 3;
  for (const size_t i : {size_t{5}, size_t{6}}) {
    const auto c = film.combined(i);
    EXPECT_NEAR(double(c[0]), 0.25 * lit, 0.06 * lit * 0.25);
    EXPECT_NEAR(double(c[2]), lit, 0.06 * lit);
    EXPECT_EQ(c[3], 1);
  }
}

TEST(Catchers, ALampThatIsNotOnThemMakesNoShadows) {
  Scene scene = catcher();
  addRoof(scene);
  scene.lights[0].onCatchers = false;
  EXPECT_EQ(meanAlpha(renderScene(scene, settings(4))), 0);  // nothing is where they are alone
  scene.lights.push_back(sun({8, 0, 1}, 1));
  EXPECT_NEAR(meanAlpha(renderScene(scene, settings(256))), 0, 0.01);  // what passes the roof is all there is alone
}

TEST(Catchers, OtherRaysMeetThemAsAnythingElse) {
  Scene scene = catcher();
  addPlane(scene, 50, 0, -1);  // in their shadow
  lookFrom(scene, kPi<float>, 1, 2);
  scene.lights[0] = sun({0, 0, -1}, 1);
  scene.instances[1].shadowCatcher = false;
  scene.camera->toWorld.t = {0, 0, -50};
  const FilmBuffer film = renderScene(scene, settings(4));  // the plane below, from below, lit from below
  for (size_t i = 0; i < film.pixels.size(); ++i) EXPECT_EQ(film.combined(i)[3], 1);
}

TEST(Catchers, TheSameBitsForAnyThreadsAndPasses) {
  Scene scene = catcher();
  addRoof(scene);
  worldOf(scene).radiance = {0.3f, 0.3f, 0.3f};
  RenderSettings s = settings(16);
  const FilmBuffer one = renderScene(scene, s);
  s.threads = 3;
  const FilmBuffer three = renderScene(scene, s);
  for (size_t i = 0; i < one.pixels.size(); ++i) EXPECT_EQ(one.combined(i), three.combined(i));
}

TEST(Catchers, AreWithinTheMemoryThatIsAskedFor) {
  EXPECT_EQ(bytesPerPixel({}, 1, true), bytesPerPixel({}, 1) + sizeof(CatcherPixel));
}

}  // namespace
}  // namespace wardmis::test
