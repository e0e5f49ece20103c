// SPDX-License-Identifier: GPL-3.0-or-later
// What a render counts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "math/check.h"
#include "mis/technique.h"

namespace wardmis {

// By technique.
struct Counts {
  using PerTechnique = std::array<uint64_t, kMaxTechniques>;
  PerTechnique samples{};    // at the first hit
  PerTechnique rays{};       // traced for samples; of the light: shadow rays
  PerTechnique following{};  // rays of the paths that went on from samples of each technique
  uint64_t cameraRays = 0;
  uint64_t lightRays = 0, connections = 0;  // of paths from lights, those to the lens among them; between vertices
  // Vertices that were joined, visible or not: the first of a camera path, and later ones.
  std::array<uint64_t, 2> joined{};
  // Directions above the surface at which a lobe's density is no normal number: e^-E is smaller than any.
  uint64_t underflows = 0;
  RareCounts rare;

  // What more samples at a hit and more connections multiply.
  struct Join {
    uint64_t rays = 0;
    std::array<uint64_t, 2> joined{};
  };
  Join join() const { return {sum(rays), joined}; }

  static uint64_t sum(const PerTechnique& c) { return std::accumulate(c.begin(), c.end(), uint64_t{0}); }
  uint64_t allRays() const { return cameraRays + sum(rays) + lightRays + connections; }
  Counts& operator+=(const Counts& b) {
    for (size_t i = 0; i < kMaxTechniques; ++i)
      samples[i] += b.samples[i], rays[i] += b.rays[i], following[i] += b.following[i];
    cameraRays += b.cameraRays, lightRays += b.lightRays, connections += b.connections;
    joined[0] += b.joined[0], joined[1] += b.joined[1];
    underflows += b.underflows, rare += b.rare;
    return *this;
  }
};

}  // namespace wardmis
