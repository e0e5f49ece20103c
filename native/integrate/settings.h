// SPDX-License-Identifier: GPL-3.0-or-later
// What a render is asked for.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "integrate/plan.h"
#include "math/random.h"
#include "mis/allocation.h"
#include "mis/ways.h"
#include "scene/scene.h"

namespace wardmis {

inline constexpr int kLongestPath = 1024;  // surface hits, and bounces of a kind

enum class Integrator : uint8_t { kDirect, kPath, kBidirectional };
std::string_view name(Integrator);
std::string_view name(SamplerType);
std::string_view name(FilterType);

// Where the cost of a sample comes from: counted in the pilot (one for a sample, one for each ray of the path that goes
// on from it, and the camera ray shared by a hit's samples); given; or measured, and the image then depends on the
// machine.
enum class CostFrom : uint8_t { kRays, kGiven, kMeasured };

// How camera samples are shared between pixels: as many for all, more where they bring more (film/pixel_shares.h), or
// the latter where the allocation is `auto`, too.
enum class PixelSamples : uint8_t { kEven, kByError, kAuto };
std::string_view name(PixelSamples);

// Of a lobe, cosine and light sample, any unit.
struct GivenCost {
  float lobe = 1, cosine = 1, light = 1;
};

// Camera samples of an image, by number.
struct SampleRange {
  uint32_t from = 0, to = 0;  // `to` is not one of them

  uint32_t count() const { return to - from; }
};

// Paths from the lights of a bidirectional render.
struct FromLights {
  double paths = 1;                           // for each camera sample of a pixel
  int connections = 1, laterConnections = 1;  // with their vertices, of the first vertex of a camera path and of others
  bool film = true;                           // they are traced to the film, too

  WayCounts counts() const { return {1, paths, double(connections), double(laterConnections)}; }
};

struct RenderSettings {
  bool data = false, light = false;  // what DataPixel and LightPixel have is wanted
  Allocation allocation = Allocation::kAuto;
  PixelSamples pixels = PixelSamples::kAuto;
  std::optional<Weights> weights;  // none: what the paper pairs with the allocation
  Integrand integrand = Integrand::kSplit;
  Integrator integrator = Integrator::kPath;
  SamplerType sampler = SamplerType::kSobol;
  uint32_t spp = 64;   // camera samples per pixel in the image, the pilot's included unless it is apart (pilotApart)
  double seconds = 0;  // > 0: stop after this time instead
  // > 0: stop as soon as the image is told to be better, at the latest after all samples or the time.
  double targetError = 0;
  std::optional<SampleRange> part;  // of the spp samples these alone; not with a time, nor measured costs
  FromLights fromLights;
  int samplesPerHit = 6;
  uint32_t pilotSpp = 4;  // camera samples of the pilot per pixel, of `auto` per 2 x 2 pixels
  float minFraction = 0.1f;
  CostFrom costFrom = CostFrom::kRays;  // of samples, for `auto`
  GivenCost cost;                       // of a sample, where it is given
  int maxDepth = 8;                     // surface hits of a path
  int maxDiffuse = kLongestPath;        // of them reached from a cosine sample, and not emitting alone: diffuse bounces
  int maxGlossy = kLongestPath;         // from a lobe sample
  int maxTransmission = kLongestPath;   // from one that goes through the surface
  int maxTransparent = 8;               // surfaces that a path passes straight
  uint64_t seed = 0;
  int threads = 0;  // 0: all
  bool generalKernel = false;

  PathLimits limits() const;
  bool bidirectional() const { return integrator == Integrator::kBidirectional; }  // paths, too, where the scene allows
  // Whether the number of its samples is not known before.
  bool open() const { return seconds > 0 || targetError > 0; }
  SampleRange range() const { return part.value_or(SampleRange{0, spp}); }  // without a limit of time
  bool sharesPixels() const;                                                // unevenly, if that pays
  // Of ways to make a path, balance weights, unless others are asked for.
  Weights weightRule() const {
    return weights.value_or(bidirectional() ? Weights::kBalance : paperWeights(allocation));
  }
};

}  // namespace wardmis
