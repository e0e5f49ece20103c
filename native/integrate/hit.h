// SPDX-License-Identifier: GPL-3.0-or-later
// The estimator at one hit: the samples of every technique as one batch, evaluated together, then traced.
#pragma once

#include <cstddef>
#include <limits>
#include <numeric>

#include "integrate/trace.h"
#include "math/check.h"
#include "math/random.h"
#include "math/scratch.h"
#include "math/warp.h"
#include "mis/allocation.h"
#include "mis/candidates.h"

namespace wardmis {

inline constexpr int kMaxSamplesPerHit = 256;

// What a render counts, by technique.
struct Counts {
  using PerTechnique = std::array<uint64_t, kMaxTechniques>;
  PerTechnique samples{};    // at the first hit
  PerTechnique rays{};       // traced for samples; of the light: shadow rays
  PerTechnique following{};  // rays of the paths that went on from samples of each technique
  uint64_t cameraRays = 0;
  // Directions above the surface at which a lobe's density is no normal number: e^-E is smaller than any.
  uint64_t underflows = 0;
  RareCounts rare;

  static uint64_t sum(const PerTechnique& c) { return std::accumulate(c.begin(), c.end(), uint64_t{0}); }
  uint64_t allRays() const { return cameraRays + sum(rays); }
  Counts& operator+=(const Counts& b) {
    for (size_t i = 0; i < kMaxTechniques; ++i)
      samples[i] += b.samples[i], rays[i] += b.rays[i], following[i] += b.following[i];
    cameraRays += b.cameraRays, underflows += b.underflows, rare += b.rare;
    return *this;
  }
};

// Names of the random numbers that a vertex uses; the number's dimension is vertex * Dimensions<K>::kPerVertex + name.
template <size_t K>
struct Dimensions {
  enum : uint32_t { kFilmPoint = 0, kLensPoint, kSampleCounts, kTechnique, kRoulette = kTechnique + K, kPerVertex };
};

// That of a camera sample's time: beyond those of all vertices.
inline constexpr uint32_t kTimePoint = 0x80000000u;

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

// How a hit is to be sampled.
template <size_t K>
struct HitPlan {
  Fractions<K> fractions{};  // of the techniques that this hit has
  TechniqueMask available = Techniques<K>::kAll;
  int samples = 0;  // in all; at most the batch's capacity
  Integrand integrand = Integrand::kSplit;
  Weights weights = Weights::kBalance;
  uint32_t pixelKey = 0, vertex = 0;
  uint32_t index = 0;  // of this visit, by the camera sample: nothing depends on what others met
};

// A ray of a surface technique that hit something: the path may go on from there.
template <size_t K>
struct Continuation {
  Ray ray;
  Hit hit;
  Rgb weight{0, 0, 0};  // f cos / pdf with MIS weights and counts, for light that no light sample covers
  size_t technique = 0;
  Bounce bounce = kGlossyBounce;
  float scale = 0;         // weight / (f cos)
  TechniqueMask used = 0;  // techniques that find what lies there
  int set = 0;             // of the pilot's samples
  Fractions<K> p{};        // densities of the techniques
};

template <size_t K>
struct Continuations {
  Scratch<Continuation<K>, kMaxSamplesPerHit> list;
  int count = 0;
};

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

// Where the pilot notes what the samples of a hit bring: its moments, or, for `auto`, the sums of the candidates. Of
// all light, also of what comes by way of other surfaces.
template <size_t K>
struct HitRecord {
  HitMoments<K>* moments = nullptr;
  CandidateHit<K>* candidates = nullptr;
  LightSplit* light = nullptr;

