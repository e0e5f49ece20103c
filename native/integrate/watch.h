// SPDX-License-Identifier: GPL-3.0-or-later
// What watches the samples of a hit: nothing, or a pilot that learns from them and passes of light.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "integrate/plan.h"
#include "math/component.h"
#include "math/scratch.h"
#include "math/vec.h"
#include "mis/candidates.h"
#include "mis/moments.h"

namespace wardmis {

// Moments of a hit's integrands (joint: the first alone).
template <size_t K>
struct HitMoments {
  PerIntegrand<Moments<K>, K> of;

  HitMoments& operator+=(const HitMoments& b) {
    for (size_t i = 0; i < of.size(); ++i) of[i] += b.of[i];
    return *this;
  }
};

// The light of one camera sample by the components of what it meets first.
struct LightSplit {
  PerComponent direct{};
  Scratch<PerComponent, kMaxSamplesPerHit> share;  // of the light of each path that goes on; 9 kB, not to be cleared

  void add(Component c, Rgb value) { direct[static_cast<size_t>(c)] += value; }
};

// Nothing.
struct Unwatched {
  static constexpr bool kWatches = false;
};

// Where the pilot notes what the samples of a hit bring: its moments, or, for `auto`, the sums of the candidates. Of
// all light, also of what comes by way of other surfaces.
template <size_t K>
struct HitRecord {
  static constexpr bool kWatches = true;
  HitMoments<K>* moments = nullptr;
  CandidateHit<K>* candidates = nullptr;
  LightSplit* light = nullptr;

  // A sample's value f in one integrand, as for Moments::add.
  void add(size_t integrand, float f, const Fractions<K>& p, const Fractions<K>& n, TechniqueMask used, int set) {
    if (moments != nullptr) moments->of[integrand].add(f, p, n, used);
    if (candidates != nullptr) candidates->add(f, p, n, used, set);
  }
};

}  // namespace wardmis
