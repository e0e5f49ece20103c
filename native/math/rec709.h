// SPDX-License-Identifier: GPL-3.0-or-later
// Linear Rec. 709 with the digits that Cycles has by the version of Blender, 3 to 5: of 5 those of the primaries, of
// earlier ones a common rounding of them, which is off by up to 2.4e-4.
#pragma once

#include <cstdint>

#include "math/vec.h"

namespace wardmis::rec709 {

// Of light with the coordinates xyz of CIE 1931.
constexpr Rgb fromXyz(Vec3f xyz, uint32_t version) {
  if (version >= 5)
    return {dot({3.24096994f, -1.53738318f, -0.49861076f}, xyz), dot({-0.96924364f, 1.8759675f, 0.04155506f}, xyz),
            dot({0.05563008f, -0.20397696f, 1.05697151f}, xyz)};
  return {dot({3.2404542f, -1.5371385f, -0.4985314f}, xyz), dot({-0.9692660f, 1.8760108f, 0.0415560f}, xyz),
          dot({0.0556434f, -0.2040259f, 1.0572252f}, xyz)};
}
// A colour as a number: y of its light.
constexpr float luminance(Rgb c, uint32_t version) {
  return dot(version >= 5 ? Rgb{0.212639f, 0.7151687f, 0.0721923f} : Rgb{0.2126729f, 0.7151522f, 0.072175f}, c);
}

}  // namespace wardmis::rec709
