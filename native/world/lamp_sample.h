// SPDX-License-Identifier: GPL-3.0-or-later
// What the shapes of lamps tell of themselves.
#pragma once

#include "math/vec.h"

namespace wardmis {

// A direction towards a lamp's surface, as seen from a point.
struct LampSample {
  Vec3f direction{0, 0, 0};  // unit
  float distance = 0;
  float pdf = 0;  // per solid angle; 0: nothing arrives
};

// Where a ray meets a lamp's surface.
struct LampHit {
  float t = 0;    // 0: nowhere
  float pdf = 0;  // of the LampSample; 0: there is none
};

}  // namespace wardmis
