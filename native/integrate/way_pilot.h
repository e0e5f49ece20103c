// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot of a bidirectional render whose allocation is `auto`: how many paths from the lights and connections there
// are to be, or none.
#pragma once

#include "integrate/setup.h"

namespace wardmis {

struct WayChoice {
  WayCounts counts;  // of camera samples at a hit a share of those that are asked for
  double gain = 1;   // of second moment x cost, over paths from the camera alone
  Counts pilot;      // what it took
};

// Of a setup with paths from the lights. expected: samples of the image.
template <size_t K>
WayChoice chooseWays(RenderSetup<K>& setup, uint32_t expected, const std::function<bool()>& stopped);

}  // namespace wardmis
