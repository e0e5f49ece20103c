// SPDX-License-Identifier: GPL-3.0-or-later
// Images and how they are looked up, as plain data.
#pragma once

#include <cstdint>
#include <string>

#include "image/texel_memory.h"

namespace wardmis {

// Pixels, rows from the bottom (v = 0 is row 0). 1 to 4 channels, interleaved. Linear, but for `srgb`: 8-bit images
// that are sRGB stay so and are decoded at look-up, as are floats if `filterEncoded`.
struct Image {
  std::string name;
  int width = 0, height = 0, channels = 0;
  bool srgb = false;
  Texels<uint8_t> bytes;  // exactly one of the two is filled
  Texels<float> floats;
  bool filterEncoded = false;  // sRGB values are filtered as they are, and decoded after that
};

enum class Wrap : uint8_t { kRepeat, kClamp, kMirror, kClip };  // kClip: 0 outside
enum class Filter : uint8_t { kLinear, kNearest, kCubic };      // kCubic: B-spline

struct Texture {
  int image = -1;
  Wrap wrapU = Wrap::kRepeat, wrapV = Wrap::kRepeat;
  Filter filter = Filter::kLinear;
};

}  // namespace wardmis
