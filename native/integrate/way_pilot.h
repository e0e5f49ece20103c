// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot of a bidirectional render: how many paths from the lights there are to be, or none, and how many samples at
// a hit and connections each pixel has.
#pragma once

#include "integrate/setup.h"

namespace wardmis {

// What things cost, in rays that camera paths follow: as times in blend/ajar.blend have it.
inline constexpr double kConnectionCost = 1.2;  // two surfaces are asked, and often a ray
inline constexpr double kLightRayCost = 2.2;    // of a path from a light: the surface is asked from both sides

struct WayChoice {
  bool asked = false;  // a pilot ran
  WayCounts counts;    // in mean over the pixels, of camera samples at a hit a share of those that are asked for
  WayMap map;          // of each pixel; empty where all have the same
  double gain = 1;     // of second moment x cost, over paths from the camera alone; of `auto`
  Counts pilot;        // what it took
};

// By an allocation that asks for moments, where the integrator and the scene want paths from the lights; without any
// where `auto` says that they do not pay. expected: samples of the image.
template <size_t K>
WayChoice waysOf(const BuiltScene& built, const RenderSettings& settings, uint32_t expected,
                 const std::function<bool()>& stopped);

}  // namespace wardmis
