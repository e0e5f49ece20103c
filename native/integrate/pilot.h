// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot: moments of each pixel's first hits, pooled over techniques, smoothed over neighbouring pixels of the same
// surface, turned into each pixel's fractions. Fixed before the main samples are drawn, so these stay unbiased.
#pragma once

#include <utility>

#include "integrate/hit.h"

namespace wardmis {

struct PilotPixel {
  HitMoments moments;
  Vec3f normal{0, 0, 0};
  int material = -1;
  uint32_t placement = ~0u;
  TechniqueMask techniques = kAllTechniques;  // that this surface has
};

struct Pilot {
  int width, height;
  std::vector<PilotPixel> pixels;
  std::vector<CandidateSums> candidates;  // of each pixel, where the allocation is `auto`; else none

  Pilot(int w, int h, Allocation rule) : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h)) {
    if (rule == Allocation::kAuto) candidates.resize(pixels.size());
  }

  // The moments and candidates of a pixel with those of its neighbours on the same surface, 7 x 7 pixels.
  std::pair<HitMoments, CandidateSums> smoothed(int x, int y) const;

  // Fractions per pixel of the techniques that the scene has (`available`).
  std::vector<Fractions> fractions(Allocation rule, Integrand integrand, TechniqueMask available, float minimum,
                                   const Fractions& cost) const;
};

}  // namespace wardmis
