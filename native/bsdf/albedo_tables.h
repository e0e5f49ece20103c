// SPDX-License-Identifier: GPL-3.0-or-later
// Albedos of rough GGX surfaces over roughness (alpha is its square, fastest), cosine of the view and z = F0^(1/4),
// each from 0 to 1 in even steps; times 65535. Made by tools/albedo_tables.py.
#pragma once

#include <cstdint>

namespace wardmis::albedo {

inline constexpr int kFine = 32, kCoarse = 16;  // steps of the first two tables, and of the others

extern const uint16_t kReflection[kFine * kFine];  // facets that reflect all
extern const uint16_t kReflectionMean[kFine];      // its mean over the hemisphere, weighted by the cosine
// Dielectric facets, reflection and refraction together: for eta > 1, and the same from inside, eta < 1.
extern const uint16_t kGlass[kCoarse * kCoarse * kCoarse], kGlassMean[kCoarse * kCoarse];
extern const uint16_t kGlassInside[kCoarse * kCoarse * kCoarse], kGlassInsideMean[kCoarse * kCoarse];
// Mean of fresnelBlend() over the facets that reflect to above the surface.
extern const uint16_t kBlend[kCoarse * kCoarse * kCoarse];
// Of Schlick's (1 - cos)^5; without z.
extern const uint16_t kSchlick[kCoarse * kCoarse];

}  // namespace wardmis::albedo
