// SPDX-License-Identifier: GPL-3.0-or-later
// Definition of the tile kernel; included by kernels.cpp alone.
#pragma once

#include <bit>
#include <optional>

#include "integrate/kernel.h"
#include "integrate/path.h"

namespace wardmis {

// Key of the random numbers of the ray that passes of data show.
inline constexpr uint32_t kFirstSample = 0x6a09e667u;

// Whether so much of a surface is there that passes of data show it and nothing behind it, as in Cycles.
template <class X>
bool showsInPasses(const X& x, const Film& film) {
  const Rgb through = x.surface.transparent;
  return !(1 - (through.x + through.y + through.z) / 3 < film.alphaThreshold);
}

// What passes of data show of one ray through the pixel's centre, Cycles' first sample: the first surface that is
// opaque enough, or where it leads no further the last one; nothing, where behind all of them is none.
template <uint32_t N, size_t K>
[[gnu::noinline]] void noteFirst(const RenderScene& world, const CameraRays& camera, const Ray& through, uint32_t key,
                                 Pixel& pixel, DataPixel* data) {
  const float nothing = pixel.depth;
  Ray ray = through;
  for (uint32_t passed = 0;; ++passed) {
    const Hit hit = world.accel.intersect(ray);
    if (!hit.valid()) {
      pixel.depth = nothing;
      if (data != nullptr) data->position = {0, 0, 0}, data->objectIndex = data->materialIndex = 0;
      return;
    }
    const Placement& placement = world.geometry.placements[hit.placement];
    if (placement.holdout) return;
    const auto x = interact<N, K>(world.scene, world.geometry, ray, hit);
    if constexpr ((N & kNeedsLobes) != 0)
      if (x.surface.holdout >= 1) return;
    pixel.depth = camera.depth(through, hit.t);
    if (data != nullptr) [[unlikely]] {
      data->position = x.position;
      data->objectIndex = placement.object != nullptr ? placement.object->index : 0;
      data->materialIndex = world.scene.materials[static_cast<size_t>(x.material)].index;
    }
    if constexpr ((N & kNeedsLobes) == 0) {
      return;
    } else {
      if (showsInPasses(x, world.scene.film) || !detail::mayPass(world, ray, hit, world.mostFollowed)) return;
      const Rgb left = x.surface.transparent;
      const float passes = std::abs(left.x + left.y + left.z) / 3;
      if (!(toUnit(combine(key, passed)) * (passes + x.surface.strength()) < passes)) return;
      ray.tMin = detail::behind(x, ray.direction, hit.t);
      ray.left = x.primitive;
      ray.path = ray.path.passed();
    }
  }
}

// Of surfaces that a sample's light goes straight through, what its passes of normals and UVs show: the first that is
// opaque enough.
class Noted {
 public:
  Noted(const RenderScene& world, Pixel& pixel, DataPixel* data) : world_(world), pixel_(pixel), data_(data) {}

  template <class X>
  void operator()(const X& x, const Hit& hit) {
    if (done_ || !showsInPasses(x, world_.scene.film)) return;
    done_ = true;
    if constexpr (requires { x.surface.normal(); })
      addTo(pixel_.normal, x.surface.normal());
    else
      addTo(pixel_.normal, x.frame.z);
    const Shape& shape = world_.geometry.shapes[hit.shape];
    if (data_ == nullptr || shape.part->uvs.empty()) return;
    const Vec2f uv = detail::uvAt(shape, hit);
    DataPixel::add(data_->uv, {uv.x, uv.y, 1});
  }

 private:
  const RenderScene& world_;
  Pixel& pixel_;
  DataPixel* data_;
  bool done_ = false;
};

// Of a sample whose camera ray meets a shadow catcher first.
struct CatcherSample {
  bool caught = false;
  Rgb before{0, 0, 0};   // what is seen before it
  Rgb through{1, 1, 1};  // what surfaces before it let through
  Rgb sky{0, 0, 0};      // behind it, or where there is nothing
};

// What a pixel's hits share their samples by: the same for all of one face in a block of visits.
template <size_t K>
class WholeFractions {
 public:
  // whole numbers over each block of visits 2^k ... 2^(k+1) - 1, over which the sampler spreads u evenly
  const Fractions<K>& of(const Fractions<K>& shares, TechniqueMask mask, int samples, uint32_t visit) {
    const uint32_t block = std::bit_floor(visit);
    if (&shares != shares_ || mask != mask_ || block != block_) {
      shares_ = &shares, mask_ = mask, block_ = block;
      fractions_ = wholeCounts<K>(restrict<K>(shares, mask), samples, block);
    }
    return fractions_;
  }

