// SPDX-License-Identifier: GPL-3.0-or-later
// What each way to make a path brings, varies and costs, with the numbers that a render has.
#pragma once

#include "integrate/setup.h"
#include "mis/way_images.h"

namespace wardmis {

struct WaySurvey {
  struct Way {
    int surfaces, byCamera;  // of the path; of these the camera made
    std::vector<Rgb> weighted, alone;
    // Sum over the pixels of the variance of one sample's part, over the square of the pixel's mean + 0.01; and what it
    // takes, in rays; both as parts of all ways'.
    double variance = 0, cost = 0;
    double samples = 0;  // for each pixel and camera sample
  };
  int width = 0, height = 0;
  WayCounts counts;  // in mean over the pixels
  uint32_t samples = 0;
  std::vector<Way> ways;  // none: there are no paths from the lights
};

// Of an image with at most so many pixels across.
WaySurvey surveyWays(
    const BuiltScene& built, const RenderSettings& settings, uint32_t samples, int across,
    const std::function<bool()>& stopped = [] { return false; });

}  // namespace wardmis
