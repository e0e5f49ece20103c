// SPDX-License-Identifier: GPL-3.0-or-later
// Programs in rendered scenes: against the same with constants, and against known values.
#include <gtest/gtest.h>

#include <string_view>

#include "program/programs.h"
#include "scenes.h"
#include "world/needs.h"

namespace wardmis {
namespace {

using namespace test;

RenderSettings settings(uint32_t spp, Integrator integrator = Integrator::kDirect) {
  RenderSettings s;
  s.spp = spp;
  s.integrator = integrator;
  s.threads = 2;
  return s;
}

TEST(ProgramRender, ConstantsAreTheSameToTheBit) {
  Scene scene;
  Material m = ward({0.25f, 0.5f, 0.125f}, {0.25f, 0.125f, 0.25f}, 0.25f, WardVariant::kWardGmd);
  m.alphaY.value = 0.125f;
  scene.materials = {m};
  addSphere(scene, 16, 0);
  addCosineSky(scene, 64);
  lookFrom(scene, 0.5f, 1.2f, 24);
  const FilmBuffer constants = renderScene(scene, settings(8, Integrator::kPath));
  setProgram(scene.materials[0],
             {{{"op", "vector"}, {"in", {0.5}}},
              {{"op", "vector-multiply"}, {"in", {{{"result", 0}}, {0.5, 1, 0.25}}}},
              {{"op", "mix"}, {"in", {0.5, {0.5, 0, 0.25}, {0, 0.25, 0.25}}}},
              {{"op", "x"}, {"in", {{{"result", 1}}}}},
              {{"op", "multiply"}, {"in", {{{"result", 3}}, 0.5}}}},
             {1, 2, 3, 4});
  Material& p = scene.materials[0];
  p.diffuse = {{1, 1, 1}, {}, 0};
  p.specular = {{1, 1, 1}, {}, 1};
  p.alphaX = {1, {}, 2};
  p.alphaY = {1, {}, 3};
  const FilmBuffer computed = renderScene(scene, settings(8, Integrator::kPath));
  for (size_t i = 0; i < constants.pixels.size(); ++i)
    EXPECT_EQ(constants.mean(constants.pixels[i]), computed.mean(computed.pixels[i])) << i;
}

// A plane that shines by its own position: every pixel holds the mean of its square: in world space in the frame
// of the scene, in object space as the mesh has it.
TEST(ProgramRender, EmissionByPosition) {
  for (const bool zUp : {false, true})
    for (const char* name : {"position", "object", "generated"}) {
      Scene scene;
      Material m = ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
      setProgram(m, {{{"op", name}}, {{"op", "vector-add"}, {"in", {{{"result", 0}}, {2, 2, 2}}}}}, {1});
      m.emission = {{1, 1, 1}, {}, 0};
      scene.materials = {m};
      addPlane(scene, 1, 0);
      scene.zUp = zUp;
      lookFrom(scene, 0, 1, 8);
      const FilmBuffer film = renderScene(scene, settings(256));
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
          // lookFrom's x axis is the world's y, its y axis the world's -x
          const float across = (static_cast<float>(x) + 0.5f) / 4 - 1, up = (static_cast<float>(y) + 0.5f) / 4 - 1;
          const Vec3f p{-up, across, 0};
          const bool turned = zUp && std::string_view(name) == "position";
          const Rgb expected = (turned ? Vec3f{p.x, -p.z, p.y} : p) + Vec3f{2, 2, 2};
          const Rgb found = film.mean(film.pixels[static_cast<size_t>(y * 8 + x)]);
          // 256 points of a stratified square of 1/4: 5 standard errors of independent ones are 0.023
          EXPECT_NEAR(found.x, expected.x, 0.023) << name << zUp << ' ' << x << ' ' << y;
          EXPECT_NEAR(found.y, expected.y, 0.023);
          EXPECT_NEAR(found.z, expected.z, 0.023);
        }
    }
}

// A floor under a square of which, by its program, only one half shines, is as bright as under that half alone. Each of
// the techniques finds the light: by light samples (few triangles, one of them nearly dark) and by cosine ones.
TEST(ProgramRender, EmissiveMeshesLightTheRest) {
  const auto brightness = [](bool programmed) {
    Scene scene;
    Material floor = ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
    Material light = ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
    light.emission.value = {2, 2, 2};
    if (programmed) {
      setProgram(light,
                 {{{"op", "position"}},
                  {{"op", "x"}, {"in", {{{"result", 0}}}}},
                  {{"op", "greater-than"}, {"in", {{{"result", 1}}, 0}}},
                  {{"op", "vector"}, {"in", {{{"result", 2}}}}}},
                 {3});
      light.emission.result = 0;
    }
    scene.materials = {floor, light};
    addPlane(scene, 0.05f, 0);
    const float left = programmed ? -1.0f : 0.0f;
    addMesh(scene, {{left, -1, 1}, {1, -1, 1}, {1, 1, 1}, {left, 1, 1}}, {0, 1, 2, 0, 2, 3}, 1);
    scene.instances[1].visibility &= static_cast<uint8_t>(~kSeenByCamera);
    lookFrom(scene, 0, 0.04f, 16);
    return measure(renderScene(scene, settings(256)));
  };
  const Measured by = brightness(true), alone = brightness(false);
  EXPECT_GT(alone.mean, 0.1);
  EXPECT_NEAR(by.mean, alone.mean, 4 * std::hypot(by.error, alone.error));  // fails by chance in 1 of 16000
  EXPECT_LT(by.error, 0.01 * alone.mean);
}

// Light that only the camera sees, and light that it does not see.
TEST(ProgramRender, LightPathTellsRaysApart) {
  for (const bool camera : {false, true}) {
    Scene scene;
    Material floor = ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
    Material light = ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
    json operations = {{{"op", "is-camera-ray"}}, {{"op", "subtract"}, {"in", {1, {{"result", 0}}}}}};
    operations.push_back({{"op", "vector"}, {"in", {{{"result", camera ? 0 : 1}}}}});
    setProgram(light, operations, {2});
    light.emission = {{3, 3, 3}, {}, 0};
    scene.materials = {floor, light};
    addPlane(scene, 1, 0);
    addMesh(scene, {{-1, 1, 0}, {1, 1, 0}, {1, 1, 2}, {-1, 1, 2}}, {0, 1, 2, 0, 2, 3}, 1);
    lookFrom(scene, 0, 0.9f, 8);
    const double onFloor = measure(renderScene(scene, settings(64))).mean;
    EXPECT_EQ(onFloor > 0.2, !camera);
    EXPECT_EQ(onFloor == 0, camera);
    // the wall itself
    Camera& c = *scene.camera;
    c.toWorld = {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}, {0, -50, 1}};
    EXPECT_EQ(measure(renderScene(scene, settings(8))).mean, camera ? 3 : 0);
  }
}

