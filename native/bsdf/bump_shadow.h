// SPDX-License-Identifier: GPL-3.0-or-later
// What is left of light at a normal that is not the surface's own (bump, normal map), so that none leaks round to the
// back and the terminator is soft: as Cycles 3.4 and 4.3 (3, 4), after Chiang et al. 2019, and 5.2 (5) have it.
#pragma once

#include <algorithm>
#include <cmath>

#include "bsdf/lobe.h"

namespace wardmis {

// Which lobes Cycles counts as diffuse there.
constexpr bool hasSoftTerminator(LobeKind kind) {
  return kind <= LobeKind::kRoughTranslucent || kind == LobeKind::kSchlickSheen || kind == LobeKind::kFibres;
}

struct BumpShadow {
  float bySurface, byLight;  // what is left of light that a sample of the lobe finds, or one of a light
  bool refused = false;      // since 5: there is nothing of the lobe there, nor of its density, but for its own samples
};

// Cosines: of the surface's own normal and the light, of both normals, of the lobe's normal and the light. What goes
// through the surface is darkened for light samples alone, as there.
inline BumpShadow bumpShadow(int version, LobeKind kind, float ownLight, float ownLobe, float lobeLight) {
  const bool soft = hasSoftTerminator(kind);
  if (kind == LobeKind::kVelvet && version < 5)  // whose own samples alone count as diffuse
    return {bumpShadow(version, LobeKind::kLambert, ownLight, ownLobe, lobeLight).bySurface, 1};
  const auto both = [&](float left) { return BumpShadow{lobeLight > 0 ? left : 1, left}; };
  if (version >= 5) {
    if (ownLight * ownLobe * lobeLight < 0) {
      BumpShadow none = soft ? both(0) : BumpShadow{1, 0};
      none.refused = true;
      return none;
    }
    const float light = std::abs(ownLight), turned = std::abs(ownLobe);
    if (!soft || light >= 1 || turned >= 1) return {1, 1};
    if (light < 1e-6f) return both(0);
    // masking of GGX facets as rough as the normal is turned
    const float alpha2 = std::clamp(0.125f * (1 / (turned * turned) - 1), 0.0f, 1.0f);
    return both(2 / (1 + std::sqrt(1 + alpha2 * (1 / (light * light) - 1))));
  }
  if (!soft) return {1, (ownLight < 0) != (lobeLight < 0) ? 0.0f : 1.0f};
  const float below = lobeLight * ownLobe, g = below != 0 ? ownLight / below : 0;
  if (g >= 1) return {1, 1};
  return both(g < 0 ? 0 : g * (1 + g * (1 - g)));
}

}  // namespace wardmis
