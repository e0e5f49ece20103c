// SPDX-License-Identifier: GPL-3.0-or-later
// The camera samples of one tile. One instantiation per needs mask and number of techniques (kernels.cpp), chosen once
// per render.
#pragma once

#include "film/film.h"
#include "integrate/light_paths.h"
#include "integrate/pilot.h"
#include "integrate/shares.h"
#include "world/camera_ray.h"

namespace wardmis {

template <size_t K>
struct KernelInput {
  const RenderScene& scene;
  const RenderScene* catchers;  // the shadow catchers alone; null: there are none
  const CameraRays& camera;
  const PixelFilter& filter;
  const Sampler& sampler;
  const FractionsMap<K>* perPixel;  // null: `fractions` everywhere
  Fractions<K> fractions;           // of a hit, before it is restricted to what the surface has
  Allocation rule;
  Integrand integrand;
  Weights weights;
  const CandidateLists<K>& candidates;  // for `auto`
  SampleCost<K> cost;                   // for `auto`
  int samplesPerHit;
  PathLimits limits;
  const Shutter* shutter;             // null: nothing moves
  float least;                        // that a sample may be: 0, unless a light is negative
  int x0, y0;                         // of the border in the full frame
  int side = 1;                       // of a pixel of the film, in pixels of the image; more for a coarse pilot
  const LightPaths* light = nullptr;  // null: there are no paths from the lights
  const WayMap* ways = nullptr;       // how many of them there are for each pixel; null: as many as are asked for
  WayTally* wayPilot = nullptr;       // where a pilot that chooses how many notes what samples bring; null: it does not

  // x, y: of the film.
  PixelWays waysAt(int x, int y) const {
    return ways != nullptr ? ways->at(x * side, y * side)
                           : PixelWays{samplesPerHit, light->connections, light->laterConnections};
  }
};

// The fractions at the first hit of a camera's path to which paths from the lights are connected.
template <size_t K, class S>
Fractions<K> firstFractions(const KernelInput<K>& in, const S& surface, TechniqueMask mask) {
  return restrict<K>(in.rule == Allocation::kAlbedo ? albedoFractions<K>(surface) : in.fractions, mask);
}

struct Tile {
  int x0, y0, x1, y1;  // within the border
  double first, last;  // samples of the image, as of PixelShares::count(), of which the first are there
};

// Adds camera samples to the film until the tile's pixels have theirs of `last`, and, where `pilot` is given, their
// moments.
template <size_t K>
using TileKernel = void (*)(const KernelInput<K>&, const Tile&, FilmBuffer&, Pilot<K>* pilot, Counts&);

// The kernel for a mask of kKernelNeeds bits; with kNeedsConnections that for all surfaces to which paths from lights
// are connected.
template <size_t K>
TileKernel<K> tileKernel(uint32_t needs);
template <size_t K>
TileKernel<K> connectingKernel();

// Traces the paths from the lights that are numbered from `first` to before `last`, of all of the image; their vertices
// and what they bring to the film are added to the lists.
template <size_t K>
void traceLightPaths(const KernelInput<K>& in, uint32_t first, uint32_t last, LightList& to, Counts& counts);

}  // namespace wardmis
