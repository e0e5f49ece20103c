// SPDX-License-Identifier: GPL-3.0-or-later
// What each pixel shows, and how stiff its estimation is: a pilot whose image is not kept.
#pragma once

#include <string>

#include "integrate/setup.h"

namespace wardmis {

struct SurveyPixel {
  int material = -1;             // index into Scene::materials of the first hit; -1: none
  TechniqueMask techniques = 0;  // that the surface has
  uint32_t placement = ~0u;      // index into Geometry::placements; ~0: none
  float stiffness = 0;  // largest over smallest second moment of an integrand's techniques, of the stiffer one; 0:
                        // fewer than two techniques, or no light
};

struct Survey {
  std::vector<SurveyPixel> pixels;  // row 0 is the top row
  // Means over the pixels that have the technique, of its single-sample estimators at first hits (all its integrands):
  // second moment, and variance.
  std::array<double, kMaxTechniques> secondMoment{}, variance{};
  TechniqueMask techniques = 0;
  std::vector<std::string> techniqueNames;
};

// samples: per pixel.
Survey survey(const BuiltScene& built, const RenderSettings& settings, uint32_t samples);

}  // namespace wardmis
