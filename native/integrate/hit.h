// SPDX-License-Identifier: GPL-3.0-or-later
// The estimator at one hit: the samples of every technique as one batch, evaluated together, then traced.
#pragma once

#include <cstddef>
#include <limits>
#include <new>

#include "integrate/interaction.h"
#include "math/check.h"
#include "math/random.h"
#include "math/warp.h"
#include "mis/allocation.h"
#include "mis/candidates.h"

namespace wardmis {

inline constexpr int kMaxSamplesPerHit = 256;

// What a render counts.
struct Counts {
  std::array<uint64_t, kTechniques> samples{};    // at the first hit
  std::array<uint64_t, kTechniques> following{};  // rays of the paths that went on from samples of each technique
  uint64_t cameraRays = 0, lobeRays = 0, cosineRays = 0, shadowRays = 0;
  // Directions above the surface at which the lobe's density is no normal number: e^-E is smaller than any.
  uint64_t underflows = 0;
  RareCounts rare;

  uint64_t rays() const { return cameraRays + lobeRays + cosineRays + shadowRays; }
  Counts& operator+=(const Counts& b) {
    for (int i = 0; i < kTechniques; ++i) samples[i] += b.samples[i], following[i] += b.following[i];
    cameraRays += b.cameraRays, lobeRays += b.lobeRays, cosineRays += b.cosineRays, shadowRays += b.shadowRays;
    underflows += b.underflows, rare += b.rare;
    return *this;
  }
};

// The built scene, read-only, shared by all threads.
struct RenderScene {
  const Scene& scene;
  const Geometry& geometry;
  const Accel& accel;
  const Emitters& emitters;
};

// A local array whose elements are made when they are first assigned: most hits use few of them.
template <class E, int Capacity>
class Scratch {
 public:
  E& operator[](int i) { return *std::launder(reinterpret_cast<E*>(storage_ + static_cast<size_t>(i) * sizeof(E))); }
  void set(int i, const E& e) { new (storage_ + static_cast<size_t>(i) * sizeof(E)) E(e); }

 private:
  alignas(E) std::byte storage_[sizeof(E) * static_cast<size_t>(Capacity)];
};

// Names of the random numbers that a vertex uses; the number's dimension is vertex * kPerVertex + name.
enum Dimension : uint32_t {
  kFilmPoint = 0,
  kLensPoint,
  kSampleCounts,
  kLobePoint,
  kCosinePoint,
  kLightPoint,
  kRoulette,
  kPerVertex
};

// How far paths go, as Cycles counts: surface hits, and how often one may go on from a sample of each technique. What a
// ray meets where that is used up still gives its own light, and reflects none.
struct PathLimits {
  int depth = 1;
  std::array<int, kTechniques> bounces{};

  bool bounce() const { return depth > 1 && (bounces[kLobe] > 0 || bounces[kCosine] > 0); }
};

// How a hit is to be sampled.
struct HitPlan {
  Fractions fractions{};  // of the techniques that this hit has
  TechniqueMask available = kAllTechniques;
  int samples = 0;  // in all; at most the batch's capacity
  Integrand integrand = Integrand::kSplit;
  Weights weights = Weights::kBalance;
  uint32_t pixelKey = 0, vertex = 0;
  uint32_t index = 0;  // of this visit, among the pixel's
  // Index of each technique's first point here: consecutive over the pixel's visits, however many a visit takes, so
  // that the sampler's points stay evenly spread under every allocation.
  std::array<uint32_t, kTechniques> firstPoint{};
};

// A ray of a surface technique that hit something: the path may go on from there.
struct Continuation {
  Ray ray;
  Hit hit;
  Rgb weight{0, 0, 0};  // f cos / pdf with MIS weights and counts, for light that no light sample covers
  Technique technique = kLobe;
  float scale = 0;  // weight / (f cos)
  int set = 0;      // of the pilot's samples
  Fractions p{};    // densities of the techniques
};

struct Continuations {
  Scratch<Continuation, kMaxSamplesPerHit> list;
  int count = 0;
};

// Moments of the two integrands (joint: of the first alone).
struct HitMoments {
  Moments specular, diffuse;

  HitMoments& operator+=(const HitMoments& b) {
    specular += b.specular, diffuse += b.diffuse;
    return *this;
  }
};

// Where the pilot notes what the samples of a hit bring: its moments, or, for `auto`, the sums of the candidates. Of
// all light, also of what comes by way of other surfaces.
struct HitRecord {
  HitMoments* moments = nullptr;
  CandidateHit* candidates = nullptr;