 private:
  const Fractions<K>* shares_ = nullptr;
  TechniqueMask mask_ = 0;
  uint32_t block_ = 0;
  Fractions<K> fractions_{};
};

// What a pixel's camera samples add to, besides their value; null: what is not wanted.
template <size_t K>
struct PixelSums {
  Pixel& pixel;
  DataPixel* data = nullptr;
  LightPixel* light = nullptr;
  uint32_t* taken = nullptr;  // samples of each technique
  PilotPixel* pilot = nullptr;
  HitMoments<K>* moments = nullptr;
  CandidateSums<K>* candidates = nullptr;
};

// How paths from the lights are connected to those of a pixel's camera samples; empty where there are none.
struct Unconnected {};
struct Connected {
  PixelWays counts;
  size_t pixel = 0;  // of the film
};
template <uint32_t N>
using MaybeConnected = std::conditional_t<(N & kNeedsConnections) != 0, Connected, Unconnected>;

// Radiance along one camera ray of a world. catcher: null where it is not wanted.
template <uint32_t N, size_t K>
Rgb cameraSample(const KernelInput<K>& in, const RenderScene& world, const Ray& camera, Vec2f lens, uint32_t pixelKey,
                 uint32_t sample, const PixelFractions<K>* allocated, WholeFractions<K>& whole, const PixelSums<K>& to,
                 const MaybeConnected<N>& connected, CatcherSample* catcher, Counts& counts) {
  Pixel& pixel = to.pixel;
  DataPixel* const data = to.data;
  LightPixel* light = to.light;
  ++counts.cameraRays;
  const bool transparent = world.scene.film.transparent;
  const float exposure = world.scene.film.exposure;
  Rgb sum{0, 0, 0}, seenThrough{1, 1, 1};
  bool covered = !transparent;
  Ray ray = camera;
  Noted noted{world, pixel, data};
  const auto along = [&](float tMax, bool escaped) {
    world.emitters.along(ray, std::min(tMax, ray.tMax), escaped && !transparent, 0, nullptr, [&](const EmitterHit& e) {
      sum += e.radiance * seenThrough;
      covered = true;
      if (data != nullptr) [[unlikely]]
        DataPixel::add(e.sky ? data->environment : data->emission, e.radiance * seenThrough * exposure);
    });
  };
  const Hit hit = trace<N, K>(world, ray, combine(pixelKey, ~sample), seenThrough, along, noted);
  if (data != nullptr && transparent && !hit.valid()) [[unlikely]]  // a hole for the picture, and there for its pass
    world.emitters.along(ray, ray.tMin, true, 0, nullptr, [&](const EmitterHit& e) {
      if (e.sky) DataPixel::add(data->environment, e.radiance * seenThrough * exposure);
    });
  const Placement* const met = hit.valid() ? &world.geometry.placements[hit.placement] : nullptr;
  if (catcher != nullptr) [[unlikely]] {
    *catcher = {met != nullptr && met->shadowCatcher && !met->holdout, sum, seenThrough, {}};
    if (!transparent && (catcher->caught || met == nullptr))
      world.emitters.along(ray, ray.tMin, true, 0, nullptr, [&](const EmitterHit& e) {
        if (e.sky) catcher->sky += e.radiance * seenThrough;
      });
    if (catcher->caught) {  // as Cycles has it
      if (data != nullptr) DataPixel::add(data->environment, catcher->sky * exposure);
      light = nullptr;
    }
  }
  const float shown = (seenThrough.x + seenThrough.y + seenThrough.z) / 3;  // of what is met, by what is before it
  const bool hole = met != nullptr ? met->holdout : !covered;
  pixel.alpha.add({double(hole ? 1 - shown : 1)});
  if (met == nullptr || met->holdout) return sum;

  const auto x = interact<N, K>(world.scene, world.geometry, ray, hit);
  const auto& s = x.surface;
  if constexpr ((N & kNeedsLobes) != 0)
    if (s.holdout > 0) {
      pixel.alpha.add({-double(std::min(s.holdout, 1.0f) * shown)});
      if (s.holdout >= 1) return sum;
    }
  sum += x.emission * seenThrough;
  if (data != nullptr) [[unlikely]] {
    DataPixel::add(data->emission, x.emission * seenThrough * exposure);
  }
  noted(x, hit);
  addTo(pixel.albedo, s.albedo() * seenThrough);
  const auto addLight = [&](LightPixel::Sums& sums, const PerComponent& values, Rgb by) {
    for (size_t c = 0; c < kComponents; ++c) DataPixel::add(sums[c], values[c] * by);
  };
  if (light != nullptr) [[unlikely]]
    addLight(light->color, s.colors(), seenThrough);
  const TechniqueMask mask = techniquesAt<K>(s, world.emitters.any(), world.surfaceRays);
  const PixelSurface surface{x.frame.z, x.material, x.placement};
  if (to.pilot != nullptr && to.pilot->surface.material < 0) to.pilot->surface = surface, to.pilot->techniques = mask;

  if (mask == 0 || !s.reflects()) return sum;
  if constexpr ((N & kNeedsLobes) != 0)
    if (world.isBeyond(ray)) return sum;
  HitPlan<K> plan;
  const PixelSurface* const told = to.pilot != nullptr    ? &to.pilot->surface
                                   : allocated != nullptr ? &allocated->surface
                                                          : nullptr;
  const bool follows = told == nullptr || told->holds(surface);
  const PixelFractions<K>* const own =
      allocated != nullptr && follows && covers<K>(allocated->fractions, mask) ? allocated : nullptr;
  const Fractions<K>& shares = own != nullptr ? own->fractions : in.fractions;
  plan.index = sample;
  plan.pixelKey = pixelKey;
  if (to.candidates != nullptr) {  // the pilot of `auto`: each technique alike
    plan.samples = kSets * std::popcount(mask);
    plan.fractions = restrict<K>({}, mask);
  } else if constexpr ((N & kNeedsConnections) != 0) {
    plan.samples = in.light != nullptr ? connected.counts.samples : in.samplesPerHit;
    plan.fractions = firstFractions<K>(in, s, mask);
  } else {
    plan.samples = own != nullptr ? own->samples : in.samplesPerHit;
    if (in.rule == Allocation::kAlbedo) [[unlikely]]
      plan.fractions =
          wholeCounts<K>(restrict<K>(albedoFractions<K>(s), mask), plan.samples, std::bit_floor(plan.index));
    else
      plan.fractions = whole.of(shares, mask, plan.samples, plan.index);
  }
  plan.integrand = in.integrand;
  plan.weights = in.weights;
  constexpr bool kConnects = (N & kNeedsConnections) != 0;
  using MaybeVertex = std::conditional_t<kConnects, std::optional<CameraVertex>, std::nullopt_t>;
  [[maybe_unused]] MaybeVertex first = std::nullopt;
  [[maybe_unused]] std::conditional_t<kConnects, std::optional<CameraVertex::Notes>, std::nullopt_t> notes =
      std::nullopt;
  [[maybe_unused]] std::conditional_t<kConnects, std::optional<std::array<WayScatter, K>>, std::nullopt_t> scatter =
      std::nullopt;
  if constexpr (kConnects)
    if (in.light != nullptr) {
      const LightPaths& lights = *in.light;
      const auto seen = in.camera.seen(x.position, lens, ray.path.time);
      first.emplace(lights, connected.counts);
      first->left = in.limits.bounces, first->depth = in.limits.depth;
      first->before = first->throughput = seenThrough;
      if (in.wayPilot != nullptr) [[unlikely]] {
        WayScatter* const scattered = in.wayPilot->asksCandidates() ? scatter.emplace().data() : nullptr;
        first->notes = &notes.emplace(CameraVertex::Notes{*in.wayPilot, connected.pixel, scattered});
      }
      if (seen) first->end = {kAtFilm, lights.power(lights.perPixel()), {}, lights.power(double(seen->importance))};
      first->arrive(dot(x.geometric, x.wo), seen && detail::lightReaches(world, hit));
      plan.camera = &*first;
    }
  Continuations<K> more;
  const Counts::PerTechnique before = counts.samples;
  std::optional<HitRecord<K>> record;
  LightSplit lightSplit;                      // not std::optional, which compilers clear for each camera ray ...
  Scratch<CandidateHit<K>, 1> candidateSums;  // ... nor this
  CandidateHit<K>* candidate = nullptr;
  LightSplit* const split = light != nullptr ? &lightSplit : nullptr;
  const bool piloted = to.pilot != nullptr && follows;
  if (piloted || split != nullptr) {
    if (piloted && to.candidates != nullptr)
      candidate = &candidateSums.make(0, [&] { return CandidateHit<K>(in.candidates.of(mask)); });
    record.emplace(HitRecord<K>{piloted ? to.moments : nullptr, candidate, split});
  }
  sum += estimateHit<N, K>(world, in.sampler, x, plan, counts, record ? &*record : nullptr, more) * seenThrough;
  if (split != nullptr) [[unlikely]]
    addLight(light->direct, split->direct, seenThrough * exposure);
  if constexpr (kConnects)
    for (size_t t = 0; scatter && t < K; ++t)
      (*scatter)[t].addTo(in.wayPilot->pixels[connected.pixel].sums, static_cast<int>(counts.samples[t] - before[t]));
  if (to.taken != nullptr)
    for (size_t i = 0; i < K; ++i) to.taken[i] += static_cast<uint32_t>(counts.samples[i] - before[i]);
  if constexpr ((N & kNeedsBounces) != 0) {
    const Fractions<K> n = record ? Mixture<K>(plan.fractions, plan.samples, plan.weights).n : Fractions<K>{};
    float surfaceSamples = 0;
    for (size_t i = 0; i < Techniques<K>::kSurface; ++i)
      surfaceSamples += plan.fractions[i] * static_cast<float>(plan.samples);
    const float mean = s.strength() / surfaceSamples;
    const Sampler::Visit visit(in.sampler, pixelKey, 0, sample);
    for (int k = 0; k < more.count; ++k) {
      Continuation<K>& c = more.list[k];
      if (!goesOn(c, mean, visit.choice(Dimensions<K>::kRoulette, static_cast<uint32_t>(k)))) continue;
      const uint64_t rays = counts.allRays();
      CameraVertex* onward = nullptr;
      [[maybe_unused]] MaybeVertex next = std::nullopt;
      if constexpr (kConnects)
        if (first) {
          onward = &next.emplace(first->light, first->ways);
          next->end = first->next[k], next->depth = first->depth;
          next->before = seenThrough, next->notes = first->notes;
        }
      const Rgb value = followPath<N, K>(world, in.sampler, pixelKey,
                                         sample * static_cast<uint32_t>(plan.samples) + static_cast<uint32_t>(k), c,
                                         in.limits, onward, counts);
      sum += value * seenThrough;
      counts.following[c.technique] += counts.allRays() - rays;
      if (split != nullptr) [[unlikely]]
        addLight(light->indirect, split->share[k], value * seenThrough * exposure);
      if (record)
        record->add(plan.integrand == Integrand::kSplit ? c.technique : 0, std::abs(luminance(value)) / c.scale, c.p, n,
                    c.used, c.set);
    }
  }
  if (candidate != nullptr) candidate->addTo(*to.candidates, in.cost);
  return sum;
}

// Adds to a pixel's sums what `value`, of a camera sample that is told in `seen`, is with shadow catchers. again: the
// same sample where they are alone; writes what it is told.
template <class Again>
[[gnu::noinline]] void addCatchers(CatcherPixel& sums, Rgb value, float exposure, double alpha,
                                   const CatcherSample& seen, const Again& again) {
  DataPixel::add(sums.sky, seen.sky * exposure);
  if (!seen.caught) {
    sums.covered.add({alpha});
    return;
  }
  const Rgb through = seen.through;
  sums.covered.add({1 - double(through.x + through.y + through.z) / 3});
  ++sums.caught;
  DataPixel::add(sums.light, value - seen.before * exposure);
  CatcherSample alone;
  const Rgb without = again(alone);
  const auto part = [](float a, float b) { return b != 0 ? a / b : 0; };
  const Rgb unseen = alone.through;
  if (alone.caught)
    DataPixel::add(sums.alone,
                   (without - alone.before) * exposure *
                       Rgb{part(through.x, unseen.x), part(through.y, unseen.y), part(through.z, unseen.z)});
}

// What paths from the lights have brought to a pixel.
template <uint32_t N, size_t K>
Rgb lightToFilm(const KernelInput<K>& in, size_t pixel) {
  if constexpr ((N & kNeedsConnections) != 0)
    if (in.light != nullptr && !in.light->film.empty()) return in.light->film[pixel];
  return {0, 0, 0};
}

template <uint32_t N, size_t K>
void renderTile(const KernelInput<K>& in, const Tile& tile, FilmBuffer& film, Pilot<K>* pilot, Counts& counts) {
  const float exposure = in.scene.scene.film.exposure, height = static_cast<float>(in.scene.scene.film.height);
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      const int px = x * in.side + in.x0, py = y * in.side + in.y0;
      const auto side = static_cast<float>(in.side);
      const uint32_t key = in.sampler.pixelKey(static_cast<uint32_t>(px), static_cast<uint32_t>(py));
      const size_t index = static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x);
      Pixel& pixel = film.pixels[index];
      const PixelFractions<K>* allocated = in.perPixel != nullptr ? &in.perPixel->at(x, y) : nullptr;
      WholeFractions<K> whole;
      PixelSums<K> sums{pixel};
      if (!film.data.empty()) sums.data = &film.data[index];
      if (!film.light.empty()) sums.light = &film.light[index];
      sums.taken = &film.sampleCounts[index * K];
      if (pilot != nullptr) {
        sums.pilot = &pilot->pixels[index];
        if (!pilot->moments.empty()) sums.moments = &pilot->moments[index];
        if (!pilot->candidates.empty()) sums.candidates = &pilot->candidates[index];
      }
      MaybeConnected<N> connected;
      [[maybe_unused]] Counts::Join before{};
      if constexpr ((N & kNeedsConnections) != 0)
        if (in.light != nullptr) connected = {in.waysAt(x, y), index}, before = counts.join();
      const uint64_t raysBefore = film.rays.empty() ? 0 : counts.allRays();
      const uint32_t end = film.shares.count(index, tile.last);
      for (uint32_t s = film.shares.count(index, tile.first); s < end; ++s) {
        const Vec2f offset = in.filter.sample(Sampler::Visit(in.sampler, key, 0, s).film(Dimensions<K>::kFilmPoint));
        const Vec2f lens = in.camera.needsLens() ? in.sampler.get2D(key, Dimensions<K>::kLensPoint, s) : Vec2f{};
        float time = kMiddle;
        if (in.shutter != nullptr) [[unlikely]]
          time = in.shutter->at(in.sampler.get1D(key, kTimePoint, s), static_cast<float>(py) / height);
        const auto through = [&](Vec2f at) {
          return in.camera.ray(static_cast<float>(px) + side * (0.5f + at.x),
                               static_cast<float>(py) + side * (0.5f + at.y), lens, time);
        };
        const Ray ray = through(offset);
        if (s == 0)
          if (const Ray central = through({0, 0}); central.tMax > 0)
            noteFirst<N, K>(in.scene, in.camera, central, combine(key, kFirstSample), pixel, sums.data);
        if (!(ray.tMax > 0)) [[unlikely]] {
          pixel.alpha.add({1});  // black, and no hole in the picture, as Cycles has it
          pixel.add(lightToFilm<N, K>(in, index) * exposure);
          continue;
        }
        if (film.catchers.empty()) [[likely]] {
          Rgb value =
              cameraSample<N, K>(in, in.scene, ray, lens, key, s, allocated, whole, sums, connected, nullptr, counts);
          if constexpr ((N & kNeedsConnections) != 0) value += lightToFilm<N, K>(in, index);
          value = value * exposure;
          if (counts.rare.admit(value, in.least)) pixel.add(value);
          continue;
        }
        // the same points in both worlds, so that where catchers have no shadow the quotient is 1
        Pixel again = pixel;
        CatcherSample seen;
        const Rgb value =
            cameraSample<N, K>(in, in.scene, ray, lens, key, s, allocated, whole, sums, connected, &seen, counts) *
            exposure;
        if (!counts.rare.admit(value, in.least)) continue;
        pixel.add(value);
        addCatchers(film.catchers[index], value, exposure, pixel.alpha[0] - again.alpha[0], seen,
                    [&](CatcherSample& alone) {
                      return cameraSample<N, K>(in, *in.catchers, ray, lens, key, s, allocated, whole,
                                                PixelSums<K>{again}, connected, &alone, counts);
                    });
      }
      if constexpr ((N & kNeedsConnections) != 0)
        if (in.wayPilot != nullptr) [[unlikely]] {
          const Counts::Join after = counts.join();
          WayTally::Pixel& noted = in.wayPilot->pixels[index];
          noted.rays += static_cast<float>(after.rays - before.rays);
          for (size_t i = 0; i < 2; ++i) noted.joined[i] += static_cast<float>(after.joined[i] - before.joined[i]);
        }
      if (!film.rays.empty()) film.rays[index] += static_cast<uint32_t>(counts.allRays() - raysBefore);
    }
}

}  // namespace wardmis
