// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/doubles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "world/camera_ray.h"

namespace wardmis {

namespace {

// Whether another triangle lies where the ray meets one that shares its place, or a part of it.
bool isDouble(const BuiltScene& built, const Hit& hit) {
  const Placement placement = built.geometry.placements[hit.placement].at(kMiddle);
  const Corners c = Geometry::corners(placement, built.geometry.shapes[hit.shape], hit.triangle);
  const Vec3f ab = c[1] - c[0], ac = c[2] - c[0], normal = cross(ab, ac);
  const float size = length(normal);
  if (!(size > 0)) return false;
  Ray ray;
  ray.origin = c[0] + (ab * hit.u + ac * hit.v);
  const float reach = 0x1p-20f * (length(ray.origin) + std::sqrt(size));
  ray.origin = ray.origin - normal * (reach / size);
  ray.direction = normal / size;
  ray.tMin = 0, ray.tMax = 2 * reach;
  ray.path.time = kMiddle;
  ray.left = {hit.placement, hit.shape, hit.triangle};
  return built.accel.occluded(ray);
}

}  // namespace

std::string Doubles::told() const {
  return fmt::format(
      "{}: {:.0f} % of the picture shows faces that lie exactly in one place with others; which of them is seen, and "
      "how dark they are in their own shadow, is a matter of rounding, in Cycles, too, and differs; move them apart, "
      "or merge them",
      name.empty() ? "an object without a name" : fmt::format("object '{}'", name), std::ceil(100 * share));
}

Doubles visibleDoubles(const BuiltScene& built) {
  constexpr int kSide = 48;
  const Film& film = built.scene.film;
  if (!built.scene.camera) return {};
  const CameraRays camera(*built.scene.camera, film);
  std::map<const std::string*, int> seen;
  int all = 0;
  for (int i = 0; i < kSide * kSide; ++i) {
    // off the middle, where faces meet that are divided evenly
    const auto at = [&](int from, int to, int k, float within) {
      return static_cast<float>(from) + static_cast<float>(to - from) * (static_cast<float>(k) + within) / kSide;
    };
    const Ray ray =
        camera.ray(at(film.x0, film.x1, i % kSide, 0.37f), at(film.y0, film.y1, i / kSide, 0.61f), {0.5f, 0.5f});
    if (!(ray.tMax > 0)) continue;
    const Hit hit = built.accel.intersect(ray);
    if (!hit.valid() || !hit.shared || !isDouble(built, hit)) continue;
    ++all;
    ++seen[built.geometry.placements[hit.placement].name];
  }
  const auto most =
      std::max_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return {static_cast<float>(all) / (kSide * kSide),
          most != seen.end() && most->first != nullptr ? *most->first : std::string()};
}

}  // namespace wardmis
