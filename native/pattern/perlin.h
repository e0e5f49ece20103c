// SPDX-License-Identifier: GPL-3.0-or-later
// Perlin's improved gradient noise (2002) in one to four dimensions, on a lattice without a period.
#pragma once

#include "pattern/hash.h"

namespace wardmis::pattern {

// The corner's gradient, one of a few chosen by the hash's low bits, times the way f from the corner.
template <int D>
constexpr float gradient(uint32_t hash, const Point<D>& f) {
  const auto signedBy = [hash](int bit, float x) { return (hash >> bit & 1) != 0 ? -x : x; };
  if constexpr (D == 1) {
    return signedBy(3, static_cast<float>(1 + (hash & 7))) * f[0];
  } else if constexpr (D == 2) {
    const bool low = (hash & 7) < 4;
    return signedBy(0, low ? f[0] : f[1]) + signedBy(1, 2 * (low ? f[1] : f[0]));
  } else if constexpr (D == 3) {
    const uint32_t h = hash & 15;
    const bool edge = (h == 12) | (h == 14);  // the twelve of the cube, four of them twice
    const float other = edge ? f[0] : f[2];
    return signedBy(0, h < 8 ? f[0] : f[1]) + signedBy(1, h < 4 ? f[1] : other);
  } else {
    const uint32_t h = hash & 31;
    return signedBy(0, h < 24 ? f[0] : f[1]) + signedBy(1, h < 16 ? f[1] : f[2]) + signedBy(2, h < 8 ? f[2] : f[3]);
  }
}

// Unscaled. Corner c of the cell lies one step along dimension d where bit D - 1 - d of c is set: the loop over corners
// vectorises, and each dimension's interpolation halves a contiguous array.
template <int D>
float perlin(const Point<D>& p) {
  constexpr int kCorners = 1 << D;
  std::array<uint32_t, D> cell;
  Point<D> f;
  for (int d = 0; d < D; d++) {
    const float whole = std::floor(p[d]);
    cell[d] = static_cast<uint32_t>(toInt(whole));
    f[d] = p[d] - whole;
  }
  float g[kCorners];
  for (int c = 0; c < kCorners; c++) {
    std::array<uint32_t, D> corner;
    Point<D> way;
    for (int d = 0; d < D; d++) {
      const int step = c >> (D - 1 - d) & 1;
      corner[d] = cell[d] + static_cast<uint32_t>(step);
      way[d] = f[d] - static_cast<float>(step);
    }
    g[c] = gradient(jenkins(corner), way);
  }
  for (int d = 0; d < D; d++) {
    const float t = f[d], fade = t * t * t * (t * (t * 6 - 15) + 10);
    const int half = kCorners >> (d + 1);
    for (int c = 0; c < half; c++) g[c] = (1 - fade) * g[c] + fade * g[c + half];
  }
  return g[0];
}

// Noise of mean 0 within about [-1, 1]. Up to Blender 4 it is 0 where floats end; from then on it repeats every 100000,
// and NaN gives NaN.
template <int D>
float signedNoise(Version version, Point<D> p) {
  constexpr float kScale[] = {0.25f, 0.6616f, 0.982f, 0.8344f};  // to [-1, 1], found by Open Shading Language's authors
  if (version == Version::kBlender3) {
    const float r = kScale[D - 1] * perlin(p);
    return std::isfinite(r) ? r : 0;
  }
  constexpr float kPeriod = 100000;
  for (int d = 0; d < D; d++) {
    float& x = p[d];
    if (std::abs(x) < kPeriod) continue;
    const float off = std::abs(x) >= 1000000 ? 0.5f : 0;  // such floats are integers, where the noise is 0
    // In three and four dimensions Blender 5 rounds the multiple of the period: of large numbers much is left.
    const bool rounded = D > 2 && version == Version::kBlender5;
    x = (rounded ? x - std::trunc(x / kPeriod) * kPeriod : std::fmod(x, kPeriod)) + off;
  }
  return kScale[D - 1] * perlin(p);
}

}  // namespace wardmis::pattern
