// SPDX-License-Identifier: GPL-3.0-or-later
// How a vertex of a path is to be sampled: its numbers, its techniques and their shares, and how far paths go.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "mis/allocation.h"
#include "mis/technique.h"

namespace wardmis {

inline constexpr int kMaxSamplesPerHit = 256;

// Names of the random numbers that a vertex uses; the number's dimension is vertex * Dimensions<K>::kPerVertex + name.
template <size_t K>
struct Dimensions {
  enum : uint32_t { kFilmPoint = 0, kLensPoint, kSampleCounts, kTechnique, kRoulette = kTechnique + K, kPerVertex };
};

// That of a camera sample's time: beyond those of all vertices.
inline constexpr uint32_t kTimePoint = 0x80000000u;

// Those of the paths from the lights that a camera's vertex is connected to.
inline constexpr uint32_t kConnectionPoint = 0x60000000u, kConnectionsPerVertex = 2;

// Kinds of bounces, as Cycles limits them.
enum Bounce : uint8_t { kDiffuseBounce, kGlossyBounce, kTransmissionBounce, kBounceKinds };

// How far paths go, as Cycles counts: surface hits, and how often one may go on from a bounce of each kind. What a ray
// meets where that is used up still gives its own light, and reflects none.
struct PathLimits {
  int depth = 1;
  std::array<int, kBounceKinds> bounces{};

  // Whether a path may go on at all, on surfaces that transmit light or do not.
  bool bounce(bool transmission) const {
    const int reflection = std::max(bounces[kDiffuseBounce], bounces[kGlossyBounce]);
    return depth > 1 && (reflection > 0 || (transmission && bounces[kTransmissionBounce] > 0));
  }
};

struct CameraVertex;

// How a hit is to be sampled.
template <size_t K>
struct HitPlan {
  Fractions<K> fractions{};  // of the techniques that this hit has
  int samples = 0;           // in all; at most the batch's capacity
  Integrand integrand = Integrand::kSplit;
  Weights weights = Weights::kBalance;
  uint32_t pixelKey = 0, vertex = 0;
  uint32_t index = 0;              // of this visit, by the camera sample: nothing depends on what others met
  CameraVertex* camera = nullptr;  // to which paths from the lights are connected; null: there are none
};

}  // namespace wardmis
