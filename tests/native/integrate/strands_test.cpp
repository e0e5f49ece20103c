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
