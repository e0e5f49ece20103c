// SPDX-License-Identifier: GPL-3.0-or-later
// Light on curves and spheres, and their own, against known values.
#include <gtest/gtest.h>

#include "scenes.h"

namespace wardmis {
namespace {

using namespace test;

void addStrands(Scene& scene, Form form, std::vector<Vec3f> points, float radius, int material) {
  MeshPart part;
  part.radii = Array<float>::of(std::vector<float>(points.size(), radius));
  part.uvs = Array<Vec2f>::of(std::vector<Vec2f>(points.size(), {0.5f, 0.5f}));
  std::vector<uint32_t> indices;
  for (uint32_t k = 0; k + (form == Form::kSpheres ? 0 : 1) < points.size(); ++k) indices.push_back(k);
  part.positions = Array<Vec3f>::of(std::move(points));
  part.primitives.push_back({material, Array<uint32_t>::of(std::move(indices)), form, 5});
  scene.meshes.push_back({"strands", {part}});
  Instance i;
  i.mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.instances.push_back(i);
}

// A white one under a constant sky is as bright as the sky: light comes from all of the hemisphere about its normal,
// and none is lost to itself.
TEST(Strands, WhiteFurnace) {
  for (const Form form : {Form::kRibbons, Form::kTubes, Form::kCones, Form::kSpheres}) {
    Scene scene;
    scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
    addStrands(scene, form, {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}}, 0.3f, 0);
    worldOf(scene).radiance = {1, 1, 1};
    lookFrom(scene, 0.5f, 1.2f, 24);
    RenderSettings s;
    s.spp = 16;
    s.threads = 2;
    Statistics statistics;
    const FilmBuffer film = renderScene(scene, s, &statistics);
    for (const Pixel& p : film.pixels) EXPECT_NEAR(luminance(film.mean(p)), 1, 5e-3f) << static_cast<int>(form);
  }
}

Material of(ClosureType type, float alpha, Rgb color = {1, 1, 1}) {
  Closure c;
  c.type = type;
  c.weight.value = {1, 1, 1};
  for (const ClosureInput& i : info(type).colors) c.colors.push_back({Rgb{1, 1, 1} * i.value, {}});
  for (const ClosureInput& i : info(type).scalars) c.scalars.push_back({i.value, {}});
  c.colors[0].value = color;
  for (size_t i = 0; i < (type == ClosureType::kGlossy ? 2u : 1u) && i < c.scalars.size(); ++i)
    c.scalars[i].value = alpha;
  Material m;
  m.closures = {c};
  m.transparent = mayBeTransparent(c);
  return m;
}

// What reflects or refracts shows the same of a sky on a ribbon as on a tube, also near its edges, where its own
// normal, which is the view's direction, is far from the rounded one.
TEST(Strands, RibbonsReflectAsTubesDo) {
  for (const ClosureType type : {ClosureType::kGlossy, ClosureType::kGlass})
    for (const float alpha : {0.0f, 0.3f}) {
      const auto mean = [&](Form form) {
        Scene scene;
        scene.materials = {of(type, alpha)};
        addStrands(scene, form, {{-9, 0, 0}, {0, 0, 0}, {9, 0, 0}}, 0.3f, 0);
        addCosineSky(scene, 64);
        lookFrom(scene, 0.5f, 0.299f, 16);
        RenderSettings s;
        s.spp = 256, s.threads = 2;
        return measure(renderScene(scene, s)).mean;
      };
      const double tube = mean(Form::kTubes);
      EXPECT_GT(tube, 0.01);
      EXPECT_NEAR(mean(Form::kRibbons) / tube, 1, 0.02) << static_cast<int>(type) << ' ' << alpha;
    }
}

// A curve that lets light through has a grey shadow, and where its inside is seen it is passed twice; not a sphere.
TEST(Strands, ShadowsOfTransparentCurvesAreGrey) {
  for (const Form form : {Form::kRibbons, Form::kTubes, Form::kCones, Form::kSpheres})
    for (const bool inside : {false, true}) {
      Scene scene = diffusePlane(4);
      scene.materials.push_back(of(ClosureType::kTransparent, 0, {0.8f, 0.5f, 0.2f}));
      addStrands(scene, form, {{-9, 0, 5}, {0, 0, 5}, {9, 0, 5}}, 1, 1);
      scene.meshes.back().parts[0].primitives[0].inside = inside && form != Form::kRibbons;
      scene.instances.back().visibility &= static_cast<uint8_t>(~kSeenByCamera);
      Light sun;
      sun.type = LightType::kSun;
      sun.emitted = {1, 1, 1};
      scene.lights = {sun};
      RenderSettings s;
      s.spp = 4, s.threads = 2, s.integrator = Integrator::kDirect;
      const FilmBuffer film = renderScene(scene, s);
      const Rgb c = film.mean(film.pixels[5]) * kPi<float>;
      const bool curve = form != Form::kSpheres;
      const float left = inside && curve && form != Form::kRibbons ? 0.25f : 0.5f;
      EXPECT_NEAR(c.x, curve ? left : 0.8f, 1e-4f) << static_cast<int>(form);
      EXPECT_NEAR(c.y, left, 1e-4f);
      EXPECT_NEAR(c.z, curve ? left : 0.2f, 1e-4f);
    }
}

// A ball of radius r and radiance 1 at height h lights what is right below it by r^2/h^2.
TEST(Strands, TheirOwnLightIsFound) {
  Scene scene = diffusePlane(16);
  Material shining;
  shining.emission.value = {1, 1, 1};
  scene.materials.push_back(shining);
  addStrands(scene, Form::kSpheres, {{0, 0, 2}}, 0.5f, 1);
  RenderSettings s;
  s.spp = 256;
  s.threads = 2;
  s.integrator = Integrator::kDirect;
  const Measured m = measure(renderScene(scene, s));
  EXPECT_GT(m.error, 0);
  EXPECT_NEAR(m.mean, 1.0 / 16, 4.5 * m.error);  // by chance once in 100 000
  EXPECT_LT(m.error, 0.001);
}

}  // namespace
}  // namespace wardmis
