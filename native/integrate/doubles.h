// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the picture shows faces that lie exactly in one place: which of them are seen, and how much of the light that
// leaves them gets away, is a matter of rounding, here and in Cycles, and differs.
#pragma once

#include <string>

#include "integrate/setup.h"

namespace wardmis {

struct Doubles {
  float share = 0;   // of the picture
  std::string name;  // of the object that has most of it

  std::string told() const;
};
inline constexpr float kSharedPlaceIsTold = 0.01f;  // the least share that the user hears of

// By a grid of camera rays.
Doubles visibleDoubles(const BuiltScene& built);

}  // namespace wardmis
