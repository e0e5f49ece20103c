// SPDX-License-Identifier: GPL-3.0-or-later
// What a moving picture shows is known where it shows a thing for a known part of the time; and what is seen of holes
// and of first hits.
#include <gtest/gtest.h>

#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

RenderSettings settings(uint32_t spp) {
  RenderSettings s;
  s.spp = spp;
  s.integrator = Integrator::kDirect;
  s.threads = 2;
  return s;
}

Affine at(float x) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {x, 0, 0}}; }

// A shining square of side 2 that goes from x = -3 to 3, seen from above within |x|, |y| < 0.1: it is there for a third
// of the time.
Scene passing() {
  Scene scene;
  scene.materials = {ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  scene.materials[0].emission.value = {3, 3, 3};
  addPlane(scene, 1, 0);
  lookFrom(scene, 0, 0.1f, 4);
  scene.instances[0].motion = std::make_shared<const std::vector<Affine>>(std::vector<Affine>{at(-3), at(3)});
  scene.film.transparent = true;
  return scene;
}

TEST(MotionBlur, ShowsAThingForAsLongAsItIsThere) {
  const FilmBuffer film = renderScene(passing(), settings(1024));
  for (const Pixel& p : film.pixels) {
    EXPECT_NEAR(film.mean(p).x, 1, 0.02);  // Sobol's points: better than 1 in 100
    EXPECT_NEAR(p.alpha[0] / 1024, 1 / 3.0, 0.01);
  }
}

TEST(MotionBlur, OfWhatDeformsAndOfTheCameraIsTheSame) {
  Scene deforms = passing(), looks = passing();
  deforms.instances[0].motion = nullptr;
  MeshPart& part = deforms.meshes[0].parts[0];
  for (const float x : {-3.0f, 3.0f}) {
    std::vector<Vec3f> moved(part.positions.data.begin(), part.positions.data.end());
    for (Vec3f& v : moved) v.x += x;
    part.movedPositions.push_back(Array<Vec3f>::of(moved));
  }
  looks.instances[0].motion = nullptr;
  for (const float x : {3.0f, -3.0f}) {
    looks.camera->motion.push_back(looks.camera->toWorld);
    looks.camera->motion.back().t.x += x;
  }
  for (const Scene& scene : {deforms, looks}) {
    const FilmBuffer film = renderScene(scene, settings(1024));
    for (const Pixel& p : film.pixels) EXPECT_NEAR(film.mean(p).x, 1, 0.02);
  }
}

TEST(MotionBlur, FollowsTheShutter) {
  Scene scene = passing();
  scene.film.shutter.open = {0, 0, 1, 1, 0, 0};
  const FilmBuffer film = renderScene(scene, settings(1024));
  // from 0.2 on it opens, is open from 0.4 to 0.6, and shut at 0.8; what is not from 1/3 to 2/3 is lost
  const double whole = 0.4, lost = 2 * 0.5 * (2 / 15.0) * (2 / 15.0) / 0.2;
  for (const Pixel& p : film.pixels) EXPECT_NEAR(film.mean(p).x, 3 * (1 - lost / whole), 0.02);
}

// Light of a mesh that moves comes from where that is: as much as that of one that stands there in turn.
TEST(MotionBlur, LightComesFromWhereAMeshIs) {
  const auto below = [](float x) {
    Scene scene;
    scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd), Material{}};
    scene.materials[1].emission.value = {10, 10, 10};
    addPlane(scene, 8, 0);
    addPlane(scene, 0.5f, 1, 1.5f);
    scene.instances[1].toWorld.t.x = x;
    lookFrom(scene, 0.9f, 0.05f, 4);
    return scene;
  };
  double expected = 0;
  constexpr int kPlaces = 64;
  for (int i = 0; i < kPlaces; ++i)
    expected +=
        measure(renderScene(below(-2 + 4 * (static_cast<float>(i) + 0.5f) / kPlaces), settings(64))).mean / kPlaces;
  Scene scene = below(0);
  scene.instances[1].motion = std::make_shared<const std::vector<Affine>>(std::vector<Affine>{at(-2), at(2)});
  const Measured m = measure(renderScene(scene, settings(4096)));
  EXPECT_NEAR(m.mean, expected, 5 * m.error + 2e-3 * expected);
}

TEST(Holdout, IsAHoleForTheCameraAlone) {
  Scene scene = passing();
  scene.instances[0].motion = nullptr;
  scene.film.transparent = false;
  worldOf(scene).radiance = {1, 1, 1};
  EXPECT_GT(renderScene(scene, settings(4)).pixels[0].alpha[0], 3.9f);
  scene.instances[0].holdout = true;
  for (const Pixel& p : renderScene(scene, settings(4)).pixels) {
    EXPECT_EQ(p.alpha[0], 0);
    EXPECT_EQ(p.sum[0], 0);
    EXPECT_EQ(p.depth, 1e10f);
  }
}

