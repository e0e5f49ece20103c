// SPDX-License-Identifier: GPL-3.0-or-later
// Texture look-up, in the renderer's innermost loop: inline, without allocation, and defined for every uv, NaN
// included.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "scene/scene.h"

namespace wardmis {

// IEC 61966-2-1.
inline float srgbToLinear(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }
inline float linearToSrgb(float v) { return v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }

// Linear values of the 256 codes of an 8-bit image: [0] as they are, [1] sRGB.
inline const std::array<std::array<float, 256>, 2> kByteToLinear = [] {
  std::array<std::array<float, 256>, 2> table;
  for (int i = 0; i < 256; i++) {
    table[0][i] = static_cast<float>(i) / 255;
    table[1][i] = srgbToLinear(table[0][i]);
  }
  return table;
}();

// Alpha is the last of two or four channels; it is never sRGB.
inline bool isAlpha(const Image& image, int channel) {
  return image.channels % 2 == 0 && channel == image.channels - 1;
}

// The image's value at the texel of index `texel` (x + y width).
inline float texelScalar(const Image& image, size_t texel, int channel) {
  const size_t i = texel * image.channels + channel;
  if (image.bytes.empty()) return image.floats[i];
  return kByteToLinear[image.srgb && !isAlpha(image, channel)][image.bytes[i]];
}
inline Rgb texelRgb(const Image& image, size_t texel) {
  const size_t i = texel * image.channels;
  const size_t g = image.channels >= 3 ? 1 : 0, b = 2 * g;  // grey stands for all three
  if (image.bytes.empty()) return {image.floats[i], image.floats[i + g], image.floats[i + b]};
  const auto& table = kByteToLinear[image.srgb];
  return {table[image.bytes[i]], table[image.bytes[i + g]], table[image.bytes[i + b]]};
}

// Where a coordinate falls among n texels: the two neighbours and the weight of the second.
struct TexelPair {
  int i0, i1;
  float t;
};
inline TexelPair texelPair(float u, int n, Wrap wrap, bool nearest) {
  const auto floorOf = [](float v) {  // of |v| < 2^31; std::floor is a call without SSE 4.1
    const int i = static_cast<int>(v);
    return i - (v < static_cast<float>(i));
  };
  if (wrap != Wrap::kClamp) {
    u = std::fabs(u) < 1e9f ? u : 0;  // beyond 2^24 a float has no fraction anyway; NaN ends here
    if (wrap == Wrap::kRepeat)
      u -= static_cast<float>(floorOf(u));
    else
      u = std::fabs(u - 2 * static_cast<float>(floorOf(u * 0.5f + 0.5f)));
  }
  u = u >= 0 ? std::min(u, 1.0f) : 0;  // NaN: 0
  const float x = u * static_cast<float>(n) - (nearest ? 0 : 0.5f);
  const int i = floorOf(x);
  if (nearest) return {std::min(i, n - 1), std::min(i, n - 1), 0};
  const float t = x - static_cast<float>(i);
  if (wrap == Wrap::kRepeat) return {i < 0 ? n - 1 : i, i + 1 < n ? i + 1 : 0, t};
  return {std::max(i, 0), std::min(i + 1, n - 1), t};
}

// Bilinear or nearest look-up of texel(index), u to the right, v up, (0, 0) the bottom left corner.
template <class F>
auto lookUp(const Image& image, const Texture& texture, Vec2f uv, F texel) {
  const TexelPair x = texelPair(uv.x, image.width, texture.wrapU, texture.nearest);
  const TexelPair y = texelPair(uv.y, image.height, texture.wrapV, texture.nearest);
  const size_t row0 = size_t(y.i0) * image.width, row1 = size_t(y.i1) * image.width;
  if (texture.nearest) return texel(row0 + x.i0);
  return (texel(row0 + x.i0) * (1 - x.t) + texel(row0 + x.i1) * x.t) * (1 - y.t) +
         (texel(row1 + x.i0) * (1 - x.t) + texel(row1 + x.i1) * x.t) * y.t;
}
inline Rgb lookUpRgb(const Image& image, const Texture& texture, Vec2f uv) {
  return lookUp(image, texture, uv, [&](size_t i) { return texelRgb(image, i); });
}
inline float lookUpScalar(const Image& image, const Texture& texture, Vec2f uv, int channel) {
  return lookUp(image, texture, uv, [&](size_t i) { return texelScalar(image, i, channel); });
}

inline Vec2f transformed(const TextureUse& use, Vec2f uv) {
  const float* m = use.transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

// What a texture contributes at the surface's uv; 1 if there is none.
inline Rgb sampleRgb(const Scene& scene, const TextureUse& use, Vec2f uv) {
  if (use.texture < 0) return {1, 1, 1};
  const Texture& texture = scene.textures[use.texture];
  return lookUpRgb(scene.images[texture.image], texture, transformed(use, uv));
}
inline float sampleScalar(const Scene& scene, const TextureUse& use, Vec2f uv) {
  if (use.texture < 0) return 1;
  const Texture& texture = scene.textures[use.texture];
  return lookUpScalar(scene.images[texture.image], texture, transformed(use, uv), use.channel);
}

// A material's input at the surface's uv.
inline Rgb evaluate(const Scene& scene, const ColorInput& input, Vec2f uv) {
  return input.value * sampleRgb(scene, input.texture, uv);
}

// Ward's alpha, within what the format allows.
inline float clampedAlpha(float alpha) { return std::clamp(alpha, 1e-6f, 10.0f); }
inline float evaluateAlpha(const Scene& scene, const ScalarInput& input, Vec2f uv) {
  return clampedAlpha(input.value * sampleScalar(scene, input.texture, uv));
}

}  // namespace wardmis
