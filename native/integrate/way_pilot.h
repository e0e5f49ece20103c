// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot of a bidirectional render: how many paths from the lights there are to be, or none, and how many samples at
// a hit and connections each pixel has.
#pragma once

#include "integrate/setup.h"

namespace wardmis {

struct WayChoice {
  WayCounts counts;  // in mean over the pixels, of camera samples at a hit a share of those that are asked for
  WayMap map;        // of each pixel; empty where all have the same
  double gain = 1;   // of second moment x cost, over paths from the camera alone; of `auto`
  Counts pilot;      // what it took
};

// Of a setup with paths from the lights, by an allocation that asks for moments. expected: samples of the image;
// minimum: share of a group, of other allocations than `auto`.
template <size_t K>
WayChoice chooseWays(RenderSetup<K>& setup, Allocation rule, double minimum, uint32_t expected,
                     const std::function<bool()>& stopped);

}  // namespace wardmis