TEST(DataPasses, AreOfWhatIsMetFirst) {
  Scene scene = passing();
  scene.instances[0].motion = nullptr;
  worldOf(scene).radiance = {0.5f, 0.5f, 0.5f};
  auto object = std::make_shared<ObjectData>();
  object->index = 7;
  scene.instances[0].object = object;
  scene.materials[0].index = 3;
  scene.meshes[0].parts[0].uvs = Array<Vec2f>::of({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  scene.camera->left = scene.camera->bottom = -2, scene.camera->right = scene.camera->top = 2;
  scene.film.exposure = 2;
  RenderSettings s = settings(4);
  EXPECT_TRUE(renderScene(scene, s).data.empty());
  s.data = true;
  const FilmBuffer film = renderScene(scene, s);
  ASSERT_EQ(film.data.size(), 16u);
  for (size_t i = 0; i < 16; ++i) {
    const bool on = i % 4 > 0 && i % 4 < 3 && i / 4 > 0 && i / 4 < 3;  // the square: the middle of the picture
    const DataPixel& d = film.data[i];
    EXPECT_EQ(d.objectIndex, on ? 7 : 0) << i;
    EXPECT_EQ(d.materialIndex, on ? 3 : 0);
    EXPECT_EQ(d.uv[2], on ? 4 : 0);
    EXPECT_NEAR(d.emission[0] / 4, on ? 6 : 0, 1e-6);
    EXPECT_NEAR(d.environment[1] / 4, on ? 0 : 1, 1e-6);
    EXPECT_NEAR(d.position.z, 0, 1e-6f);
    EXPECT_EQ(length(d.position) > 0, on);
  }
}

// What the passes of light are apart is the picture when it is put together again.
TEST(LightPasses, MakeUpThePicture) {
  Scene scene;
  scene.materials = {ward({0.5f, 0.4f, 0}, {0.2f, 0.3f, 0.4f}, 0.2f, WardVariant::kWardGmd), Material{}};
  scene.materials[1].emission.value = {2, 3, 4};
  addSphere(scene, 16, 0);
  addPlane(scene, 3, 0, -1);
  addPlane(scene, 0.5f, 1, 2);
  worldOf(scene).radiance = {0.5f, 0.6f, 0.7f};
  Light point;
  point.emitted = {5, 5, 5};
  point.toWorld.t = {2, 2, 3};
  scene.lights = {point};
  lookFrom(scene, 0.9f, 2, 8);
  scene.film.exposure = 1.5f;
  for (const Integrand integrand : {Integrand::kSplit, Integrand::kJoint})
    for (const bool lobes : {false, true}) {
      scene.materials[0].closures.clear();
      if (lobes) {
        Closure diffuse, glass;
        diffuse.colors = {ColorInput{{0.5f, 0.4f, 0}, {}}}, diffuse.scalars = {ScalarInput{0, {}}};
        glass.type = ClosureType::kGlass;
        glass.weight.value = {0.3f, 0.3f, 0.3f};
        glass.colors = {ColorInput{{1, 1, 1}, {}}}, glass.scalars = {ScalarInput{0.1f, {}}, ScalarInput{1.5f, {}}};
        scene.materials[0].closures = {diffuse, glass};
      }
      RenderSettings s = settings(16);
      s.integrator = Integrator::kPath, s.integrand = integrand, s.allocation = Allocation::kEqual;
      const FilmBuffer plain = renderScene(scene, s);
      s.data = s.light = true;
      const FilmBuffer film = renderScene(scene, s);
      for (size_t i = 0; i < film.pixels.size(); ++i) {
        EXPECT_EQ(film.pixels[i].sum, plain.pixels[i].sum);  // they are looked at, nothing more
        for (size_t c = 0; c < 3; ++c) {
          double sum = film.data[i].emission[c] + film.data[i].environment[c];
          for (size_t k = 0; k < kComponents; ++k) sum += film.light[i].direct[k][c] + film.light[i].indirect[k][c];
          EXPECT_NEAR(sum, film.pixels[i].sum[c], 1e-4 * (1 + sum)) << i << ' ' << lobes;
        }
      }
      double transmitted = 0;
      for (const LightPixel& p : film.light) transmitted += p.direct[2][0] + p.indirect[2][0];
      EXPECT_EQ(transmitted > 0, lobes);
    }
}

TEST(Holdout, OfAClosureIsAHoleByItsWeight) {
  Scene scene;
  scene.materials = {Material{}};
  Closure hole, diffuse;
  hole.type = ClosureType::kHoldout;
  hole.weight.value = {0.25f, 0.25f, 0.25f};
  diffuse.weight.value = {0.75f, 0.75f, 0.75f};
  diffuse.colors = {ColorInput{{0.8f, 0.8f, 0.8f}, {}}}, diffuse.scalars = {ScalarInput{0, {}}};
  scene.materials[0].closures = {hole, diffuse};
  addPlane(scene, 9, 0);
  worldOf(scene).radiance = {1, 1, 1};
  lookFrom(scene, 0.3f, 0.1f, 4);
  const FilmBuffer film = renderScene(scene, settings(256));
  for (const Pixel& p : film.pixels) {
    EXPECT_NEAR(p.alpha[0] / 256, 0.75f, 1e-5f);
    EXPECT_NEAR(film.mean(p).x, 0.6, 0.02);
  }
}

}  // namespace
}  // namespace wardmis
