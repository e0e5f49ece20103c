// SPDX-License-Identifier: GPL-3.0-or-later
// Light that leaves a surface at an angle t to the normal, as if it were m t, so that the edge of the surface's own
// shadow comes nearer to the light: as Cycles has it (Shadow Terminator: Shading Offset).
#pragma once

#include <algorithm>
#include <cmath>

namespace wardmis {

// m, of an offset from 0 to 1.
inline float terminatorAngle(float offset) { return 1 / (1 - 0.5f * offset); }

// What is left of f cos t, of t's cosine, which is positive.
inline float leftAtTerminator(float m, float cosine) {
  return std::max(std::cos(std::acos(std::min(cosine, 1.0f)) * m), 0.0f) / cosine;
}

}  // namespace wardmis
