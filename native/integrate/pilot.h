// SPDX-License-Identifier: GPL-3.0-or-later
// The pilot: moments of each pixel's first hits, pooled over techniques, smoothed over neighbouring pixels of the same
// surface, turned into each pixel's fractions. Fixed before the main samples are drawn, so these stay unbiased.
#pragma once

#include "film/film.h"
#include "integrate/hit.h"
#include "math/square_map.h"

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
  TechniqueMask techniques = ~TechniqueMask{0};  // that this surface has
};

// What the pilot found for a pixel's own surface. A hit of another one takes equal counts.
template <size_t K>
struct PixelFractions {
  PixelSurface surface;
  Fractions<K> fractions{};
  int samples = 0;  // at a hit
};

template <size_t K>
using FractionsMap = SquareMap<PixelFractions<K>>;

// A pilot of `auto` is coarse: it has one pixel for a square of the image's, since it is no part of the image.
inline constexpr int kCoarse = 2;  // pixels, a side

template <size_t K>
struct Pilot {
  int width, height;
  std::vector<PilotPixel> pixels;
  std::vector<HitMoments<K>> moments;        // of each pixel; none where the allocation is `auto`,
  std::vector<CandidateSums<K>> candidates;  // where these are

  Pilot(int w, int h, Allocation rule) : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h)) {
    if (rule == Allocation::kAuto)
      candidates.resize(pixels.size());
    else
      moments.resize(pixels.size());
  }

  // The sum of `values`, moments or candidates, over a pixel and its neighbours on the same surface, 7 x 7 pixels.
  template <class T>
  T smoothed(const std::vector<T>& values, int x, int y) const {
    constexpr int kRadius = 3;
    const PixelSurface& center = pixels[index(x, y)].surface;
    T sum{};
    for (int v = std::max(0, y - kRadius); v <= std::min(height - 1, y + kRadius); ++v)
      for (int u = std::max(0, x - kRadius); u <= std::min(width - 1, x + kRadius); ++u)
        if (center.holds(pixels[index(u, v)].surface)) sum += values[index(u, v)];
    return sum;
  }

  // Fractions of each pixel, of the techniques that the scene has (`available`), and its samples at a hit: as many as
  // are asked for, of `auto` fewer where these suffice.
  std::vector<PixelFractions<K>> fractions(Allocation rule, Integrand integrand, TechniqueMask available, float minimum,
                                           const CandidateLists<K>& lists, const SampleCost<K>& cost,
                                           int samplesPerHit) const;

 private:
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
  }
};

}  // namespace wardmis
