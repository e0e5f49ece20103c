// SPDX-License-Identifier: GPL-3.0-or-later
// What a sample of each technique costs in this scene, on this machine, measured.
#pragma once

#include "integrate/setup.h"

namespace wardmis {

struct TechniqueCost {
  // Seconds of CPU time: of a camera sample without the samples at its hit, and of one sample of each technique with
  // all that follows from it (shadow rays, the path that goes on); 0 for techniques that the scene does not have.
  double cameraSample = 0;
  std::array<double, kMaxTechniques> sample{};
  // Relative to the mean of the techniques; 1 where nothing was measured.
  float relativeHit = 0;  // of a camera sample, by the samples of a hit
  std::array<float, kMaxTechniques> relative;

  TechniqueCost() { relative.fill(1); }
  template <size_t K>
  SampleCost<K> perSample() const {
    SampleCost<K> cost;
    cost.hit = relativeHit;
    std::copy_n(relative.begin(), K, cost.technique.begin());
    return cost;
  }
};

// Renders camera samples, which are thrown away, with the counts moved towards each technique in turn and once doubled,
// and solves for the costs by least squares. A pass to warm up, then rounds of up to five samples per pixel: one for
// every 50 of settings.spp, at least one, more than three for at most half a second. A machine that does other things
// makes them unsure.
TechniqueCost measureCost(const BuiltScene& built, const RenderSettings& settings);

}  // namespace wardmis