// A white plane that a sun from above makes as bright as 1.
Scene underASun() {
  Scene scene;
  scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  addPlane(scene, 1, 0);
  Light sun;
  sun.type = LightType::kSun;
  sun.emitted = {kPi<float>, kPi<float>, kPi<float>};
  sun.toWorld = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  scene.lights = {sun};
  lookFrom(scene, 0, 0.9f, 4);
  return scene;
}

// A normal of the program: a sun from above lights a plane as if it were tilted.
TEST(ProgramRender, NormalsTurnTheSurface) {
  Scene scene = underASun();
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, 1, 1e-5);
  setProgram(scene.materials[0], {{{"op", "normal-map-world"}, {"in", {{0.8, 0.5, 0.9}, 1}}}}, {0});
  scene.materials[0].normal = 0;
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, 0.8, 1e-5);
  // told in the axes with z up, in which the file's (x, y, z) is (x, -z, y); in both forms of a material
  scene.zUp = true;
  setProgram(scene.materials[0], {{{"op", "normal-map-world"}, {"in", {{0.8, 0.1, 0.5}, 1}}}}, {0});
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, 0.8, 1e-5);
  Closure diffuse;
  diffuse.colors = {{{1, 1, 1}, {}}}, diffuse.scalars = {{0, {}}}, diffuse.normal = 0;
  scene.materials[0].closures = {diffuse};
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, 0.8, 1e-5);
  // one of another length is the same, but to 3.4, which finds that it reflects the view into the surface, and turns it
  setProgram(scene.materials[0], {{{"op", "vector-add"}, {"in", {{0.3, -0.4, 0}, {0, 0, 0}}}}}, {0});
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, 0.8, 1e-5);
  scene.materials[0].closures[0].version = 3;
  EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, std::sqrt(0.5 * 1.01), 1e-4);
}

// A bent normal is that of every closure that has none of its own, and of what is computed after it, in both forms.
TEST(ProgramRender, NormalsAreBent) {
  Scene scene = underASun();
  scene.zUp = true;
  Material& m = scene.materials[0];
  const auto mean = [&] { return measure(renderScene(scene, settings(4))).mean; };
  const double turned = 0.8;
  EXPECT_NEAR(mean(), 1, 1e-5);
  setProgram(m, {{{"op", "bend"}, {"in", {{0, -0.8, 0.6}}}}}, {});
  EXPECT_NEAR(mean(), turned, 1e-5);
  Closure diffuse;
  diffuse.colors = {{{1, 1, 1}, {}}}, diffuse.scalars = {{0, {}}};
  m.closures = {diffuse};
  EXPECT_NEAR(mean(), turned, 1e-5);
  setProgram(m, {{{"op", "bend"}, {"in", {{0, -0.8, 0.6}}}}, {{"op", "normal"}}}, {1});
  m.closures[0].normal = 0;
  EXPECT_NEAR(mean(), turned, 1e-5);
}