  // A sample's value f in one integrand (second: the diffuse one of split integrands), as for Moments::add.
  void add(bool second, float f, const Fractions& p, const Fractions& n, TechniqueMask used, int set) {
    if (moments != nullptr) (second ? moments->diffuse : moments->specular).add(f, p, n, used);
    if (candidates != nullptr) candidates->add(f, p, n, used, set);
  }
};

// Estimates the direct light at x, in double where T is (sharp lobes). Continuations are kept only if N needs bounces.
template <uint32_t N, class T>
Rgb estimateHit(const RenderScene& world, const Sampler& sampler, const Interaction& x, const HitPlan& plan,
                Counts& counts, HitRecord* record, Continuations& continuations) {
  constexpr bool kSpec = (N & kNeedsSpecular) != 0, kDiff = (N & kNeedsDiffuse) != 0, kPath = (N & kNeedsBounces) != 0;
  const Surface& s = x.surface;
  const Vec3f woFloat = x.frame.toLocal(x.wo);
  // below its normal's horizon, which looks into the surface, the lobe is zero
  const bool specular = kSpec && s.hasSpecular() && woFloat.z > 0, diffuse = kDiff && s.hasDiffuse();
  const bool split = plan.integrand == Integrand::kSplit;
  const Mixture mixture(plan.fractions, plan.samples, plan.weights);
  const uint32_t dimension = plan.vertex * kPerVertex;
  const std::array<int, kTechniques> n = systematicCounts(
      plan.fractions, plan.samples, sampler.spread1D(plan.pixelKey, dimension + kSampleCounts, plan.index));
  const Vec3<T> wo{T(woFloat.x), T(woFloat.y), T(woFloat.z)};

  // Draw the directions of all techniques.
  Batch<T, kMaxSamplesPerHit> batch;
  Scratch<LightSample, kMaxSamplesPerHit> light;
  const auto point = [&](Technique t, int m) {
    return sampler.get2D(plan.pixelKey, dimension + kLobePoint + t, plan.firstPoint[t] + static_cast<uint32_t>(m));
  };
  int j = 0;
  if constexpr (kSpec)
    for (int m = 0; m < n[kLobe]; ++m) {
      const Vec2f u = point(kLobe, m);
      batch.set(j++, wardSample<T>(wo, T(s.ax), T(s.ay), {T(u.x), T(u.y)}));
    }
  const int endLobe = j;
  if constexpr (kDiff)
    for (int m = 0; m < n[kCosine]; ++m) {
      const Vec2f u = point(kCosine, m);
      batch.set(j++, toCosineHemisphere<T>({T(u.x), T(u.y)}));
    }
  const int endCosine = j;
  for (int m = 0; m < n[kLight]; ++m, ++j) {
    light.set(j, world.emitters.sample(x.position,
                                       sampler.getChoice(plan.pixelKey, dimension + kLightPoint,
                                                         plan.firstPoint[kLight] + static_cast<uint32_t>(m)),
                                       static_cast<int>(plan.vertex)));
    const Vec3f wi = x.frame.toLocal(light[j].direction);
    batch.set(j, {T(wi.x), T(wi.y), T(wi.z)});
  }
  const bool vectorised = specular && j >= kVectorised;
  if (vectorised) evaluate(s, wo, batch, j);

  const auto note = [&](bool second, Rgb f, const Fractions& p, TechniqueMask used, int set) {
    if (record != nullptr) record->add(second, std::abs(luminance(f)), p, mixture.n, used, set);
  };

  // One sample's share of an emitter's light, by MIS over the techniques of each integral.
  Rgb sum{0, 0, 0};
  const auto add = [&](Technique t, Rgb fs, Rgb fd, Rgb radiance, const Fractions& p, uint8_t visibility, int set) {
    if ((visibility & kSeenByGlossy) == 0) fs = {0, 0, 0};
    if ((visibility & kSeenByDiffuse) == 0) fd = {0, 0, 0};
    if (!split) {
      const Rgb f = (fs + fd) * radiance;
      sum += f * mixture.scale(t, p, kAllTechniques);
      note(false, f, p, kAllTechniques, set);
      return;
    }
    if (specular && t != kCosine) {
      const Rgb f = fs * radiance;
      sum += f * mixture.scale(t, p, kSpecularTechniques);
      note(false, f, p, kSpecularTechniques, set);
    }
    if (diffuse && t != kLobe) {
      const Rgb f = fd * radiance;
      sum += f * mixture.scale(t, p, kDiffuseTechniques);
      note(true, f, p, kDiffuseTechniques, set);
    }
    if (record != nullptr && record->candidates != nullptr)
      record->candidates->addBoth(std::abs(luminance(fs * radiance)), std::abs(luminance(fd * radiance)), p, mixture.n);
  };

  for (int k = 0; k < j; ++k) {
    const Technique t = k < endLobe ? kLobe : k < endCosine ? kCosine : kLight;
    const int set = (k - (t == kLobe ? 0 : t == kCosine ? endLobe : endCosine)) % kSets;
    ++counts.samples[t];
    const Vec3<T> wi = batch.wi(k);
    if (!(wi.z > T(0)) || (t == kLobe && !specular)) continue;  // below the surface: zero, and it counts
    WardValue<T> ward{0, 0};
    if (specular) {
      ward = vectorised ? WardValue<T>{batch.specular[k], batch.lobe[k]} : evaluateWard(s, wi, wo);
      counts.underflows += ward.pdf < std::numeric_limits<T>::min() ? 1 : 0;
    }
    const float cosine = static_cast<float>(wi.z) * (1 / kPi<float>);  // f_d cos for rho_d = 1, and p_2
    const Rgb fs = s.specular * static_cast<float>(ward.fCos);
    const Rgb fd = s.diffuse * cosine;
    Fractions p{static_cast<float>(ward.pdf), diffuse ? cosine : 0.0f, 0.0f};

    if (t == kLight) {
      const LightSample& l = light[k];
      if (!(l.pdf > 0) || !(dot(x.geometric, l.direction) > 0) || isBlack(l.radiance)) continue;
      if (!(maxComponent(fs + fd) > 0)) continue;
      Ray shadow;
      shadow.origin = x.leave(l.direction);
      shadow.direction = l.direction;
      shadow.kind = kCastsShadow;
      if (l.distance < 1e30f) {
        // up to just before the emitter: from the moved origin to the same point, by way of differences, since the
        // point itself would be rounded to a place beside or behind the emitter far from the origin
        const Vec3f to = l.direction * l.distance - (shadow.origin - x.position);
        const float d = length(to);
        shadow.direction = to / d;
        shadow.tMax = d * (1 - 1e-4f);
      }
      if (l.shadow) {
        ++counts.shadowRays;
        if (world.accel.occluded(shadow)) continue;
      }
      if (l.exclusive) {
        const Rgb s0 = (l.visibility & kSeenByGlossy) != 0 ? fs * l.radiance : Rgb{};
        const Rgb d0 = (l.visibility & kSeenByDiffuse) != 0 ? fd * l.radiance : Rgb{};
        sum += (s0 + d0) / (l.pdf * mixture.n[kLight]);
        // which of the lights is drawn is noise, too, and no other technique covers them
        const Fractions alone{0, 0, l.pdf};
        if (split && record != nullptr && record->moments != nullptr) {
          note(false, s0, alone, maskOf(kLight), set);
          note(true, d0, alone, maskOf(kLight), set);
        } else {
          note(false, s0 + d0, alone, maskOf(kLight), set);
        }
      } else {
        p[kLight] = l.pdf;
        add(kLight, fs, fd, l.radiance, p, l.visibility, set);
      }
      continue;
    }

    // A surface technique: follow the ray to what it meets.
    const Vec3f d =
        normalize(x.frame.toWorld(Vec3f{static_cast<float>(wi.x), static_cast<float>(wi.y), static_cast<float>(wi.z)}));
    if (!(dot(x.geometric, d) > 0)) continue;
    Ray ray;
    ray.origin = x.leave(d);
    ray.direction = d;
    ray.kind = t == kLobe ? kSeenByGlossy : kSeenByDiffuse;
    ray.path = x.path.scattered((t == kLobe ? kGlossyRay : kDiffuseRay) | kReflectionRay, x.rayLength);
    ++(t == kLobe ? counts.lobeRays : counts.cosineRays);
    const Hit hit = world.accel.intersect(ray);
    world.emitters.along(ray, hit.t, !hit.valid(), static_cast<int>(plan.vertex), [&](const EmitterHit& e) {
      p[kLight] = e.pdf;
      add(t, fs, fd, e.radiance, p, e.visibility, set);
    });
    if (!hit.valid()) continue;
    const Shape& shape = world.geometry.shapes[hit.shape];
    const Material& m = world.scene.materials[static_cast<size_t>(shape.material)];
    if (!isBlack(m.emission.value)) {
      p[kLight] = world.emitters.trianglePdf(world.geometry.placements[hit.placement], hit, d);
      const Rgb radiance = interact<N>(world.scene, world.geometry, ray, hit).emission;
      add(t, fs, fd, radiance, p, world.geometry.placements[hit.placement].visibility, set);
    }
    if constexpr (kPath) {
      p[kLight] = 0;  // no light sample covers what is reflected there
      const float scale = mixture.scale(t, p, techniquesFor(plan.integrand, t));
      const Rgb w = (!split ? fs + fd : t == kLobe ? fs : fd) * scale;
      if (maxComponent(w) > 0) continuations.list.set(continuations.count++, {ray, hit, w, t, scale, set, p});
    }
  }
  if (record != nullptr && record->moments != nullptr)
    record->moments->specular.hits += 1, record->moments->diffuse.hits += 1;
  return sum;
}

}  // namespace wardmis
