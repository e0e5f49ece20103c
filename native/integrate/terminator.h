// SPDX-License-Identifier: GPL-3.0-or-later
// Shadows on smooth faces: near the edge of its own shadow a face of a smooth mesh is the flat one, and shades the
// surface that its normals tell of. As in Cycles (Shadow Terminator: Geometry Offset), light samples are then seen from
// where the smooth surface would be; rays of the surface's techniques leave the face.
#pragma once

#include <algorithm>
#include <cmath>

#include "world/geometry.h"

namespace wardmis {

// A point of a smooth triangle.
struct SmoothFace {
  float cutoff = 0;  // cosine of the light and a normal below which its light samples are moved; 0: never
  uint32_t shape = 0, triangle = 0;
  float u = 0, v = 0;  // weights of the second and third vertex

  // How far light samples are moved, of shadowOffset(). Cosines of the light: with the shading normal, and with the
  // face's on the same side of it.
  float amount(float shading, float face) const {
    if (!(cutoff > 0)) return 0;
    const float c = std::abs(shading), g = shading < 0 ? -face : face;
    return std::clamp(c < cutoff ? 2 - (g + c) / cutoff : 1 - g / cutoff, 0.0f, 1.0f);
  }
};

// From the point to the smooth surface over it, world space; side: the face's normal on the light's side of the shading
// normal. placement: where it is at the time.
Vec3f shadowOffset(const Geometry& geometry, const Placement& placement, const SmoothFace& face, Vec3f side,
                   float time);

}  // namespace wardmis