// Of a closure that is there for shadow rays alone, and of one that is not: a sheet between a plane and a sun.
TEST(ProgramRender, ShadowRaysAreToldFromOthers) {
  for (const bool forShadows : {false, true}) {
    Scene scene;
    Material sheet;
    setProgram(sheet,
               {{{"op", "is-shadow-ray"}},
                {{"op", "subtract"}, {"in", {1, {{"result", 0}}}}},
                {{"op", "vector"}, {"in", {{{"result", forShadows ? 0 : 1}}}}}},
               {2});
    Closure window;
    window.type = ClosureType::kTransparent;
    window.colors = {{{1, 1, 1}, {}}}, window.weight.result = 0;
    sheet.closures = {window}, sheet.transparent = true;
    scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd), sheet};
    addPlane(scene, 1, 0);
    addPlane(scene, 1, 1, 1);
    Light sun;
    sun.type = LightType::kSun;
    sun.emitted = {kPi<float>, kPi<float>, kPi<float>};
    sun.toWorld = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
    scene.lights = {sun};
    lookFrom(scene, 0, 0.9f, 4);
    scene.camera->toWorld.t.z = 0.5f;  // below the sheet
    EXPECT_NEAR(measure(renderScene(scene, settings(4))).mean, forShadows ? 1 : 0, 1e-5);
  }
}

// Instances keep what is told of each.
TEST(ProgramRender, ObjectsHaveTheirOwnData) {
  Scene scene;
  Material m = ward({0, 0, 0}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd);
  setProgram(m,
             {{{"op", "object-color"}},
              {{"op", "attribute"}, {"name", "gain"}},
              {{"op", "vector-multiply"}, {"in", {{{"result", 0}}, {{"result", 1}}}}}},
             {2});
  m.emission = {{1, 1, 1}, {}, 0};
  scene.materials = {m};
  addPlane(scene, 0.5f, 0);
  scene.instances.push_back(scene.instances[0]);
  for (const float side : {-0.5f, 0.5f}) {
    auto data = std::make_shared<ObjectData>();
    data->color[0] = side < 0 ? 1.0f : 3.0f;
    data->attributes = {{"gain", {{side < 0 ? 2.0f : 4.0f}, 1}}};
    Instance& i = scene.instances[side < 0 ? 0 : 1];
    i.toWorld.t = {0, side, 0};
    i.object = data;
  }
  lookFrom(scene, 0, 0.5f, 2);
  const FilmBuffer film = renderScene(scene, settings(4));
  EXPECT_EQ(film.mean(film.pixels[0]).x, 2);
  EXPECT_EQ(film.mean(film.pixels[1]).x, 12);
  EXPECT_EQ(film.mean(film.pixels[1]).y, 4);
}

TEST(ProgramNeeds, AreTold) {
  Scene scene;
  scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  EXPECT_EQ(needs(scene.materials[0]) & kNeedsPrograms, 0u);
  setProgram(scene.materials[0], {{{"op", "position"}}}, {0});
  EXPECT_NE(needs(scene.materials[0]) & kNeedsPrograms, 0u);
  EXPECT_NE(describe(kNeedsPrograms), "nothing");
}

// A diffuse closure about a normal of its own is the diffuse surface: under a sky that is cos theta, 2/3 where the
// normal is the vertical.
TEST(ProgramRender, DiffuseClosuresAboutANormalOfTheirOwn) {
  Scene scene = diffusePlane(4);
  Closure c;
  c.type = ClosureType::kDiffuse, c.normal = 0;
  c.weight.value = {1, 1, 1};
  c.colors = {{{1, 1, 1}, {}}};
  c.scalars = {{0, {}}};
  Material m;
  setProgram(m, {{{"op", "vector-add"}, {"in", {{0, 0, 1}, {0, 0, 0}}}}}, {0});
  m.closures = {c};
  scene.materials = {m};
  addCosineSky(scene);
  RenderSettings s = settings(256);
  for (const Allocation a : {Allocation::kEqual, Allocation::kAuto}) {
    s.allocation = a;
    EXPECT_NEAR(measure(renderScene(scene, s)).mean, 2.0 / 3, 0.01);
  }
}

}  // namespace
}  // namespace wardmis
