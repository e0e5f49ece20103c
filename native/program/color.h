// SPDX-License-Identifier: GPL-3.0-or-later
// Colours: HSV and HSL, the blends of Mix, corrections. As Cycles has them; not clamped where it does not clamp.
#pragma once

#include "program/arithmetic.h"

namespace wardmis::color {

// Of a colour whose largest part is `most`, spread over `span` > 0.
inline float hue(Rgb c, float most, float span) {
  const float h = c.x == most ? (c.y - c.z) / span : c.y == most ? 2 + (c.z - c.x) / span : 4 + (c.x - c.y) / span;
  return h < 0 ? h / 6 + 1 : h / 6;
}
inline Vec3f toHsv(Rgb c) {
  const float most = maxComponent(c), span = most - std::min({c.x, c.y, c.z});
  const float s = most != 0 ? span / most : 0;
  return {s != 0 ? hue(c, most, span) : 0, s, most};
}
inline Rgb fromHsv(Vec3f hsv) {
  const float s = hsv.y, v = hsv.z;
  if (s == 0) return {v, v, v};
  const float h = (hsv.x == 1 ? 0 : hsv.x) * 6, i = std::floor(h), f = h - i;
  const float p = v * (1 - s), q = v * (1 - s * f), t = v * (1 - s * (1 - f));
  if (i == 0) return {v, t, p};
  if (i == 1) return {q, v, p};
  if (i == 2) return {p, v, t};
  if (i == 3) return {p, q, v};
  if (i == 4) return {t, p, v};
  return {v, p, q};
}
inline Vec3f toHsl(Rgb c) {
  const float most = maxComponent(c), least = std::min({c.x, c.y, c.z}), span = most - least;
  const float l = std::min(1.0f, (most + least) / 2);
  if (span == 0) return {0, 0, l};
  return {hue(c, most, span), l > 0.5f ? span / (2 - most - least) : span / (most + least), l};
}
inline Rgb fromHsl(Vec3f hsl) {
  const float h = hsl.x * 6, chroma = (1 - std::abs(2 * hsl.z - 1)) * hsl.y;
  const Rgb c{std::abs(h - 3) - 1, 2 - std::abs(h - 2), 2 - std::abs(h - 4)};
  return each([&](float v) { return (arithmetic::saturate(v) - 0.5f) * chroma + hsl.z; }, c);
}

inline Rgb between(Rgb a, Rgb b, float t) { return a + (b - a) * t; }

inline float overlay(float t, float a, float b) {
  return a < 0.5f ? a * (1 - t + 2 * t * b) : 1 - (1 - t + 2 * t * (1 - b)) * (1 - a);
}
inline float dodge(float t, float a, float b) {
  if (a == 0) return 0;
  const float d = 1 - t * b;
  return d <= 0 ? 1 : std::min(a / d, 1.0f);
}
inline float burn(float t, float a, float b) {
  const float d = 1 - t + t * b;
  return d <= 0 ? 0 : arithmetic::saturate(1 - (1 - a) / d);
}
inline float softLight(float t, float a, float b) {
  return (1 - t) * a + t * ((1 - a) * b * a + a * (1 - (1 - b) * (1 - a)));
}

// a with the hue of b, and with its saturation too; as it is where b is grey.
inline Rgb withHue(float t, Rgb a, Rgb b, bool saturation) {
  const Vec3f of = toHsv(b);
  if (of.y == 0) return a;
  Vec3f hsv = toHsv(a);
  hsv.x = of.x;
  if (saturation) hsv.y = of.y;
  return between(a, fromHsv(hsv), t);
}
inline Rgb withSaturation(float t, Rgb a, Rgb b) {
  Vec3f hsv = toHsv(a);
  if (hsv.y == 0) return a;
  hsv.y = (1 - t) * hsv.y + t * toHsv(b).y;
  return fromHsv(hsv);
}
inline Rgb withValue(float t, Rgb a, Rgb b) {
  Vec3f hsv = toHsv(a);
  hsv.z = (1 - t) * hsv.z + t * toHsv(b).z;
  return fromHsv(hsv);
}

inline Rgb hueSaturation(float hueShift, float saturation, float value, float t, Rgb c, uint32_t version) {
  Vec3f hsv = toHsv(c);
  const float h = hsv.x + hueShift + 0.5f;
  hsv = {version >= 4 ? arithmetic::fraction(h) : std::fmod(h, 1.0f), arithmetic::saturate(hsv.y * saturation),
         hsv.z * value};
  const Rgb changed = fromHsv(hsv);
  return each([&](float a, float b) { return std::max(t * b + (1 - t) * a, 0.0f); }, c, changed);
}
inline Rgb brightContrast(Rgb c, float bright, float contrast) {
  const float a = 1 + contrast, b = bright - contrast * 0.5f;
  return each([&](float v) { return std::max(a * v + b, 0.0f); }, c);
}
inline Rgb gamma(Rgb c, float exponent) {
  if (exponent == 0) return {1, 1, 1};
  return each([&](float v) { return v > 0 ? std::pow(v, exponent) : v; }, c);
}
inline Rgb invert(float t, Rgb c) {
  return each([&](float v) { return t * (1 - v) + (1 - t) * v; }, c);
}

// A row of a table at t of [0, 1] over its rows: two of them and the share of the second.
struct Row {
  uint32_t first, second;
  float share;
};
inline Row row(float t, uint32_t rows, bool interpolate) {
  const float x = arithmetic::saturate(t) * static_cast<float>(rows - 1);
  const uint32_t i = x >= 0 ? std::min(static_cast<uint32_t>(x), rows - 1) : 0;  // NaN: 0
  const float share = x - static_cast<float>(i);
  return interpolate && share > 0 ? Row{i, i + 1, share} : Row{i, i, 0};
}
// One column of a table of rows of `stride` numbers; beyond its ends constant, or along its first or last step.
inline float lookUp(const float* table, uint32_t rows, uint32_t stride, float t, bool interpolate, bool extrapolate) {
  const auto at = [&](uint32_t i) { return table[i * stride]; };
  if (extrapolate && (t < 0 || t > 1)) {
    const float steps = static_cast<float>(rows - 1);
    return t < 0 ? at(0) - (at(0) - at(1)) * t * steps : at(rows - 1) + (at(rows - 1) - at(rows - 2)) * (t - 1) * steps;
  }
  const Row r = row(t, rows, interpolate);
  return r.share > 0 ? (1 - r.share) * at(r.first) + r.share * at(r.second) : at(r.first);
}

}  // namespace wardmis::color
