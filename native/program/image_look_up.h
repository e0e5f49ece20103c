// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes Image Texture and Environment Texture: where a vector falls on an image, and the colour and alpha there.
#pragma once

#include <span>

#include "image/texture.h"
#include "program/arithmetic.h"
#include "program/context.h"

namespace wardmis::images {

struct ColorAlpha {
  Rgb color{0, 0, 0};
  float alpha = 0;
};

// unassociate: the colour, as it was filtered, is divided by alpha before it is decoded.
inline ColorAlpha lookUp(const TextureAccess& access, uint32_t index, Vec2f uv, bool unassociate) {
  const Texture& texture = access.textures[index];
  const Image& image = access.images[texture.image];
  ColorAlpha r;
  if (image.channels % 2 == 0)
    r.alpha = lookUpScalar(image, texture, uv, image.channels - 1);
  else
    r.alpha = texture.wrapU == Wrap::kClip ? wardmis::lookUp(image, texture, uv, [](size_t) { return 1.0f; }) : 1;
  r.color = lookUpStored(image, texture, uv, kByteToLinear[image.srgb && !image.filterEncoded]);
  if (unassociate && r.alpha != 0 && r.alpha != 1) r.color = r.color / r.alpha;
  if (image.filterEncoded) r.color = decodeFiltered(r.color);
  return r;
}

// One image, or the tile of a UDIM image that uv falls on.
struct ImageUse {
  uint32_t texture = 0;
  std::span<const ProgramTile> tiles;
  bool unassociate = false;
  const uint32_t* textures = nullptr;  // the scene's index of each

  ColorAlpha at(const TextureAccess& access, Vec2f uv) const {
    if (tiles.empty()) return lookUp(access, textures[texture], uv, unassociate);
    const float column = std::trunc(uv.x), row = std::trunc(uv.y);  // as Cycles: the first tiles go on below 0
    constexpr ColorAlpha kMissing{{1, 0, 1}, 1};
    if (!(column >= 0 && column < 10 && row >= 0 && row < 1000)) return kMissing;
    const uint32_t number = 1001 + static_cast<uint32_t>(column) + 10 * static_cast<uint32_t>(row);
    const auto tile = std::lower_bound(tiles.begin(), tiles.end(), number,
                                       [](const ProgramTile& t, uint32_t n) { return t.number < n; });
    if (tile == tiles.end() || tile->number != number) return kMissing;
    return lookUp(access, textures[tile->texture], {uv.x - column, uv.y - row}, unassociate);
  }
};

enum Projection : uint32_t { kFlat, kSphere, kTube };
inline Vec2f projected(Vec3f p, uint32_t projection) {
  constexpr float kPif = kPi<float>;
  if (projection == kFlat) return {p.x, p.y};
  const Vec3f q{(p.x - 0.5f) * 2, (p.y - 0.5f) * 2, (p.z - 0.5f) * 2};
  if (projection == kSphere) {
    const float l = dot(q, q);
    if (!(l > 0)) return {0, 0};
    const float u = q.x == 0 && q.y == 0 ? 0 : 0.5f - std::atan2(q.x, q.y) / (2 * kPif);
    return {u, 1 - arithmetic::arcCosine(q.z / std::sqrt(l)) / kPif};
  }
  if (!(q.x * q.x + q.y * q.y > 0)) return {0, 0};
  return {(1 - std::atan2(q.x, q.y) / kPif) * 0.5f, (q.z + 1) * 0.5f};
}

// How much each of the three pairs of sides of a box counts for a normal n in its space. blend: 0, one of them; the
// sum of the parts' sizes being 1, they are a triangle's barycentric coordinates: one side holds its corners, two are
// mixed along its edges, all three in the middle.
inline Vec3f boxWeights(Vec3f n, float blend) {
  n = each([](float v) { return std::abs(v); }, n);
  n = n / (n.x + n.y + n.z);
  const float limit = 0.5f * (1 + blend);
  if (n.x > limit * (n.x + n.y) && n.x > limit * (n.x + n.z)) return {1, 0, 0};
  if (n.y > limit * (n.x + n.y) && n.y > limit * (n.y + n.z)) return {0, 1, 0};
  if (n.z > limit * (n.x + n.z) && n.z > limit * (n.y + n.z)) return {0, 0, 1};
  if (!(blend > 0)) return {1, 0, 0};  // on an edge
  const auto share = [&](float a, float b) { return arithmetic::saturate((a / (a + b) - 0.5f * (1 - blend)) / blend); };
  if (n.z < (1 - limit) * (n.y + n.x)) return {share(n.x, n.y), 1 - share(n.x, n.y), 0};
  if (n.x < (1 - limit) * (n.y + n.z)) return {0, share(n.y, n.z), 1 - share(n.y, n.z)};
  if (n.y < (1 - limit) * (n.x + n.z)) return {share(n.x, n.z), 0, 1 - share(n.x, n.z)};
  return each([&](float v) { return ((2 - limit) * v + (limit - 1)) / (2 * limit - 1); }, n);
}
inline ColorAlpha box(const TextureAccess& access, const ImageUse& use, Vec3f p, Vec3f n, float blend) {
  const Vec3f w = boxWeights(n, blend);
  ColorAlpha sum;
  const auto add = [&](float weight, Vec2f uv) {
    if (!(weight > 0)) return;
    const ColorAlpha c = use.at(access, uv);
    sum.color += c.color * weight;
    sum.alpha += c.alpha * weight;
  };
  add(w.x, {n.x < 0 ? 1 - p.y : p.y, p.z});  // so that no side shows a mirrored image
  add(w.y, {n.y > 0 ? 1 - p.x : p.x, p.z});
  add(w.z, {n.z > 0 ? 1 - p.y : p.y, p.x});
  return sum;
}

enum Environment : uint32_t { kEquirectangular, kMirrorBall };
inline Vec2f environmentPoint(Vec3f direction, uint32_t projection) {
  constexpr float kPif = kPi<float>;
  Vec3f d = safeNormalize(direction);
  if (projection == kEquirectangular) {
    if (isBlack(d)) return {0, 0};
    return {(std::atan2(d.y, d.x) - kPif) / (-2 * kPif), (arithmetic::arcCosine(d.z / length(d)) - kPif) / -kPif};
  }
  d.y -= 1;
  const float divisor = 2 * arithmetic::squareRoot(-0.5f * d.y);
  if (divisor > 0) d = d / divisor;
  return {0.5f * (d.x + 1), 0.5f * (d.z + 1)};
}

}  // namespace wardmis::images
