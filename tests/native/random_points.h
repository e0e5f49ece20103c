// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "math/random.h"
#include "math/vec.h"

namespace wardmis::test {

// In the cube of this side around the origin.
inline Vec3f inBox(Stream& random, float side) {
  const auto a = random.square(), b = random.square();
  return {side * (static_cast<float>(a.x) - 0.5f), side * (static_cast<float>(a.y) - 0.5f),
          side * (static_cast<float>(b.x) - 0.5f)};
}

}  // namespace wardmis::test
