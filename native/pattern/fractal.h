// SPDX-License-Identifier: GPL-3.0-or-later
// Sums and products of octaves of noise (Ebert, Musgrave, Peachey, Perlin and Worley, "Texturing and Modeling", chapter
// 16): octave i has frequency lacunarity^i and amplitude roughness^i.
#pragma once

#include "pattern/perlin.h"

namespace wardmis::pattern {

enum class FractalType { kFbm, kMultifractal, kHybridMultifractal, kRidgedMultifractal, kHeteroTerrain };

struct Fractal {
  Version version = Version::kBlender5;
  FractalType type = FractalType::kFbm;
  int octaves = 1;  // whole ones
  float rest = 0;   // in [0, 1): the weight of one more; ridged multifractals have none
  float roughness = 0.5f, lacunarity = 2;
  bool normalize = false;      // kFbm: to [0, 1], where noise is in [-1, 1]
  float offset = 0, gain = 1;  // of the last three types, and of hybrid and ridged ones

  // `detail` octaves beyond the first.
  void setDetail(float detail) {
    octaves = toInt(detail) + 1;
    rest = detail - std::floor(detail);
  }
};

template <int D>
float fbm(const Fractal& a, const Point<D>& p) {
  // Far from the origin it matters how the octaves' points are rounded.
  const bool stepwise = a.version == Version::kBlender3;
  Point<D> q = p;
  float scale = 1, amplitude = 1, reach = 0, sum = 0;
  for (int i = 0; i < a.octaves; i++) {
    sum += signedNoise(a.version, q) * amplitude;
    reach += amplitude;
    amplitude *= a.roughness;
    scale *= a.lacunarity;
    q = stepwise ? q * a.lacunarity : p * scale;
  }
  const auto result = [&a](float s, float r) { return a.normalize ? 0.5f * s / r + 0.5f : s; };
  if (a.rest == 0) return result(sum, reach);
  const float more = sum + signedNoise(a.version, q) * amplitude;
  return lerp(result(sum, reach), result(more, reach + amplitude), a.rest);
}

template <int D>
float multifractal(const Fractal& a, Point<D> p) {
  float value = 1, amplitude = 1;
  for (int i = 0; i < a.octaves; i++) {
    value *= amplitude * signedNoise(a.version, p) + 1;
    amplitude *= a.roughness;
    p = p * a.lacunarity;
  }
  if (a.rest != 0) value *= a.rest * amplitude * signedNoise(a.version, p) + 1;
  return value;
}

template <int D>
float heteroTerrain(const Fractal& a, Point<D> p) {
  float value = a.offset + signedNoise(a.version, p), amplitude = a.roughness;
  p = p * a.lacunarity;
  const auto increment = [&] { return (signedNoise(a.version, p) + a.offset) * amplitude * value; };
  for (int i = 1; i < a.octaves; i++) {
    value += increment();
    amplitude *= a.roughness;
    p = p * a.lacunarity;
  }
  if (a.rest != 0) value += a.rest * increment();
  return value;
}

template <int D>
float hybridMultifractal(const Fractal& a, Point<D> p) {
  float value = 0, amplitude = 1, weight = 1;
  for (int i = 0; i < a.octaves && weight > 0.001f; i++) {
    weight = std::min(weight, 1.0f);
    const float signal = (signedNoise(a.version, p) + a.offset) * amplitude;
    value += weight * signal;
    weight *= a.gain * signal;
    amplitude *= a.roughness;
    p = p * a.lacunarity;
  }
  if (a.rest != 0 && weight > 0.001f) {
    value += a.rest * std::min(weight, 1.0f) * (signedNoise(a.version, p) + a.offset) * amplitude;
  }
  return value;
}

template <int D>
float ridgedMultifractal(const Fractal& a, Point<D> p) {
  const auto ridge = [&] {
    const float s = a.offset - std::abs(signedNoise(a.version, p));
    return s * s;
  };
  float signal = ridge(), value = signal, amplitude = a.roughness;
  for (int i = 1; i < a.octaves; i++) {
    p = p * a.lacunarity;
    const float weight = limit(signal * a.gain, 0, 1);
    signal = ridge() * weight;
    value += signal * amplitude;
    amplitude *= a.roughness;
  }
  return value;
}

template <int D>
float fractal(const Fractal& a, const Point<D>& p) {
  switch (a.type) {
    case FractalType::kFbm:
      return fbm(a, p);
    case FractalType::kMultifractal:
      return multifractal(a, p);
    case FractalType::kHybridMultifractal:
      return hybridMultifractal(a, p);
    case FractalType::kRidgedMultifractal:
      return ridgedMultifractal(a, p);
    case FractalType::kHeteroTerrain:
      return heteroTerrain(a, p);
  }
  return 0;
}

}  // namespace wardmis::pattern
