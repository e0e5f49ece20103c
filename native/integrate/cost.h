// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample of each technique costs in this scene, on this machine, measured.
#pragma once

#include "integrate/setup.h"

namespace wardmis {

struct TechniqueCost {
  // Seconds of CPU time: of a camera sample without the samples at its hit, and of one sample of each technique with
  // all that follows from it (shadow rays, the path that goes on); 0 for techniques that the scene does not have.
  double cameraSample = 0;
  std::array<double, kTechniques> sample{};
  SampleCost perSample;  // relative to the mean of the techniques; 1 where nothing was measured
};

// Renders camera samples, which are thrown away, with the counts moved towards each technique in turn and once doubled,
// and solves for the costs by least squares. A pass to warm up, then rounds of up to five samples per pixel: one for
// every 50 of settings.spp, at least one, more than three for at most half a second. A machine that does other things
// makes them unsure.
TechniqueCost measureCost(const BuiltScene& built, const RenderSettings& settings);

}  // namespace wardmis
