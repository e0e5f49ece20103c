// SPDX-License-Identifier: GPL-3.0-or-later
// Texture look-up, in the renderer's innermost loop: inline, without allocation, and defined for every uv, NaN
// included.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "image/image.h"
#include "math/vec.h"

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

// sRGB to linear of any number, after filtering: a look-up in [0, 1], whose nodes hold the 256 codes exactly. There is
// nothing below 0, as in Cycles.
constexpr int kDecodeSteps = 255 * 16;
inline const std::array<float, kDecodeSteps + 2> kDecode = [] {
  std::array<float, kDecodeSteps + 2> table;
  for (int i = 0; i < kDecodeSteps + 2; i++) table[i] = srgbToLinear(static_cast<float>(i) / kDecodeSteps);
  return table;
}();
inline float decodeFiltered(float v) {
  if (!((v >= 0) & (v <= 1))) return v < 0 ? 0 : srgbToLinear(v);
  const float x = v * kDecodeSteps;
  const int i = static_cast<int>(x);
  return kDecode[i] + (x - static_cast<float>(i)) * (kDecode[i + 1] - kDecode[i]);
}

// The numbers at the texel of index `texel` (x + y width), from 8 bits by `table`.
inline float storedScalar(const Image& image, size_t texel, int channel, const std::array<float, 256>& table) {
  const size_t i = texel * image.channels + channel;
  return image.bytes.empty() ? image.floats[i] : table[image.bytes[i]];
}
inline Rgb storedRgb(const Image& image, size_t texel, const std::array<float, 256>& table) {
  const size_t i = texel * image.channels;
  const size_t g = image.channels >= 3 ? 1 : 0, b = 2 * g;  // grey stands for all three
  if (image.bytes.empty()) return {image.floats[i], image.floats[i + g], image.floats[i + b]};
  return {table[image.bytes[i]], table[image.bytes[i + g]], table[image.bytes[i + b]]};
}

// The image's linear value at a texel.
inline Rgb decodeFiltered(Rgb c) { return {decodeFiltered(c.x), decodeFiltered(c.y), decodeFiltered(c.z)}; }
inline Rgb texelRgb(const Image& image, size_t texel) {
  const bool floats = image.bytes.empty();
  const Rgb c = storedRgb(image, texel, kByteToLinear[image.srgb]);
  return floats && image.srgb ? decodeFiltered(c) : c;
}

// Where a coordinate falls among n texels: i, and the share t of the next one.
struct TexelFall {
  int i;
  float t;
};
inline TexelFall texelFall(float u, int n, Wrap wrap, bool nearest) {
  const auto floorOf = [](float v) {  // of |v| < 2^31; std::floor is a call without SSE 4.1
    const int i = static_cast<int>(v);
    return i - (v < static_cast<float>(i));
  };
  if (wrap == Wrap::kRepeat || wrap == Wrap::kMirror) {
    u = std::fabs(u) < 1e9f ? u : 0;  // beyond 2^24 a float has no fraction anyway; NaN ends here
    if (wrap == Wrap::kRepeat)
      u -= static_cast<float>(floorOf(u));
    else
      u = std::fabs(u - 2 * static_cast<float>(floorOf(u * 0.5f + 0.5f)));
  }
  // further out than any filter reaches, which is two texels, nothing changes any more
  const float outside = wrap == Wrap::kClip || wrap == Wrap::kClamp ? 4 : 0;
  u = u >= -outside ? std::min(u, 1 + outside) : -outside;  // NaN: as below
  const float x = u * static_cast<float>(n) - (nearest ? 0 : 0.5f);
  const int i = floorOf(x);
  if (nearest) return {u == 1 ? n - 1 : i, 0};  // u = 1 is the end of the last texel
  return {i, x - static_cast<float>(i)};
}

// The texel that stands for texel i, which may be up to two beyond the image; -1: none.
inline int wrappedTexel(int i, int n, Wrap wrap) {
  if ((i >= 0) & (i < n)) return i;
  switch (wrap) {
    case Wrap::kRepeat:
      return ((i % n) + n) % n;
    case Wrap::kMirror: {
      const int m = (i < 0 ? -1 - i : i) % (2 * n);
      return m < n ? m : 2 * n - 1 - m;
    }
    case Wrap::kClip:
      return -1;
    default:
      return std::clamp(i, 0, n - 1);
  }
}

