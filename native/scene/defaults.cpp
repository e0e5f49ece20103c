// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/defaults.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace wardmis {
namespace {

using Vec3d = Vec3<double>;

struct Box {
  Vec3d lower{INFINITY, INFINITY, INFINITY}, upper{-INFINITY, -INFINITY, -INFINITY};

  void add(Vec3d p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  bool empty() const { return !(lower.x <= upper.x); }
  std::array<Vec3d, 8> corners() const {
    std::array<Vec3d, 8> out;
    for (size_t k = 0; k < 8; ++k)
      out[k] = {(k & 1) != 0 ? upper.x : lower.x, (k & 2) != 0 ? upper.y : lower.y, (k & 4) != 0 ? upper.z : lower.z};
    return out;
  }
};

Vec3d toDouble(Vec3f v) { return {v.x, v.y, v.z}; }
Vec3f toFloat(Vec3d v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

// Of all objects, in world space.
Box boundsOf(const Scene& scene) {
  std::vector<Box> ofMesh(scene.meshes.size());
  for (size_t m = 0; m < scene.meshes.size(); ++m)
    for (const MeshPart& part : scene.meshes[m].parts)
      for (const Primitive& primitive : part.primitives)
        for (const uint32_t i : primitive.indices.data) {
          if (primitive.form == Form::kTriangles) {
            ofMesh[m].add(toDouble(part.positions[i]));
            continue;
          }
          for (uint32_t k = i; k <= (primitive.form == Form::kSpheres ? i : i + 1); ++k) {
            const Vec3d p = toDouble(part.positions[k]);
            const double r = part.radii[k];
            ofMesh[m].add(p - Vec3d{r, r, r}), ofMesh[m].add(p + Vec3d{r, r, r});
          }
        }
  Box all;
  for (const Instance& instance : scene.instances) {
    const Affine& to = instance.toWorld;
    const Vec3d x = toDouble(to.x), y = toDouble(to.y), z = toDouble(to.z), t = toDouble(to.t);
    if (const Box& box = ofMesh[static_cast<size_t>(instance.mesh)]; !box.empty())
      for (const Vec3d c : box.corners()) all.add(x * c.x + y * c.y + z * c.z + t);
  }
  return all;
}

// From the front (glTF's +Z), a little from the right and above, as near as the film holds all of the box.
Camera viewOf(const Box& box, const Film& film) {
  constexpr double kAzimuth = 0.5, kElevation = 0.35, kHalf = 0.36, kMargin = 1.05;  // half: 50 mm on a film of 36 mm
  Camera camera;
  camera.name = "(fitted)";
  const double aspect = double(film.width) / film.height;
  const double right = kHalf * std::min(1.0, aspect), top = right / aspect;
  camera.right = static_cast<float>(right), camera.left = -camera.right;
  camera.top = static_cast<float>(top), camera.bottom = -camera.top;

  const Vec3d z{std::sin(kAzimuth) * std::cos(kElevation), std::sin(kElevation),
                std::cos(kAzimuth) * std::cos(kElevation)};
  const Vec3d x{std::cos(kAzimuth), 0, -std::sin(kAzimuth)};
  const Vec3d y = cross(z, x);
  const Vec3d center = (box.lower + box.upper) * 0.5;
  double distance = 0;
  for (const Vec3d corner : box.corners()) {
    const Vec3d c = corner - center;
    const double side = std::max(std::abs(dot(c, x)) / right, std::abs(dot(c, y)) / top);
    distance = std::max(distance, dot(c, z) + kMargin * side);
  }
  if (!(distance > 0)) distance = 1;  // of a single point
  camera.toWorld = {toFloat(x), toFloat(y), toFloat(z), toFloat(center + z * distance)};
  return camera;
}

bool hasLights(const Scene& scene) {
  return !scene.lights.empty() ||
         std::ranges::any_of(scene.worlds, [](const World& w) { return maxComponent(w.radiance) > 0; });
}

// What unlit materials show is no light of the scene's.
bool shines(const Scene& scene) {
  return std::ranges::any_of(scene.materials,
                             [](const Material& m) { return !m.unlit && maxComponent(m.emission.value) > 0; });
}

}  // namespace

void addDefaults(Scene& scene) {
  const bool isModel = !scene.camera;
  if (isModel) {
    Box box = boundsOf(scene);
    if (box.empty()) {
      box = {{-1, -1, -1}, {1, 1, 1}};
      scene.notes.emplace_back("the scene has nothing to render: the image shows its background alone");
    }
    scene.camera = viewOf(box, scene.film);
    scene.notes.emplace_back("the scene has no camera: a view of all that it holds is used (--no-defaults refuses it)");
  }
  if (scene.foreign && !hasLights(scene) && (isModel || !shines(scene))) {
    scene.worlds = {World{}};
    scene.worlds[0].radiance = {1, 1, 1};
    scene.notes.emplace_back("the scene has no lights: a constant sky of radiance 1 is used (--no-defaults adds none)");
  }
}

}  // namespace wardmis
