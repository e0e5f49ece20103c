// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/triangle_luminance.h"

#include <algorithm>
#include <cmath>

#include "scene/inputs.h"
#include "world/shading.h"

namespace wardmis {
namespace {

constexpr float kMostDivisions = 16;

}  // namespace

double TriangleLuminance::of(const Placement& p, const Shape& s, uint32_t triangle) {
  const ColorInput& e = scene_.materials[static_cast<size_t>(s.material)].emission;
  if (e.result >= 0) return ofProgram(p, s, triangle);
  if (e.texture.texture < 0 || s.part->uvs.empty()) return double(strength(e.value));
  const uint32_t* i = s.indices + 3 * size_t{triangle};
  const Vec2f a = s.part->uvs[i[0]], b = s.part->uvs[i[1]], c = s.part->uvs[i[2]];
  const int n = divisions(e.texture, a, b, c);
  const auto at = [&](float u, float v) {
    const float w = 1 - u - v;
    const Vec2f uv{w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y};
    return double(strength(e.value * sampleRgb(scene_, e.texture, uv)));
  };
  double sum = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n - y; ++x) {  // the middles of the n^2 triangles that it divides into
      const float u = static_cast<float>(x), v = static_cast<float>(y), size = 1 / static_cast<float>(n);
      sum += at((u + 1 / 3.f) * size, (v + 1 / 3.f) * size);
      if (x < n - y - 1) sum += at((u + 2 / 3.f) * size, (v + 2 / 3.f) * size);
    }
  constexpr double kLeast = 0.02;
  return std::max(sum / (n * n), kLeast * mean(e));
}

// The mean over a few points, each seen from before it. What shines between them must be aimed at too: never less than
// a share of what the most shining point of the mesh so far has, or else of the constant factor.
double TriangleLuminance::ofProgram(const Placement& p, const Shape& s, uint32_t triangle) {
  constexpr float kPoints[][2] = {{1 / 3.f, 1 / 3.f}, {1 / 6.f, 1 / 6.f}, {2 / 3.f, 1 / 6.f}, {1 / 6.f, 2 / 3.f}};
  constexpr double kLeast = 0.02;
  const auto corner = [&](int k) {
    const Vec3f v = s.positions[s.indices[3 * size_t{triangle} + static_cast<size_t>(k)]];
    return p.flat ? v : p.toWorld.point(v);
  };
  const Vec3f a = corner(0), ab = corner(1) - a, ac = corner(2) - a, n = cross(ab, ac);
  const float size = std::sqrt(length(n));
  double sum = 0;
  for (const auto& q : kPoints) {
    const Vec3f before = a + ab * q[0] + ac * q[1] + (size > 0 ? n / size : n);
    const double here = double(strength(emissionAt(scene_, p, s, triangle, q[0], q[1], before, 0)));
    if (std::isfinite(here)) sum += here;
  }
  const double mean = sum / double(std::size(kPoints));
  double& most = most_.try_emplace(&s, 0).first->second;
  most = std::max(most, mean);
  const double factor = double(strength(scene_.materials[static_cast<size_t>(s.material)].emission.value));
  return std::max(mean, kLeast * (most > 0 ? most : factor));
}

const Image& TriangleLuminance::image(int texture) const {
  return scene_.images[static_cast<size_t>(scene_.textures[static_cast<size_t>(texture)].image)];
}

int TriangleLuminance::divisions(const TextureUse& use, Vec2f a, Vec2f b, Vec2f c) const {
  const Image& texels = image(use.texture);
  a = transformed(use, a), b = transformed(use, b), c = transformed(use, c);
  const float area = 0.5f * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
  const float covered = area * static_cast<float>(texels.width) * static_cast<float>(texels.height);
  return covered > 1 ? static_cast<int>(std::ceil(std::min(std::sqrt(covered), kMostDivisions))) : 1;
}

double TriangleLuminance::mean(const ColorInput& e) {
  double& known = means_[static_cast<size_t>(e.texture.texture)];
  if (known < 0) {
    const Image& texels = image(e.texture.texture);
    const size_t count = static_cast<size_t>(texels.width) * static_cast<size_t>(texels.height);
    known = 0;
    for (size_t i = 0; i < count; ++i) known += double(strength(texelRgb(texels, i)));
    known /= static_cast<double>(count);
  }
  return known * double(strength(e.value));
}

}  // namespace wardmis