  // A sample's value f in one integrand, as for Moments::add.
  void add(size_t integrand, float f, const Fractions<K>& p, const Fractions<K>& n, TechniqueMask used, int set) {
    if (moments != nullptr) moments->of[integrand].add(f, p, n, used);
    if (candidates != nullptr) candidates->add(f, p, n, used, set);
  }
};

// Estimates the direct light at x, in double where T is (sharp lobes). Continuations are kept only if N needs bounces.
template <uint32_t N, class T, size_t K>
Rgb estimateHit(const RenderScene& world, const Sampler& sampler, const InteractionOf<SurfaceOf<N, K>>& x,
                const HitPlan<K>& plan, Counts& counts, HitRecord<K>* record, Continuations<K>& continuations) {
  constexpr size_t kLobes = Techniques<K>::kLobes, kCosine = Techniques<K>::kCosine, kLight = Techniques<K>::kLight;
  constexpr bool kGeneral = (N & kNeedsLobes) != 0;  // any lobes, else one of Ward's
  constexpr bool kSpec = (N & kNeedsSpecular) != 0, kDiff = (N & kNeedsDiffuse) != 0, kPath = (N & kNeedsBounces) != 0;
  const SurfaceOf<N, K>& s = x.surface;
  const Vec3f woFloat = x.frame.toLocal(x.wo);
  const bool split = plan.integrand == Integrand::kSplit;
  const uint32_t dimension = plan.vertex * Dimensions<K>::kPerVertex;
  const Sampler::Visit visit(sampler, plan.pixelKey, dimension, plan.index);
  const auto technique = [&](size_t t) { return dimension + Dimensions<K>::kTechnique + static_cast<uint32_t>(t); };
  const std::array<int, K> n =
      systematicCounts<K>(plan.fractions, plan.samples, visit.counts(dimension + Dimensions<K>::kSampleCounts));
  const float matte = s.strength() > 0 ? s.diffuseStrength() / s.strength() : 1;
  bool oneSided = true;  // no light goes through from behind
  if constexpr (kGeneral) oneSided = !s.transmits();
  const LightView view = world.emitters.view(x.position, oneSided ? x.geometric : Vec3f{0, 0, 0}, matte);
  Scratch<LightChoice, kMaxSamplesPerHit> lights;  // first of all, see Emitters::choose()
  for (int m = 0; m < n[kLight]; ++m)
    lights.make(m, [&] {
      return world.emitters.choose(view, visit.point<ChoicePoint>(technique(kLight), static_cast<uint32_t>(m)));
    });

  const Mixture<K> mixture(plan.fractions, plan.samples, plan.weights);
  const Vec3<T> wo{T(woFloat.x), T(woFloat.y), T(woFloat.z)};
  // the surface's own integrands; below its normal's horizon, which looks into the surface, a lobe is zero
  std::array<bool, Techniques<K>::kSurface> present{};
  if constexpr (kSpec)
    for (size_t l = 0; l < kLobes; ++l) present[l] = s.hasLobe(l) && (kGeneral || woFloat.z > 0);
  present[kCosine] = kDiff && s.hasDiffuse();

  // Draw the directions of all techniques.
  LobeBatch<T, kLobes, kMaxSamplesPerHit> batch;
  Scratch<LightSample, kMaxSamplesPerHit> light;
  using LobeSample = typename LobeSurface<K>::Sample;
  Scratch<LobeSample, kGeneral ? kMaxSamplesPerHit : 1> from;  // of which lobe
  const auto point = [&](size_t t, int m) { return visit.point<Vec2f>(technique(t), static_cast<uint32_t>(m)); };
  // what a lobe's sample chooses by, apart from its point: its dimension is the complement of that of the point
  const auto choice = [&](size_t t, int m) { return visit.choice(~technique(t), static_cast<uint32_t>(m)); };
  std::array<int, K> end{};  // of each technique's samples in the batch
  int j = 0;
  for (size_t l = 0; l < kLobes; ++l) {
    if constexpr (kSpec)
      for (int m = 0; m < n[l]; ++m) {
        const Vec2f u = point(l, m);
        if constexpr (kGeneral) {
          LobeSample chosen;
          batch.set(j, present[l] ? s.sample(l, wo, Vec2<T>{T(u.x), T(u.y)}, choice(l, m), chosen) : Vec3<T>{});
          from.set(j++, chosen);
        } else {
          batch.set(j++, s.sampleLobe(l, wo, Vec2<T>{T(u.x), T(u.y)}));
        }
      }
    end[l] = j;
  }
  if constexpr (kDiff)
    for (int m = 0; m < n[kCosine]; ++m) {
      const Vec2f u = point(kCosine, m);
      batch.set(j++, toCosineHemisphere<T>({T(u.x), T(u.y)}));
    }
  end[kCosine] = j;
  const auto inWorld = [&](const Vec3<T>& wi) {
    return normalize(
        x.frame.toWorld(Vec3f{static_cast<float>(wi.x), static_cast<float>(wi.y), static_cast<float>(wi.z)}));
  };
  for (int m = 0; m < n[kLight]; ++m) world.emitters.aim(lights[m]);
  // where surface samples look at a sky, for which they then wait no more
  const bool skyAhead = world.emitters.skyAhead();
  Scratch<Environment::Place, kMaxSamplesPerHit> skies;
  if (skyAhead)
    for (int k = 0; k < j; ++k) {
      const Vec3<T> wi = batch.wi(k);
      if (kGeneral ? dot(wi, wi) > T(0) : wi.z > T(0))  // else it is not followed
        skies.make(k, [&] { return world.emitters.skyAhead(inWorld(wi)); });
    }
  for (int m = 0; m < n[kLight]; ++m, ++j) {
    light.make(
        j, [&] { return world.emitters.sample(x.position, lights[m], static_cast<int>(plan.vertex), x.path.time); });
    const Vec3f wi = x.frame.toLocal(light[j].direction);
    batch.set(j, {T(wi.x), T(wi.y), T(wi.z)});
  }
  end[kLight] = j;
  bool lobes = false;
  for (size_t l = 0; l < kLobes; ++l) lobes = lobes || present[l];
  const bool vectorised = !kGeneral && lobes && j >= kVectorised;
  if constexpr (!kGeneral)
    for (size_t l = 0; l < kLobes; ++l)
      if (vectorised && present[l]) s.evaluateLobe(l, wo, batch, j);

  const auto note = [&](size_t integrand, Rgb f, const Fractions<K>& p, TechniqueMask used, int set) {
    if (record != nullptr) record->add(integrand, std::abs(luminance(f)), p, mixture.n, used, set);
  };
  LightSplit* const passes = record != nullptr ? record->light : nullptr;
  FByComponent<K> byComponent;  // of the sample at hand, where there are passes of light
  // Calls to(component, part) for what an integrand's value is made of.
  const auto eachComponent = [&](size_t integrand, Rgb value, auto&& to) {
    if constexpr (kGeneral) {
      for (size_t c = 0; c < kComponents; ++c) to(static_cast<Component>(c), value * byComponent.part(integrand, c));
    } else {
      to(integrand == kCosine ? Component::kDiffuse : Component::kGlossy, value);
    }
  };
  // What an integrand adds to the estimate.
  const auto noteLight = [&](size_t integrand, Rgb value) {
    if (passes != nullptr) [[unlikely]]
      eachComponent(integrand, value, [&](Component c, Rgb part) { passes->add(c, part); });
  };

  // One sample's share of an emitter's light, by MIS over the techniques of each integral. f: of each integrand, f cos.
  using Values = PerIntegrand<Rgb, K>;
  Rgb sum{0, 0, 0};
  const auto seen = [&](Values f, uint8_t visibility, bool ahead) {
    for (size_t l = 0; l < kLobes; ++l) {
      uint8_t rays = kSeenByGlossy;
      if constexpr (kGeneral) rays = s.rays(l, ahead);
      if ((visibility & rays) == 0) f[l] = {0, 0, 0};
    }
    if ((visibility & kSeenByDiffuse) == 0) f[kCosine] = {0, 0, 0};
    return f;
  };
  const auto total = [](const Values& f) {
    Rgb all = f[0];
    for (size_t i = 1; i < f.size(); ++i) all += f[i];
    return all;
  };
  constexpr TechniqueMask kAny = Techniques<K>::kAll, kByLight = maskOf(kLight),
                          kBySurface = static_cast<TechniqueMask>(kAny & ~kByLight);
  // among: those that find what lies there.
  const auto techniques = [&](size_t own, TechniqueMask among) {
    return static_cast<TechniqueMask>(techniquesFor<K>(plan.integrand, own) & among);
  };
  const auto add = [&](size_t t, TechniqueMask among, bool ahead, const Values& all, Rgb radiance,
                       const Fractions<K>& p, uint8_t visibility, int set) {
    constexpr uint8_t kAll = kSeenBySurfaces | kSeenByTranslucence;
    const bool byAll = (visibility & kAll) == kAll;
    const Values masked = byAll ? Values{} : seen(all, visibility, ahead);
    const Values& f = byAll ? all : masked;
    if (!split) {
      const Rgb value = total(f) * radiance;
      const TechniqueMask used = techniques(t, among);
      const float scale = mixture.scale(t, p, used);
      sum += value * scale;
      note(0, value, p, used, set);
      for (size_t i = 0; i < f.size(); ++i) noteLight(i, f[i] * radiance * scale);
      return;
    }
    for (size_t i = 0; i < f.size(); ++i) {
      if (!present[i] || (t != i && t != kLight)) continue;
      const TechniqueMask used = techniques(i, among);
      const Rgb value = f[i] * radiance;
      const float scale = mixture.scale(t, p, used);
      sum += value * scale;
      note(i, value, p, used, set);
      noteLight(i, value * scale);
    }
    if (record != nullptr && record->candidates != nullptr && has(among, kLight)) {
      Fractions<K> found = p;
      for (size_t i = 0; i < K; ++i)
        if (!has(among, i)) found[i] = 0;
      for (size_t i = 0; i < f.size(); ++i)
        for (size_t k = i + 1; k < f.size(); ++k)
          record->candidates->addBoth(i, std::abs(luminance(f[i] * radiance)), k, std::abs(luminance(f[k] * radiance)),
                                      found, mixture.n);
    }
  };

  size_t t = 0;
  for (int k = 0, begin = 0; k < j; ++k) {
    while (k >= end[t]) begin = end[t++];
    const int set = (k - begin) % kSets;
    ++counts.samples[t];
    const Vec3<T> wi = batch.wi(k);
    if (t < kLobes && !present[t]) continue;
    if (!kGeneral && !(wi.z > T(0))) continue;  // below the surface: zero, and it counts
    Values f{};
    LitOtherwise<K> lit;
    Fractions<K> p{};
    bool sharp = false, ahead = true;  // wi leaves the surface on the viewer's side
    float moved = 0;                   // how far light samples are, near the edge of the surface's own shadow
    if (x.smooth.cutoff > 0 && mixture.n[kLight] > 0) [[unlikely]]
      moved =
          x.smooth.amount(static_cast<float>(wi.z), dot(x.geometric, t == kLight ? light[k].direction : inWorld(wi)));
    if constexpr (kGeneral) {
      const Vec3f d = t == kLight ? light[k].direction : inWorld(wi);
      const float side = dot(x.geometric, d);
      ahead = side > 0;
      // on the other side a lobe has no density of its own, whatever others have there: zero, and it counts
      if (!(side != 0) || (t == kCosine && !ahead)) continue;
      if (t < kLobes && (from[k].lost || from[k].transmits == ahead)) continue;
      sharp = t < kLobes && s.delta(t);
      if (sharp) {
        f[t] = s.weight(from[k], wi, wo);
        p[t] = 1;
        if (passes != nullptr) [[unlikely]]
          byComponent.clear(), byComponent.add(t, s.component(from[k]), f[t]);
      } else {
        if (passes != nullptr) [[unlikely]]
          byComponent.clear();
        s.evaluate(wi, wo, ahead, f, p, lit, passes != nullptr ? &byComponent : nullptr);
        if (t != kLight && !(p[t] > 0)) continue;
        for (size_t l = 0; l < kLobes; ++l)
          counts.underflows += present[l] && p[l] < std::numeric_limits<float>::min() ? 1 : 0;
      }
    } else {
      for (size_t l = 0; l < kLobes; ++l) {
        if (!present[l]) continue;
        const WardValue<T> value = vectorised ? batch.value(l, k) : s.evaluateLobe(l, wi, wo);
        counts.underflows += value.pdf < std::numeric_limits<T>::min() ? 1 : 0;
        f[l] = s.lobeWeight(l) * static_cast<float>(value.fCos);
        p[l] = static_cast<float>(value.pdf);
      }
      const float cosine = static_cast<float>(wi.z) * (1 / kPi<float>);  // f_d cos for rho_d = 1, and its density
      f[kCosine] = s.diffuse * cosine;
      p[kCosine] = present[kCosine] ? cosine : 0.0f;
      if (s.terminator > 1) [[unlikely]] {
        const float left = leftAtTerminator(s.terminator, static_cast<float>(wi.z));
        for (Rgb& value : f) value = value * left;
      }
      if (moved > 0) [[unlikely]] {
        lit.density = s.diffuseStrength() * p[kCosine];
        for (size_t l = 0; l < kLobes; ++l) lit.density += s.strength(l) * p[l];
      }
    }

    // Light of an emitter, whose density is in p.
    const bool otherwise = kGeneral && lit.any;
    const TechniqueMask own = sharp ? maskOf(t) : kAny;
    float counted = 0;  // and the one that Cycles counts
    const auto addLight = [&](Rgb radiance, uint8_t visibility) {
      if (sharp || !(otherwise || moved > 0)) {
        add(t, own, ahead, f, radiance, p, visibility, set);
        return;
      }
      const float byLight = lit.share(lit.density, counted, s.strength());
      if (moved > 0) {  // what light samples see from elsewhere is theirs alone
        if (t == kLight)
          add(t, kByLight, ahead, otherwise ? lit.same : f, radiance * byLight, p, visibility, set);
        else
          add(t, kBySurface, ahead, lit.bySurface(f, counted, s.strength()), radiance, p, visibility, set);
      } else {
        add(t, kAny, ahead, lit.blended(f, counted, s.strength()), radiance, p, visibility, set);
      }
      if (t == kLight && otherwise) add(t, kByLight, !ahead, lit.other, radiance * byLight, p, visibility, set);
    };
    if (t == kLight) {
      LightSample& l = light[k];
      if (!(l.pdf > 0) || !(kGeneral || dot(x.geometric, l.direction) > 0 || moved > 0)) continue;
      if (!(maxComponent(total(f)) > 0) && !(otherwise && maxComponent(total(lit.same) + total(lit.other)) > 0))
        continue;
      world.emitters.look(l, x.position, static_cast<int>(plan.vertex));
      if (!(l.pdf > 0) || isBlack(l.radiance)) continue;
      Ray shadow;
      shadow.origin = x.leave(l.direction);
      shadow.direction = l.direction;
      shadow.kind = kCastsShadow;
      if constexpr (kGeneral) shadow.path = x.path.shadow();
      shadow.path.time = x.path.time;
      shadow.left = x.primitive;
      if (moved > 0) [[unlikely]] {
        const Vec3f side = wi.z < T(0) ? -x.geometric : x.geometric;
        const Placement& placed = world.geometry.placements[x.placement];
        const Vec3f offset = placed.motion == nullptr
                                 ? shadowOffset(world.geometry, placed, x.smooth, side, x.path.time)
                                 : shadowOffset(world.geometry, placed.at(x.path.time), x.smooth, side, x.path.time);
        shadow.origin = x.position + side * x.clearance + offset * moved;
        if (!(dot(side, l.direction) > 0)) shadow.left = {};  // the face is in the way, where the smooth one is not
      }
      if (l.distance < 1e30f) {
        // up to the lamp, or to just before the emissive surface: from the moved origin to the same point, by way of
        // differences, since the point itself would be rounded to a place beside or behind the emitter far from the
        // origin
        const Vec3f to = l.direction * l.distance - (shadow.origin - x.position);
        const float d = length(to);
        shadow.direction = to / d;
        shadow.tMax = l.on.valid() ? d * (1 - 1e-4f) : d;
        if (l.on.valid() && world.accel.shared(l.on)) [[unlikely]]
          shadow.aimed = l.on, shadow.tMax = d;
      }
      Rgb radiance = l.radiance;
      if (l.shadow) {
        ++counts.rays[kLight];
        const Rgb left = transmittance<N, K>(world, shadow);
        if (isBlack(left)) continue;
        if constexpr (kGeneral) radiance *= left;
      }
      if (l.exclusive) {
        Values each = seen(otherwise ? lit.same : f, l.visibility, ahead);
        if (otherwise) [[unlikely]] {
          const Values more = seen(lit.other, l.visibility, !ahead);
          for (size_t i = 0; i < each.size(); ++i) each[i] += more[i];
        }
        for (Rgb& value : each) value = value * radiance;
        sum += total(each) / (l.pdf * mixture.n[kLight]);
        const float scale = 1 / (l.pdf * mixture.n[kLight]);
        for (size_t i = 0; i < each.size(); ++i) noteLight(i, each[i] * scale);
        // which of the lights is drawn is noise, too, and no other technique covers them
        Fractions<K> alone{};
        alone[kLight] = l.pdf;
        if (split && record != nullptr && record->moments != nullptr) {
          for (size_t i = 0; i < each.size(); ++i) note(i, each[i], alone, maskOf(kLight), set);
        } else {
          note(0, total(each), alone, maskOf(kLight), set);
        }
      } else {
        p[kLight] = l.pdf, counted = l.counted;
        addLight(radiance, l.visibility);
      }
      continue;
    }

    // A surface technique: follow the ray to what it meets.
    const Vec3f d = inWorld(wi);
    if (!kGeneral && !(dot(x.geometric, d) > 0)) continue;
    const bool diffuse = t == kCosine || (kGeneral && !from[k].glossy);
    if constexpr (kGeneral)
      if (!(maxComponent(total(f)) > 0)) continue;
    Ray ray;
    ray.origin = x.leave(d);
    ray.direction = d;
    ray.left = x.primitive;
    ray.kind = !ahead ? kSeenByTransmission : diffuse ? kSeenByDiffuse : kSeenByGlossy;
    ray.path =
        x.path.scattered(static_cast<uint16_t>((diffuse ? kDiffuseRay : kGlossyRay) | (sharp ? kSingularRay : 0) |
                                               (ahead ? kReflectionRay : kTransmissionRay)),
                         x.rayLength);
    ++counts.rays[t];
    Rgb seenThrough{1, 1, 1};
    // What light samples aim at is hidden beyond what they pass: the image must not depend on how many there are.
    const auto isHidden = [&](float pdf) {
      if constexpr (kGeneral) return !sharp && pdf > 0 && world.isHidden(ray);
      return false;
    };
    const uint32_t key = combine(combine(plan.pixelKey, dimension + static_cast<uint32_t>(t)),
                                 plan.index * uint32_t{kMaxSamplesPerHit} + static_cast<uint32_t>(k));
    const Hit hit = trace<N, K>(world, ray, key, seenThrough, [&](float tMax, bool escaped) {
      const auto meet = [&](const EmitterHit& e) {
        if (isHidden(e.pdf)) return;
        p[kLight] = e.pdf, counted = e.counted;
        addLight(kGeneral ? e.radiance * seenThrough : e.radiance, e.visibility);
      };
      world.emitters.along(ray, tMax, escaped, static_cast<int>(plan.vertex), &view, meet,
                           skyAhead ? skies[k] : Environment::Place{});
    });
    if (!hit.valid()) continue;
    const Shape& shape = world.geometry.shapes[hit.shape];
    const Material& m = world.scene.materials[static_cast<size_t>(shape.material)];
    if (!isBlack(m.emission.value)) {
      const Emitters::Densities found =
          world.emitters.trianglePdf(view, world.geometry.placements[hit.placement], hit, d, ray.path.time);
      p[kLight] = found.pdf, counted = found.counted;
      Rgb radiance = interact<N, K>(world.scene, world.geometry, ray, hit).emission;
      if constexpr (kGeneral) radiance *= seenThrough;
      if (!isHidden(p[kLight])) addLight(radiance, world.geometry.placements[hit.placement].visibility);
    }
    if constexpr (kGeneral)
      if (world.isBeyond(ray)) continue;
    if constexpr (kPath) {
      p[kLight] = 0;  // no light sample covers what is reflected there
      const TechniqueMask used = techniques(t, own);
      const float scale = mixture.scale(t, p, used);
      Rgb w = (split ? f[t] : total(f)) * scale;
      if constexpr (kGeneral) w *= seenThrough;
      const Bounce bounce = !ahead ? kTransmissionBounce : diffuse ? kDiffuseBounce : kGlossyBounce;
      if (passes != nullptr && strength(w) > 0) {
        passes->share.set(continuations.count, {});
        PerComponent& share = passes->share[continuations.count];
        const Rgb all = total(f);
        const auto part = [](float a, float b) { return b > 0 ? a / b : 0; };
        for (size_t i = 0; i < f.size(); ++i) {
          if (split && i != t) continue;
          const Rgb of = split ? Rgb{1, 1, 1} : Rgb{part(f[i].x, all.x), part(f[i].y, all.y), part(f[i].z, all.z)};
          eachComponent(i, of, [&](Component c, Rgb its) { share[static_cast<size_t>(c)] += its; });
        }
      }
      if (strength(w) > 0)
        continuations.list.make(continuations.count++,
                                [&] { return Continuation<K>{ray, hit, w, t, bounce, scale, used, set, p}; });
    }
  }
  if (record != nullptr && record->moments != nullptr)
    for (Moments<K>& m : record->moments->of) m.hits += 1;
  return sum;
}

}  // namespace wardmis
