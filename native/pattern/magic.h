// SPDX-License-Identifier: GPL-3.0-or-later
// The node Magic Texture: sines and cosines fed into each other.
#pragma once

#include "math/number.h"
#include "pattern/point.h"

namespace wardmis::pattern {

// depth: 0 to 10 steps. Each component in about [0, 1]; the node's factor is their mean.
inline Rgb magic(Version version, int depth, float scale, float distortion, Vec3f p) {
  // From Blender 5 on the scale comes before the period, not after it.
  const float before = version == Version::kBlender5 ? scale : 1, after = version == Version::kBlender5 ? 5 : 5 * scale;
  const auto wrap = [before](float x) { return std::fmod(x * before, 2 * kPi<float>); };
  const float px = wrap(p.x), py = wrap(p.y), pz = wrap(p.z);
  float x = std::sin((px + py + pz) * after);
  float y = std::cos((-px + py - pz) * after);
  float z = -std::cos((-px - py + pz) * after);
  if (depth > 0) {
    x *= distortion;
    y *= distortion;
    z *= distortion;
    y = -std::cos(x - y + z) * distortion;
  }
  if (depth > 1) x = std::cos(x - y - z) * distortion;
  if (depth > 2) z = std::sin(-x - y - z) * distortion;
  if (depth > 3) x = -std::cos(-x + y - z) * distortion;
  if (depth > 4) y = -std::sin(-x + y + z) * distortion;
  if (depth > 5) y = -std::cos(-x + y + z) * distortion;
  if (depth > 6) x = std::cos(x + y + z) * distortion;
  if (depth > 7) z = std::sin(x + y - z) * distortion;
  if (depth > 8) x = -std::cos(-x - y + z) * distortion;
  if (depth > 9) y = -std::sin(x - y + z) * distortion;
  const float full = distortion != 0 ? 2 * distortion : 1;
  return {0.5f - x / full, 0.5f - y / full, 0.5f - z / full};
}

}  // namespace wardmis::pattern
