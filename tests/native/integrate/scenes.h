// SPDX-License-Identifier: GPL-3.0-or-later
// Small scenes whose image is known, built in memory.
#pragma once

#include "integrate/render.h"
#include "math/number.h"

namespace wardmis::test {

inline Material ward(Rgb diffuse, Rgb specular, float alpha, WardVariant variant) {
  Material m;
  m.name = "ward";
  m.diffuse.value = diffuse;
  m.specular.value = specular;
  m.alphaX.value = m.alphaY.value = alpha;
  m.variant = variant;
  return m;
}

// With its parameters as they come.
inline Closure closure(ClosureType type, Rgb color = {1, 1, 1}, float weight = 1) {
  Closure c;
  c.type = type;
  if (type == ClosureType::kPrincipled3) c.version = 3;
  c.weight.value = {weight, weight, weight};
  for (const ClosureInput& i : info(type).colors) c.colors.push_back({{i.value, i.value, i.value}, {}});
  for (const ClosureInput& i : info(type).scalars) c.scalars.push_back({i.value, {}});
  if (!c.colors.empty()) c.colors[0].value = color;
  return c;
}

inline Closure with(Closure c, size_t scalar, float value) {
  c.scalars[scalar].value = value;
  return c;
}
inline Closure rough(Closure c, float alpha, Glossy distribution = Glossy::kMultiGgx) {
  c.scalars[0].value = alpha;
  if (c.type == ClosureType::kGlossy) c.scalars[1].value = alpha;
  c.distribution = distribution;
  return c;
}

inline Material material(std::vector<Closure> closures) {
  Material m;
  m.name = "lobes";
  m.closures = std::move(closures);
  m.transparent = std::any_of(m.closures.begin(), m.closures.end(), mayBeTransparent);
  return m;
}

inline void addMesh(Scene& scene, std::vector<Vec3f> positions, std::vector<uint32_t> indices, int material,
                    std::vector<Vec3f> normals = {}) {
  MeshPart part;
  part.positions = Array<Vec3f>::of(std::move(positions));
  if (!normals.empty()) part.normals = Array<Vec3f>::of(std::move(normals));
  part.primitives.push_back({material, Array<uint32_t>::of(std::move(indices))});
  scene.meshes.push_back({"mesh", {part}});
  Instance i;
  i.name = "object";
  i.mesh = static_cast<int>(scene.meshes.size()) - 1;
  scene.instances.push_back(i);
}

// A square of the given half size in the plane z = height, facing +z.
inline void addPlane(Scene& scene, float half, int material, float height = 0) {
  addMesh(scene, {{-half, -half, height}, {half, -half, height}, {half, half, height}, {-half, half, height}},
          {0, 1, 2, 0, 2, 3}, material);
}

// A unit sphere of triangles with exact normals.
inline void addSphere(Scene& scene, int rings, int material) {
  std::vector<Vec3f> p;
  std::vector<uint32_t> t;
  const int columns = 2 * rings;
  for (int r = 0; r <= rings; ++r)
    for (int c = 0; c <= columns; ++c) {
      const float theta = kPi<float> * static_cast<float>(r) / static_cast<float>(rings),
                  phi = 2 * kPi<float> * static_cast<float>(c) / static_cast<float>(columns);
      p.push_back({std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)});
    }
  for (int r = 0; r < rings; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto i = static_cast<uint32_t>(r * (columns + 1) + c), below = i + static_cast<uint32_t>(columns) + 1;
      if (r > 0) t.insert(t.end(), {i, below, i + 1});
      if (r < rings - 1) t.insert(t.end(), {i + 1, below, below + 1});
    }
  addMesh(scene, p, t, material, p);
}

// An orthographic camera that looks at the origin from the direction (sin theta, 0, cos theta), seeing 2 half x 2 half.
inline void lookFrom(Scene& scene, float theta, float half, int resolution) {
  Camera c;
  const Vec3f z{std::sin(theta), 0, std::cos(theta)}, x{0, 1, 0};
  c.toWorld = {x, cross(z, x), z, z * 50};
  c.projection = Projection::kOrthographic;
  c.left = c.bottom = -half;
  c.right = c.top = half;
  scene.camera = c;
  scene.film = {resolution, resolution, 0, 0, resolution, resolution, FilterType::kBox, 1, 1, false, false, 0.5f, {}};
}

// The scene's sky; there is one from the first call on.
inline World& worldOf(Scene& scene) {
  if (scene.worlds.empty()) scene.worlds.emplace_back();
  return scene.worlds[0];
}

// A sky that shows `image`, equirectangular, z up.
inline void addSky(Scene& scene, Image image) {
  scene.images.push_back(std::move(image));
  Texture t;
  t.image = 0;
  t.wrapV = Wrap::kClamp;
  scene.textures.push_back(t);
  worldOf(scene).radiance = {1, 1, 1};
  worldOf(scene).texture = 0;
  scene.zUp = false;  // the tests' frame is the image's
}

// A white diffuse plane, seen from half a radian off the vertical, a spot of it in all pixels.
inline Scene diffusePlane(int resolution) {
  Scene scene;
  scene.materials = {ward({1, 1, 1}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd)};
  addPlane(scene, 100, 0);
  lookFrom(scene, 0.5f, 0.005f, resolution);
  return scene;
}

// The sky L = R max(0, z) as an equirectangular image, z up.
inline void addCosineSky(Scene& scene, int height = 256) {
  Image image;
  image.width = 4, image.height = height, image.channels = 3;
  for (int y = 0; y < height; ++y) {
    const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);
    for (int i = 0; i < 12; ++i) image.floats.push_back(std::max(0.0f, -std::cos(kPi<float> * v)));
  }
  addSky(scene, std::move(image));
}

struct Measured {
  double mean = 0, error = 0;  // of the luminance over the image, and its standard error
};

// Mean over the image, with the error from the pixels' own variances (independent sampler) or from the spread of the
// pixels where all have the same expectation.
inline Measured measure(const FilmBuffer& film) {
  double sum = 0, square = 0;
  const auto n = static_cast<double>(film.pixels.size());
  for (const Pixel& p : film.pixels) {
    const double v = double(luminance(film.mean(p)));
    sum += v, square += v * v;
  }
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(0.0, square / n - mean * mean) / (n - 1))};
}

inline FilmBuffer renderScene(const Scene& scene, const RenderSettings& settings, Statistics* statistics = nullptr) {
  Statistics local;
  return render(scene, settings, statistics != nullptr ? *statistics : local);
}

}  // namespace wardmis::test
