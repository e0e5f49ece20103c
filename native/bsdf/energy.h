// SPDX-License-Identifier: GPL-3.0-or-later
// The light that a rough surface reflects more than once, as Cycles 4.x and 5.x give it back: the lobe of single
// reflections divided by its albedo for white facets, and darkened where facets are not white, by Kulla and Conty 2017
// ("Revisiting physically based shading at Imageworks"):
//   factor = 1 + F_ms (1 - E)/E,  F_ms = F_ss E_avg/(1 - F_ss (1 - E_avg)).
// It depends on the view alone, so it is part of a lobe's weight. Cycles 3.4 follows light from facet to facet instead;
// the factor has the same albedo for white facets and a similar one for others (tests/native/bsdf/energy_test.cpp).
#pragma once

#include "bsdf/albedo_tables.h"
#include "bsdf/dielectric.h"

namespace wardmis {

// A table with n steps an axis at coordinates in [0, 1], interpolated linearly; x runs fastest.
template <int N, int Axes, class Number>
inline float lookUp(const Number* table, std::array<float, Axes> at) {
  int index[Axes];
  float part[Axes];
  for (int k = 0; k < Axes; ++k) {
    const float v = std::clamp(at[k], 0.0f, 1.0f) * (N - 1);
    index[k] = std::min(static_cast<int>(v), N - 2);
    part[k] = v - static_cast<float>(index[k]);
  }
  float sum = 0;
  for (int corner = 0; corner < 1 << Axes; ++corner) {
    float w = 1;
    int offset = 0, stride = 1;
    for (int k = 0; k < Axes; ++k, stride *= N) {
      const int up = corner >> k & 1;
      w *= up ? part[k] : 1 - part[k];
      offset += (index[k] + up) * stride;
    }
    sum += w * static_cast<float>(table[offset]);
  }
  return sum * (1.0f / 65535);
}

// z of the tables: F0^(1/4), the same for eta and 1/eta.
inline float etaCoordinate(float eta) { return std::sqrt(std::abs((eta - 1) / (eta + 1))); }

struct Albedo {
  float directional, mean;
};
// Of facets that reflect all. roughness: sqrt(sqrt(ax ay)).
inline Albedo reflectionAlbedo(float roughness, float cosThetaO) {
  return {lookUp<albedo::kFine, 2>(albedo::kReflection, {roughness, cosThetaO}),
          lookUp<albedo::kFine, 1>(albedo::kReflectionMean, {roughness})};
}
inline Albedo glassAlbedo(float roughness, float cosThetaO, float eta) {
  const float z = etaCoordinate(eta);
  const bool inside = eta < 1;
  return {lookUp<albedo::kCoarse, 3>(inside ? albedo::kGlassInside : albedo::kGlass, {roughness, cosThetaO, z}),
          lookUp<albedo::kCoarse, 2>(inside ? albedo::kGlassInsideMean : albedo::kGlassMean, {roughness, z})};
}
// A reflectance that blends from F0 to white.
inline Rgb whitened(Rgb f0, float blend) { return f0 * (1 - blend) + Rgb{blend, blend, blend}; }
// Mean blend from F0 to white over the facets that a view sees.
inline float blendAlbedo(float roughness, float cosThetaO, float eta) {
  return lookUp<albedo::kCoarse, 3>(albedo::kBlend, {roughness, cosThetaO, etaCoordinate(eta)});
}
// The same of Schlick's blend.
inline float schlickAlbedo(float roughness, float cosThetaO) {
  return lookUp<albedo::kCoarse, 2>(albedo::kSchlick, {roughness, cosThetaO});
}

// How much darker the whole is than for white facets, and what the single reflections are divided by. fss: mean
// reflectance of a facet, or the tint of glass.
struct Compensation {
  Rgb darkening;
  float scale;
  Rgb factor() const { return darkening * scale; }
};
inline Compensation compensate(Albedo e, Rgb fss) {
  const float missing = (1 - e.directional) / e.directional, scale = 1 + missing;
  const auto channel = [&](float f) { return (1 + f * e.mean / (1 - f * (1 - e.mean)) * missing) / scale; };
  if (fss == Rgb{1, 1, 1}) return {{1, 1, 1}, scale};
  return {{channel(fss.x), channel(fss.y), channel(fss.z)}, scale};
}

// Mean of Fresnel's reflectance over the hemisphere: the fit of Kulla and Conty.
inline float fresnelMean(float eta) {
  return eta < 1 ? 0.997118f + eta * (0.1014f - eta * (0.965241f + eta * 0.130607f))
                 : (eta - 1) / (4.08567f + 1.00071f * eta);
}
// Of f0 blended to white as the dielectric goes from its own F0.
inline Rgb blendedMean(Rgb f0, float eta) {
  const float own = fresnelNormal(eta), s = std::clamp((fresnelMean(eta) - own) / (1 - own), 0.0f, 1.0f);
  return f0 * (1 - s) + Rgb{s, s, s};
}
// Of F82-tint.
inline Rgb f82Mean(Rgb f0, Rgb b) { return f0 * (20.0f / 21) + Rgb{1, 1, 1} * (1.0f / 21) - b * (1.0f / 126); }

}  // namespace wardmis
