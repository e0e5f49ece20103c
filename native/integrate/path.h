// SPDX-License-Identifier: GPL-3.0-or-later
// Light that arrives by more than one reflection: from the second vertex on, one surface sample and one light sample a
// vertex (balance heuristic over the albedo-weighted mixture of the lobes and the emitters), Russian roulette.
#pragma once

#include "integrate/hit.h"

namespace wardmis {

// Whether the path of a first hit's sample goes on, by a random number u: with a probability as small as its worth
// where that is less than half of `mean`, what the hit's surface samples bring in mean of light from all around; it
// then stands for those that do not. Paths of a faint lobe cost as much as those of a bright one, and bring little.
template <size_t K>
bool goesOn(Continuation<K>& c, float mean, float u) {
  const float q = 2 * maxComponent(absolute(c.weight)) / mean;
  if (!(q < 1)) return true;
  if (!(u < q)) return false;
  c.weight *= 1 / q;
  c.scale *= 1 / q;
  return true;
}

// Radiance reflected at the end of `first`, times its weight. index: of this path among the pixel's; camera: as it is
// there, but for the cosine, or null.
template <uint32_t N, size_t K>
Rgb followPath(const RenderScene& scene, const Sampler& sampler, uint32_t pixelKey, uint32_t index,
               const Continuation<K>& first, const PathLimits& limits, CameraVertex* camera, Counts& counts) {
  const bool lights = scene.emitters.any();
  Rgb sum{0, 0, 0};
  std::array<int, kBounceKinds> left = limits.bounces;
  if (--left[first.bounce] < 0) return sum;
  Rgb weight = first.weight;
  float survived =
      1;  // product of the vertices' own weights: what the roulette looks at, whatever the first hit's counts
  Ray ray = first.ray;
  Hit hit = first.hit;
  const Counts::PerTechnique firstHitSamples = counts.samples;
  for (int vertex = 1; vertex < limits.depth; ++vertex) {
    const auto x = interact<N, K>(scene.scene, scene.geometry, ray, hit);
    const TechniqueMask mask = techniquesAt<K>(x.surface, lights, true);
    if ((mask & ~maskOf(Techniques<K>::kLight)) == 0) break;  // reflects nothing
    HitPlan<K> plan;
    if constexpr ((N & kNeedsConnections) != 0)
      if (camera != nullptr) {
        camera->left = left;
        camera->arrive(dot(x.geometric, ray.direction), detail::lightReaches(scene, hit));
        camera->throughput = camera->before * weight;
        plan.camera = camera;
        plan.weights = camera->light.power.square ? Weights::kPower : Weights::kBalance;
      }
    plan.fractions = albedoFractions<K>(x.surface);
    if (!lights) plan.fractions = restrict<K>(plan.fractions, mask);
    plan.samples = lights ? 2 : 1;
    plan.integrand = Integrand::kJoint;
    plan.pixelKey = pixelKey;
    plan.vertex = static_cast<uint32_t>(vertex);
    plan.index = index;
    Continuations<K> more;
    sum += weight * estimateHit<N, K>(scene, sampler, x, plan, counts, nullptr, more);
    if (more.count == 0) break;
    const Continuation<K>& next = more.list[0];
    if (--left[next.bounce] < 0) break;
    weight *= next.weight;
    survived *= maxComponent(absolute(next.weight));
    if (vertex >= 2) {
      // the root: paths end later than by what survives itself, and the noise that ending brings is less (measured)
      const float q = std::sqrt(survived);
      if (q < 1) {
        if (sampler.get1D(pixelKey, plan.vertex * Dimensions<K>::kPerVertex + Dimensions<K>::kRoulette, index) >= q)
          break;
        weight *= 1 / q;
        survived /= q;
      }
    }
    if constexpr ((N & kNeedsConnections) != 0)
      if (camera != nullptr) camera->end = camera->next[0];
    ray = next.ray;
    hit = next.hit;
  }
  counts.samples = firstHitSamples;
  return sum;
}

}  // namespace wardmis
