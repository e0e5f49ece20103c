// SPDX-License-Identifier: GPL-3.0-or-later
// The techniques that a surface has, and their shares where nothing is known but the surface.
#pragma once

#include <algorithm>

#include "mis/allocation.h"

namespace wardmis {

// The usual path tracer's shares: half to the light, the rest to the lobes by albedo.
template <size_t K, class S>
Fractions<K> albedoFractions(const S& s) {
  Fractions<K> a{};
  float sum = s.diffuseStrength();
  for (size_t l = 0; l < Techniques<K>::kLobes; ++l)
    if (s.hasLobe(l)) sum += a[l] = s.strength(l);
  if (!(sum > 0)) a.fill(1), sum = Techniques<K>::kSurface;
  float rest = 1;
  for (size_t l = 0; l < Techniques<K>::kLobes; ++l) {
    rest -= a[l] /= sum;
    a[l] *= 0.5f;
  }
  a[Techniques<K>::kCosine] = s.hasDiffuse() ? 0.5f * std::max(rest, 0.0f) : 0;
  a[Techniques<K>::kLight] = 0.5f;
  return a;
}

// Whether a technique has lobes of one direction, and no others.
template <size_t K, class S>
bool isSharp(const S& s, size_t technique) {
  return technique < Techniques<K>::kLobes && s.delta(technique);
}
template <size_t K, class S>
bool onlySharp(const S& s) {
  if (s.hasDiffuse()) return false;
  for (size_t l = 0; l < Techniques<K>::kLobes; ++l)
    if (s.hasLobe(l) && !isSharp<K>(s, l)) return false;
  return true;
}

// The techniques that a surface has, where emitters are aimed at or not, and where surface samples find anything or
// not.
template <size_t K, class S>
TechniqueMask techniquesAt(const S& s, bool lights, bool surfaceRays) {
  TechniqueMask mask = lights ? maskOf(Techniques<K>::kLight) : TechniqueMask{0};
  if (!surfaceRays) return mask;
  for (size_t l = 0; l < Techniques<K>::kLobes; ++l)
    if (s.hasLobe(l)) mask |= maskOf(l);
  if (s.hasDiffuse()) mask |= maskOf(Techniques<K>::kCosine);
  return mask;
}

}  // namespace wardmis
