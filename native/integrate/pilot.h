// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot: moments of each pixel's first hits, pooled over techniques, smoothed over neighbouring pixels of the same
// surface, turned into each pixel's fractions. Fixed before the main samples are drawn, so these stay unbiased.
#pragma once

#include <utility>

#include "integrate/hit.h"

namespace wardmis {

// A face of an object, as far as one allocation can serve all of it.
struct PixelSurface {
  Vec3f normal{0, 0, 0};
  int material = -1;  // none: no surface
  uint32_t placement = ~0u;

  bool holds(const PixelSurface& b) const {
    constexpr float kSameFace = 0.9f;  // cos of the largest turn of the normal
    return material == b.material && placement == b.placement && dot(normal, b.normal) >= kSameFace;
  }
};

// surface: that of the pixel's first hit. Hits of other ones, beyond an edge, have no part in the moments: they would
// set the counts of a whole neighbourhood by a light that it does not get.
struct PilotPixel {
  PixelSurface surface;
  TechniqueMask techniques = kAllTechniques;  // that this surface has
  HitMoments moments;
};

// What the pilot found for a pixel's own surface. A hit of another one takes equal counts.
struct PixelFractions {
  PixelSurface surface;
  Fractions fractions{};
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
  std::vector<PixelFractions> fractions(Allocation rule, Integrand integrand, TechniqueMask available, float minimum,
                                        const CandidateLists& lists, const SampleCost& cost) const;
};

}  // namespace wardmis
