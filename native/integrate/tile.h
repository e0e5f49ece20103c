// SPDX-License-Identifier: GPL-3.0-or-later
// Definition of the tile kernel; included by kernels.cpp alone.
#pragma once

#include <bit>
#include <optional>

#include "integrate/kernel.h"
#include "integrate/path.h"

namespace wardmis {

// Radiance along one camera ray.
template <uint32_t N>
Rgb cameraSample(const KernelInput& in, const Ray& ray, uint32_t pixelKey, uint32_t sample,
                 const PixelFractions* allocated, Pixel& pixel, PilotPixel* pilot, HitMoments* moments,
                 CandidateSums* candidates, Counts& counts) {
  const RenderScene& world = in.scene;
  ++counts.cameraRays;
  const Hit hit = world.accel.intersect(ray);
  const bool transparent = world.scene.film.transparent;
  Rgb sum{0, 0, 0};
  bool covered = hit.valid() || !transparent;
  world.emitters.along(ray, hit.valid() ? hit.t : ray.tMax, !hit.valid() && !transparent, 0, [&](const EmitterHit& e) {
    sum += e.radiance;
    covered = true;
  });
  pixel.alpha += covered ? 1.0f : 0.0f;
  if (!hit.valid()) return sum;

  const Interaction x = interact<N>(world.scene, world.geometry, ray, hit);
  const Surface& s = x.surface;
  sum += x.emission;
  if (sample == 0) pixel.depth = in.camera.depth(ray, hit.t);
  pixel.normal += x.frame.z;
  pixel.albedo += s.diffuse + s.specular;
  const TechniqueMask mask = techniquesAt(s, in.lights, in.surfaceRays);
  const PixelSurface surface{x.frame.z, x.material, x.placement};
  if (pilot != nullptr && pilot->surface.material < 0) pilot->surface = surface, pilot->techniques = mask;

  if (mask == 0 || !(s.hasDiffuse() || s.hasSpecular())) return sum;
  HitPlan plan;
  const PixelSurface* const own = pilot != nullptr       ? &pilot->surface
                                  : allocated != nullptr ? &allocated->surface
                                                         : nullptr;
  const bool follows = own == nullptr || own->holds(surface);
  const Fractions& shares =
      allocated != nullptr && follows && covers(allocated->fractions, mask) ? allocated->fractions : in.fractions;
  plan.index = follows ? pixel.visits++ : sample;
  plan.available = mask;
  if (candidates != nullptr) {  // the pilot of `auto`: each technique alike
    plan.samples = kSets * std::popcount(mask);
    plan.fractions = restrict({1, 1, 1}, mask);
  } else {
    // whole numbers over each block of visits 2^k ... 2^(k+1) - 1, over which the sampler spreads u evenly
    plan.samples = in.samplesPerHit;
    plan.fractions = wholeCounts(restrict(in.rule == Allocation::kAlbedo ? albedoFractions(s) : shares, mask),
                                 plan.samples, std::bit_floor(plan.index));
  }
  plan.integrand = in.integrand;
  plan.weights = in.weights;
  plan.pixelKey = pixelKey;
  plan.firstPoint = pixel.techniques;
  Continuations more;
  const std::array<uint64_t, kTechniques> before = counts.samples;
  std::optional<HitRecord> record;
  std::optional<CandidateHit> candidate;
  if (pilot != nullptr && follows) {
    if (candidates != nullptr) candidate.emplace(in.candidates.of(mask));
    record.emplace(HitRecord{moments, candidate ? &*candidate : nullptr});
  }
  sum += estimate<N>(world, in.sampler, x, plan, counts, record ? &*record : nullptr, more);
  for (size_t i = 0; i < kTechniques; ++i) pixel.techniques[i] += static_cast<uint32_t>(counts.samples[i] - before[i]);
  if constexpr ((N & kNeedsBounces) != 0) {
    const Fractions n = record ? Mixture(plan.fractions, plan.samples, plan.weights).n : Fractions{};
    for (int k = 0; k < more.count; ++k) {
      const Continuation& c = more.list[k];
      const uint64_t rays = counts.rays();
      const Rgb value =
          followPath<N>(world, in.sampler, pixelKey,
                        sample * static_cast<uint32_t>(plan.samples) + static_cast<uint32_t>(k), c, in.limits, counts);
      sum += value;
      counts.following[c.technique] += counts.rays() - rays;
      if (record)
        record->add(plan.integrand == Integrand::kSplit && c.technique == kCosine, std::abs(luminance(value)) / c.scale,
                    c.p, n, techniquesFor(plan.integrand, c.technique), c.set);
    }
  }
  if (candidate) candidate->addTo(*candidates, in.cost);
  return sum;
}

template <uint32_t N>
void renderTile(const KernelInput& in, const Tile& tile, FilmBuffer& film, Pilot* pilot, Counts& counts) {
  const float exposure = in.scene.scene.film.exposure;
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      const int px = x * in.side + in.x0, py = y * in.side + in.y0;
      const auto side = static_cast<float>(in.side);
      const uint32_t key = in.sampler.pixelKey(static_cast<uint32_t>(px), static_cast<uint32_t>(py));
      const size_t index = static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x);
      Pixel& pixel = film.pixels[index];
      const PixelFractions* allocated = in.perPixel != nullptr ? &in.perPixel->at(x, y) : nullptr;
      CandidateSums* candidates = pilot != nullptr && !pilot->candidates.empty() ? &pilot->candidates[index] : nullptr;
      HitMoments* moments = pilot != nullptr && !pilot->moments.empty() ? &pilot->moments[index] : nullptr;
      PilotPixel* pilotPixel = pilot != nullptr ? &pilot->pixels[index] : nullptr;
      for (uint32_t s = tile.firstSample; s < tile.firstSample + tile.samples; ++s) {
        const Vec2f offset = in.filter.sample(in.sampler.get2D(key, kFilmPoint, s));
        const Vec2f lens = in.camera.needsLens() ? in.sampler.get2D(key, kLensPoint, s) : Vec2f{};
        const Ray ray = in.camera.ray(static_cast<float>(px) + side * (0.5f + offset.x),
                                      static_cast<float>(py) + side * (0.5f + offset.y), lens);
        const Rgb value =
            cameraSample<N>(in, ray, key, s, allocated, pixel, pilotPixel, moments, candidates, counts) * exposure;
        if (counts.rare.admit(value, in.least)) pixel.add(value);
      }
    }
}

}  // namespace wardmis