// The weights of a cubic B-spline for the texels i - 1 to i + 2.
inline std::array<float, 4> cubicWeights(float t) {
  const float s = 1 - t;
  return {s * s * s / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + s * s * (3 * s - 6)) / 6, t * t * t / 6};
}

// Asks for the texels that a bilinear look-up at uv in [0, 1]^2 reads; the edges' own are left to it.
inline void prefetch(const Image& image, Vec2f uv) {
  const auto at = [](float u, int n) {
    return std::clamp(static_cast<int>(u * static_cast<float>(n) - 0.5f), 0, std::max(0, n - 2));
  };
  const size_t row = size_t(image.width) * image.channels;
  const size_t first = at(uv.y, image.height) * row + size_t(at(uv.x, image.width)) * image.channels;
  const auto ask = [&](const auto* texels) {
    const auto* next = texels + (image.height > 1 ? row : 0);
    const int last = std::min(2, image.width) * image.channels - 1;  // of the two texels side by side
    for (const auto* texel : {texels, texels + last, next, next + last}) fetch(texel);
  };
  if (image.bytes.empty())
    ask(&image.floats[first]);
  else
    ask(&image.bytes[first]);
}

// Filtered look-up of texel(index), u to the right, v up, (0, 0) the bottom left corner.
template <class F>
auto lookUp(const Image& image, const Texture& texture, Vec2f uv, F texel) {
  const bool nearest = texture.filter == Filter::kNearest;
  const TexelFall x = texelFall(uv.x, image.width, texture.wrapU, nearest);
  const TexelFall y = texelFall(uv.y, image.height, texture.wrapV, nearest);
  const auto column = [&](int i) { return wrappedTexel(i, image.width, texture.wrapU); };
  const auto row = [&](int i) { return wrappedTexel(i, image.height, texture.wrapV); };
  const auto at = [&](int i, int j) { return (i | j) < 0 ? decltype(texel(0)){} : texel(size_t(j) * image.width + i); };
  if (nearest) return at(column(x.i), row(y.i));
  if (texture.filter == Filter::kLinear) {
    const int i0 = column(x.i), i1 = column(x.i + 1), j0 = row(y.i), j1 = row(y.i + 1);
    return (at(i0, j0) * (1 - x.t) + at(i1, j0) * x.t) * (1 - y.t) + (at(i0, j1) * (1 - x.t) + at(i1, j1) * x.t) * y.t;
  }
  const std::array<float, 4> wx = cubicWeights(x.t), wy = cubicWeights(y.t);
  decltype(texel(0)) sum{};
  for (int j = 0; j < 4; j++)
    for (int i = 0; i < 4; i++) sum = sum + at(column(x.i + i - 1), row(y.i + j - 1)) * (wx[i] * wy[j]);
  return sum;
}
// Filtered as they are stored, 8 bits by `table`. Which storage it is is asked once, not for every texel.
inline Rgb lookUpStored(const Image& image, const Texture& texture, Vec2f uv, const std::array<float, 256>& table) {
  const size_t n = image.channels, g = n >= 3 ? 1 : 0, b = 2 * g;  // grey stands for all three
  if (image.bytes.empty())
    return lookUp(image, texture, uv, [=, t = image.floats.data()](size_t i) {
      return Rgb{t[i * n], t[i * n + g], t[i * n + b]};
    });
  return lookUp(image, texture, uv, [=, &table, t = image.bytes.data()](size_t i) {
    return Rgb{table[t[i * n]], table[t[i * n + g]], table[t[i * n + b]]};
  });
}
inline Rgb lookUpRgb(const Image& image, const Texture& texture, Vec2f uv) {
  const Rgb c = lookUpStored(image, texture, uv, kByteToLinear[image.srgb && !image.filterEncoded]);
  return image.filterEncoded ? decodeFiltered(c) : c;
}
inline float lookUpScalar(const Image& image, const Texture& texture, Vec2f uv, int channel) {
  const bool encoded = image.filterEncoded && !isAlpha(image, channel);
  const auto& table = kByteToLinear[image.srgb && !encoded && !isAlpha(image, channel)];
  const float v = lookUp(image, texture, uv, [&](size_t i) { return storedScalar(image, i, channel, table); });
  return encoded ? decodeFiltered(v) : v;
}

}  // namespace wardmis
