// SPDX-License-Identifier: GPL-3.0-or-later
// The node Brick Texture: rows of bricks in the plane of x and y.
#pragma once

#include <algorithm>

#include "pattern/point.h"

namespace wardmis::pattern {

struct BrickSettings {
  Version version = Version::kBlender5;
  float offset = 0.5f, squash = 1;  // of every n-th row
  int offsetFrequency = 2, squashFrequency = 2;
};
struct BrickInputs {
  Rgb color1{0.8f, 0.8f, 0.8f}, color2{0.2f, 0.2f, 0.2f}, mortar;
  float scale = 5, mortarSize = 0.02f, mortarSmooth = 0.1f, bias = 0, brickWidth = 0.5f, rowHeight = 0.25f;
};
struct BrickValue {
  Rgb color;
  float factor = 0;  // how much of it is mortar
};

// A number in [0, 1] of each brick.
constexpr float brickTint(uint32_t n) {
  n = (n + 1013) & 0x7fffffff;
  n ^= n >> 13;
  return static_cast<float>((n * (n * n * 60493 + 19990303) + 1376312589) & 0x7fffffff) / 0x1p31f;
}

inline BrickValue brick(const BrickSettings& s, const BrickInputs& in, Vec3f p) {
  const float px = p.x * in.scale, py = p.y * in.scale;
  const int row = toInt(std::floor(py / in.rowHeight));
  float width = in.brickWidth, offset = 0;
  if (s.offsetFrequency > 0 && s.squashFrequency > 0) {
    if (row % s.squashFrequency == 0) width *= s.squash;
    if (row % s.offsetFrequency == 0) offset = width * s.offset;
  }
  const int column = toInt(std::floor((px + offset) / width));
  const float x = px + offset - width * static_cast<float>(column), y = py - in.rowHeight * static_cast<float>(row);
  const float edge = std::min(std::min(x, y), std::min(width - x, in.rowHeight - y));
  BrickValue r;
  if (edge >= in.mortarSize) {
    r.factor = 0;
  } else if (in.mortarSmooth == 0 || (s.version == Version::kBlender3 && in.mortarSmooth < 0)) {
    r.factor = 1;
  } else {
    r.factor = smoothstep((1 - edge / in.mortarSize) / in.mortarSmooth);
  }
  const uint32_t name = (static_cast<uint32_t>(row) << 16) + (static_cast<uint32_t>(column) & 0xffff);
  const float tint = limit(brickTint(name) + in.bias, 0, 1);
  r.color = lerp(lerp(in.color1, in.color2, tint), in.mortar, r.factor);
  return r;
}

}  // namespace wardmis::pattern
