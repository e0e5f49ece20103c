// SPDX-License-Identifier: GPL-3.0-or-later
// Light that arrives by more than one reflection: from the second vertex on, one surface sample and one light sample a
// vertex (balance heuristic over the albedo-weighted mixture of the lobes and the emitters), Russian roulette.
#pragma once

#include "integrate/hit.h"

namespace wardmis {

// The usual path tracer's shares: half to the light, the rest to the lobes by albedo.
inline Fractions albedoFractions(const Surface& s) {
  const float specular = luminance(s.specular), diffuse = luminance(s.diffuse);
  const float lobe = specular + diffuse > 0 ? specular / (specular + diffuse) : 0.5f;
  return {0.5f * lobe, 0.5f * (1 - lobe), 0.5f};
}

// The techniques that a surface has, where emitters are aimed at or not, and where surface samples find anything or
// not.
inline TechniqueMask techniquesAt(const Surface& s, bool lights, bool surfaceRays) {
  TechniqueMask mask = lights ? maskOf(kLight) : TechniqueMask{0};
  if (surfaceRays && s.hasSpecular()) mask |= maskOf(kLobe);
  if (surfaceRays && s.hasDiffuse()) mask |= maskOf(kCosine);
  return mask;
}

template <uint32_t N>
Rgb estimate(const RenderScene& scene, const Sampler& sampler, const Interaction& x, const HitPlan& plan,
             Counts& counts, HitRecord* record, Continuations& more) {
  if ((N & kNeedsSpecular) != 0 && x.surface.needsDouble(dot(x.frame.z, x.wo)))
    return estimateHit<N, double>(scene, sampler, x, plan, counts, record, more);
  return estimateHit<N, float>(scene, sampler, x, plan, counts, record, more);
}

// Radiance reflected at the end of `first`, times its weight. index: of this path among the pixel's.
template <uint32_t N>
Rgb followPath(const RenderScene& scene, const Sampler& sampler, uint32_t pixelKey, uint32_t index,
               const Continuation& first, const PathLimits& limits, Counts& counts) {
  const bool lights = scene.emitters.any();
  Rgb sum{0, 0, 0};
  std::array<int, kTechniques> left = limits.bounces;
  if (--left[first.technique] < 0) return sum;
  Rgb weight = first.weight;
  float survived =
      1;  // product of the vertices' own weights: what the roulette looks at, whatever the first hit's counts
  Ray ray = first.ray;
  Hit hit = first.hit;
  const std::array<uint64_t, kTechniques> firstHitSamples = counts.samples;
  for (int vertex = 1; vertex < limits.depth; ++vertex) {
    const Interaction x = interact<N>(scene.scene, scene.geometry, ray, hit);
    const TechniqueMask mask = techniquesAt(x.surface, lights, true);
    if ((mask & ~maskOf(kLight)) == 0) break;  // reflects nothing
    HitPlan plan;
    plan.fractions = restrict(albedoFractions(x.surface), mask);
    plan.samples = lights ? 2 : 1;
    plan.integrand = Integrand::kJoint;
    plan.pixelKey = pixelKey;
    plan.vertex = static_cast<uint32_t>(vertex);
    plan.index = index;
    plan.firstPoint = {index, index, index};  // at most one of each
    Continuations more;
    sum += weight * estimate<N>(scene, sampler, x, plan, counts, nullptr, more);
    if (more.count == 0) break;
    const Continuation& next = more.list[0];
    if (--left[next.technique] < 0) break;
    weight *= next.weight;
    survived *= maxComponent(next.weight);
    if (vertex >= 2) {
      const float q = std::min(0.95f, survived);
      if (sampler.get1D(pixelKey, plan.vertex * kPerVertex + kRoulette, index) >= q) break;
      weight *= 1 / q;
      survived /= q;
    }
    ray = next.ray;
    hit = next.hit;
  }
  counts.samples = firstHitSamples;
  return sum;
}

}  // namespace wardmis
