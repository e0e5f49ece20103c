// SPDX-License-Identifier: GPL-3.0-or-later
// The estimator at one vertex, in three steps: samples of every technique are drawn, those that bring anything are
// traced, and what they meet is weighed by MIS.
#pragma once

#include <cstddef>
#include <limits>
#include <type_traits>

#include "integrate/connect.h"
#include "integrate/counts.h"
#include "integrate/draw.h"
#include "integrate/watch.h"
#include "mis/allocation.h"

namespace wardmis {

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

// T: double for sharp lobes. Watch: of watch.h. Continuations are kept only if N needs bounces.
template <uint32_t N, class T, size_t K, class Watch>
class HitEstimate {
  using Of = Techniques<K>;
  using Values = PerIntegrand<Rgb, K>;
  using X = InteractionOf<SurfaceOf<N, K>>;
  static constexpr size_t kLobes = Of::kLobes, kCosine = Of::kCosine, kLight = Of::kLight;
  static constexpr bool kGeneral = Draws<N, T, K>::kGeneral;
  static constexpr bool kConnects = (N & kNeedsConnections) != 0;
  static constexpr TechniqueMask kAny = Of::kAll, kByLight = maskOf(kLight),
                                 kBySurface = static_cast<TechniqueMask>(kAny & ~kByLight);

 public:
  HitEstimate(const RenderScene& world, const Sampler& sampler, const X& x, const HitPlan<K>& plan, Counts& counts,
              Watch watch, Continuations<K>& continuations)
      : world_(world),
        x_(x),
        plan_(plan),
        counts_(counts),
        watch_(watch),
        continuations_(continuations),
        split_(plan.integrand == Integrand::kSplit),
        present_(integrandsOf<N, K>(x)),
        wo_(localView(x)),
        view_(lightsAt<N>(world, x)),
        sampler_(samplerOf(sampler)),
        mixture_(plan.fractions, plan.samples, plan.weights),
        draws_(world, sampler, x, plan, view_, present_, wo_) {}

  // The direct light that x sends back along its ray.
  Rgb operator()() {
    evaluateBatch();
    size_t t = 0;
    for (int k = 0, begin = 0; k < draws_.count; ++k) {
      while (k >= draws_.end[t]) begin = draws_.end[t++];
      ++counts_.samples[t];
      if (t < kLobes && !present_[t]) continue;
      if (!kGeneral && !(draws_.batch.wi(k).z > T(0))) continue;  // below the surface: zero, and it counts
      Sample s(k, t, (k - begin) % kSets);
      if (!evaluate(s)) continue;
      if (t == kLight)
        traceLight(s);
      else
        traceSurface(s);
    }
    if constexpr (kConnects)
      if (plan_.camera != nullptr) connectLight();
    if constexpr (Watch::kWatches)
      if (watch_.moments != nullptr)
        for (Moments<K>& m : watch_.moments->of) m.hits += 1;
    return sum_;
  }

 private:
  struct Sample {
    Sample(int number, size_t of, int inSet) : k(number), technique(of), set(inSet) {}

    int k;
    size_t technique;
    int set;              // of the pilot's
    Values f{};           // of each integrand, f cos
    LitOtherwise<K> lit;  // where samples of lights bring something else
    Fractions<K> p{};     // densities of the techniques
    float counted = 0;    // that of the light as Cycles counts it
    // of paths from the lights that bring the same: Mixture::scale()
    [[no_unique_address]] std::conditional_t<kConnects, Ways, std::nullptr_t> others{};
    bool sharp = false;  // a lobe's of one direction
    // of a sharp lobe's where paths from lights may take it, spread() of that; 0: they may not
    [[no_unique_address]] std::conditional_t<kConnects, float, std::nullptr_t> spread{};
    bool ahead = true;  // it leaves the surface on the viewer's side
    float moved = 0;    // how far light samples are, near the edge of the surface's own shadow
    TechniqueMask own() const { return sharp ? maskOf(technique) : kAny; }
    bool otherwise() const { return kGeneral && lit.any; }
  };

  // Of what paths from the lights alone want.
  using OwnSampler = std::conditional_t<kConnects, const Sampler&, std::nullptr_t>;
  static OwnSampler samplerOf(const Sampler& sampler) {
    if constexpr (kConnects)
      return sampler;
    else
      return nullptr;
  }
  static Vec3<T> localView(const X& x) {
    const Vec3f wo = x.frame.toLocal(x.wo);
    return {T(wo.x), T(wo.y), T(wo.z)};
  }

  // ---- f cos and densities ----

  // Of Ward's lobe all directions in one loop, if they are many enough.
  void evaluateBatch() {
    if constexpr (!kGeneral) {
      bool lobes = false;
      for (size_t l = 0; l < kLobes; ++l) lobes = lobes || present_[l];
      vectorised_ = lobes && draws_.count >= kVectorised;
      for (size_t l = 0; l < kLobes; ++l)
        if (vectorised_ && present_[l]) x_.surface.evaluateLobe(l, wo_, draws_.batch, draws_.count);
    }
  }

  // False where the sample is zero.
  bool evaluate(Sample& s) {
    const Vec3<T> wi = draws_.batch.wi(s.k);
    const auto direction = [&] { return s.technique == kLight ? draws_.light[s.k].direction : inWorld(x_, wi); };
    if (x_.smooth.cutoff > 0 && mixture_.n[kLight] > 0) [[unlikely]]
      s.moved = x_.smooth.amount(static_cast<float>(wi.z), dot(x_.geometric, direction()));
    if constexpr (kGeneral)
      return evaluateLobes(s, wi, dot(x_.geometric, direction()));
    else
      return evaluateWard(s, wi);
  }

  // side: the cosine of the direction and the geometric normal.
  bool evaluateLobes(Sample& s, const Vec3<T>& wi, float side) {
    const size_t t = s.technique;
    s.ahead = side > 0;
    // on the other side a lobe has no density of its own, whatever others have there: zero, and it counts
    if (!(side != 0) || (t == kCosine && !s.ahead)) return false;
    if (t < kLobes && (draws_.lobe[s.k].lost || draws_.lobe[s.k].transmits == s.ahead)) return false;
    s.sharp = t < kLobes && x_.surface.delta(t);
    FByComponent<K>* by = nullptr;
    if constexpr (Watch::kWatches)
      if (watch_.light != nullptr) [[unlikely]]
        by = &byComponent_, by->clear();
    if (s.sharp) {
      s.f[t] = x_.surface.weight(draws_.lobe[s.k], wi, wo_);
      s.p[t] = 1;
      if constexpr (kConnects) ofLobe(s, wi);
      if (by != nullptr) [[unlikely]]
        by->add(t, x_.surface.component(draws_.lobe[s.k]), s.f[t]);
      return true;
    }
    x_.surface.evaluate(wi, wo_, s.ahead, s.f, s.p, s.lit, by);
    if (t != kLight && !(s.p[t] > 0)) return false;
    for (size_t l = 0; l < kLobes; ++l)
      counts_.underflows += present_[l] && s.p[l] < std::numeric_limits<float>::min() ? 1 : 0;
    return true;
  }

  bool evaluateWard(Sample& s, const Vec3<T>& wi) {
    const auto& surface = x_.surface;
    for (size_t l = 0; l < kLobes; ++l) {
      if (!present_[l]) continue;
      const WardValue<T> value = vectorised_ ? draws_.batch.value(l, s.k) : surface.evaluateLobe(l, wi, wo_);
      counts_.underflows += value.pdf < std::numeric_limits<T>::min() ? 1 : 0;
      s.f[l] = surface.lobeWeight(l) * static_cast<float>(value.fCos);
      s.p[l] = static_cast<float>(value.pdf);
    }
    const float cosine = static_cast<float>(wi.z) * (1 / kPi<float>);  // f_d cos for rho_d = 1, and its density
    s.f[kCosine] = surface.diffuse * cosine;
    s.p[kCosine] = present_[kCosine] ? cosine : 0.0f;
    if (surface.terminator > 1) [[unlikely]] {
      const float left = leftAtTerminator(surface.terminator, static_cast<float>(wi.z));
      for (Rgb& value : s.f) value = value * left;
    }
    if (s.moved > 0) [[unlikely]] {
      s.lit.density = surface.diffuseStrength() * s.p[kCosine];
      for (size_t l = 0; l < kLobes; ++l) s.lit.density += surface.strength(l) * s.p[l];
    }
    return true;
  }

  // ---- trace ----

  // A sample of the light: what arrives of it.
  void traceLight(Sample& s) {
    LightSample& l = draws_.light[s.k];
    if (!(l.pdf > 0) || !(kGeneral || dot(x_.geometric, l.direction) > 0 || s.moved > 0)) return;
    if (!(maxComponent(total(s.f)) > 0) && !(s.otherwise() && maxComponent(total(s.lit.same) + total(s.lit.other)) > 0))
      return;
    world_.emitters.look(l, x_.position, static_cast<int>(plan_.vertex));
    if (!(l.pdf > 0) || isBlack(l.radiance)) return;
    Rgb radiance = l.radiance;
    if (l.shadow) {
      ++counts_.rays[kLight];
      Ray shadow = shadowRay(s, l);
      const Rgb left = transmittance<N, K>(world_, shadow);
      if (world_.learning != nullptr) [[unlikely]]
        world_.learning->note(view_.p, view_.n, l.entry, !isBlack(left));
      if (isBlack(left)) return;
      if constexpr (kGeneral) radiance *= left;
    }
    if constexpr (kConnects) s.others = byLight(s, l.emitter, l.direction, l.distance);
    if (l.exclusive) {
      weighExclusive(s, l, radiance);
    } else {
      s.p[kLight] = l.pdf, s.counted = l.counted;
      weigh(s, radiance, l.visibility);
    }
  }

  Ray shadowRay(const Sample& s, const LightSample& l) const {
    Ray shadow;
    shadow.origin = x_.leave(l.direction);
    shadow.direction = l.direction;
    shadow.kind = kCastsShadow;
    if constexpr (kGeneral) shadow.path = x_.path.shadow();
    shadow.path.time = x_.path.time;
    shadow.left = x_.primitive;
    if (s.moved > 0) [[unlikely]] {
      const Vec3f side = draws_.batch.wi(s.k).z < T(0) ? -x_.geometric : x_.geometric;
      const Placement& placed = world_.geometry.placements[x_.placement];
      const Vec3f offset = placed.motion == nullptr
                               ? shadowOffset(world_.geometry, placed, x_.smooth, side, x_.path.time)
                               : shadowOffset(world_.geometry, placed.at(x_.path.time), x_.smooth, side, x_.path.time);
      shadow.origin = x_.position + side * x_.clearance + offset * s.moved;
      if (!(dot(side, l.direction) > 0)) shadow.left = {};  // the face is in the way, where the smooth one is not
    }
    if (l.distance < 1e30f) {
      // up to the lamp, or to just before the emissive surface: from the moved origin to the same point, by way of
      // differences, since the point itself would be rounded to a place beside or behind the emitter far from the
      // origin
      const Vec3f to = l.direction * l.distance - (shadow.origin - x_.position);
      const float d = length(to);
      shadow.direction = to / d;
      shadow.tMax = l.on.valid() ? d * (1 - 1e-4f) : d;
      if (l.on.valid() && world_.accel.shared(l.on)) [[unlikely]]
        shadow.aimed = l.on, shadow.tMax = d;
    }
    return shadow;
  }

  // A sample of the surface: the light of what it meets, and the path on from there.
  void traceSurface(Sample& s) {
    const size_t t = s.technique;
    const Vec3f d = inWorld(x_, draws_.batch.wi(s.k));
    if (!kGeneral && !(dot(x_.geometric, d) > 0)) return;
    const bool diffuse = t == kCosine || (kGeneral && !draws_.lobe[s.k].glossy);
    if constexpr (kGeneral)
      if (!(maxComponent(total(s.f)) > 0)) return;
    Ray ray;
    ray.origin = x_.leave(d);
    ray.direction = d;
    ray.left = x_.primitive;
    ray.kind = !s.ahead ? kSeenByTransmission : diffuse ? kSeenByDiffuse : kSeenByGlossy;
    ray.path =
        x_.path.scattered(static_cast<uint16_t>((diffuse ? kDiffuseRay : kGlossyRay) | (s.sharp ? kSingularRay : 0) |
                                                (s.ahead ? kReflectionRay : kTransmissionRay)),
                          x_.rayLength);
    ++counts_.rays[t];
    Rgb seenThrough{1, 1, 1};
    // What light samples aim at is hidden beyond what they pass: the image must not depend on how many there are.
    const auto isHidden = [&](float pdf) {
      if constexpr (kGeneral) return !s.sharp && pdf > 0 && world_.isHidden(ray);
      return false;
    };
    const uint32_t dimension = plan_.vertex * Dimensions<K>::kPerVertex,
                   key = combine(combine(plan_.pixelKey, dimension + static_cast<uint32_t>(t)),
                                 plan_.index * uint32_t{kMaxSamplesPerHit} + static_cast<uint32_t>(s.k));
    const Hit hit = trace<N, K>(world_, ray, key, seenThrough, [&](float tMax, bool escaped) {
      const auto meet = [&](const EmitterHit& e) {
        if (isHidden(e.pdf)) return;
        s.p[kLight] = e.pdf, s.counted = e.counted;
        if constexpr (kConnects)
          s.others = e.pdf > 0 && !world_.isHidden(ray) ? byLight(s, e.emitter, d, e.distance) : Ways{};
        weigh(s, kGeneral ? e.radiance * seenThrough : e.radiance, e.visibility);
      };
      world_.emitters.along(ray, tMax, escaped, static_cast<int>(plan_.vertex), &view_, meet,
                            draws_.skyAhead ? draws_.sky[s.k] : Environment::Place{});
    });
    if (!hit.valid()) return;
    const Shape& shape = world_.geometry.shapes[hit.shape];
    const Material& m = world_.scene.materials[static_cast<size_t>(shape.material)];
    if (!isBlack(m.emission.value)) {
      const Emitters::Densities found =
          world_.emitters.trianglePdf(view_, world_.geometry.placements[hit.placement], hit, d, ray.path.time);
      s.p[kLight] = found.pdf, s.counted = found.counted;
      Rgb radiance = interact<N, K>(world_.scene, world_.geometry, ray, hit).emission;
      if constexpr (kGeneral) radiance *= seenThrough;
      if constexpr (kConnects)
        s.others = found.pdf > 0 && !world_.isHidden(ray) ? byLight(s, found.emitter, d, hit.t) : Ways{};
      if (!isHidden(found.pdf)) weigh(s, radiance, world_.geometry.placements[hit.placement].visibility);
    }
    if constexpr (kGeneral)
      if (world_.isBeyond(ray)) return;
    if constexpr ((N & kNeedsBounces) != 0)
      goOn(s, ray, hit, seenThrough, !s.ahead ? kTransmissionBounce : diffuse ? kDiffuseBounce : kGlossyBounce);
  }

  void goOn(Sample& s, const Ray& ray, const Hit& hit, Rgb seenThrough, Bounce bounce) {
    const size_t t = s.technique;
    s.p[kLight] = 0;  // no light sample covers what is reflected there
    const TechniqueMask used = techniques(t, s.own());
    const float scale = mixture_.scale(t, s.p, used);
    Rgb w = (split_ ? s.f[t] : total(s.f)) * scale;
    if constexpr (kGeneral) w *= seenThrough;
    if (!(strength(w) > 0)) return;
    noteShare(s);
    if constexpr (kConnects)
      if (plan_.camera != nullptr)
        plan_.camera->next.set(continuations_.count, endAfter(s, used, ray.direction, hit.t));
    continuations_.list.make(continuations_.count++,
                             [&] { return Continuation<K>{ray, hit, w, t, bounce, scale, used, s.set, s.p}; });
  }

  // ---- paths from the lights ----

  // A sharp lobe's sample is of that lobe alone, not of its technique's.
  void ofLobe(Sample& s, const Vec3<T>& wi) const {
    const auto& lobe = draws_.lobe[s.k];
    const float share = x_.surface.share(lobe);
    s.f[s.technique] *= share, s.p[s.technique] = share;
    if (isReversible(x_.surface.normal(lobe), x_.geometric, inWorld(x_, wi), x_.wo))
      s.spread = x_.surface.spread(lobe, wi, wo_);
  }

  // The density at which a path from the lights goes on to the viewer.
  double byLightDensity(const Sample& s, float cosLight) const {
    if (!s.sharp) return double(lightDensity<K>(x_.surface, s.p, std::abs(dot(x_.geometric, x_.wo)), cosLight));
    return s.spread > 0 ? double(sharpLightDensity<K>(x_.surface, s.p, s.spread)) : 0;
  }

  // The densities of ways to find an emitter in a direction in which paths from the lights made some of the vertices.
  Ways byLight(const Sample& s, uint32_t emitter, Vec3f direction, float distance) const {
    if (plan_.camera == nullptr) return {};
    const CameraVertex& camera = *plan_.camera;
    const float cosLight = std::abs(dot(x_.geometric, direction));
    const double rays = double(camera.light.emission.density(emitter, x_.position, direction, distance, x_.path.time));
    const WeightPower& power = camera.light.power;
    return camera.end.others(power(byLightDensity(s, cosLight)), !s.sharp) * power(rays * double(cosLight));
  }

  // What the camera's end is at the next vertex, t away, but for the cosine there.
  PathEnd endAfter(const Sample& s, TechniqueMask used, Vec3f direction, float t) const {
    const CameraVertex& camera = *plan_.camera;
    const WeightPower& power = camera.light.power;
    const float cosLight = std::abs(dot(x_.geometric, direction));
    double q = 0;
    for (size_t k = 0; k < K; ++k)
      if (has(used, k)) q += double(mixture_.n[k]) * double(s.p[k]);
    const double d2 = double(t) * double(t);
    const Join join = joinAt(plan_.vertex);
    return {join, s.sharp ? 0 : power(camera.perVertex(plan_.vertex)),
            camera.end.others(power(byLightDensity(s, cosLight)), !s.sharp) * power(double(cosLight) / d2),
            power(q / d2)};
  }

  // For a pilot. p, used: densities of the techniques that find what the sample brings; shared: with paths from the
  // lights.
  void noteWays(const Sample& s, Rgb value, const Fractions<K>& p, TechniqueMask used, bool shared) const {
    if (plan_.camera == nullptr || plan_.camera->notes == nullptr || isBlack(value)) return;
    const CameraVertex& camera = *plan_.camera;
    Ways ways = shared ? s.others : Ways{};
    ways += Ways::one(kByCamera, 1 / double(mixture_.scale(s.technique, p, used)));
    if (plan_.vertex > 0 || camera.notes->scatter == nullptr)
      return camera.note(value, ways, camera.ways.weight(kByCamera, ways.of[kByCamera], ways), plan_.vertex, 0);
    const float v = luminance(absolute(value * camera.throughput));
    camera.notes->tally.noteGroup(camera.notes->pixel, v, kByCamera);
    WayScatter& scatter = camera.notes->scatter[s.technique];
    camera.notes->tally.candidates.add(scatter.sums, v, ways);
    scatter.sum += v, scatter.squares += v * v;
  }

  void connectLight() {
    const CameraVertex& camera = *plan_.camera;
    const LightPaths& light = camera.light;
    const auto k = static_cast<uint32_t>(camera.connections(plan_.vertex));
    const auto tried = [&](int byLight, int samples) {
      if (camera.notes == nullptr || !camera.notes->tally.images) [[likely]]
        return;
      const int byCamera = static_cast<int>(plan_.vertex) + 1;
      camera.notes->tally.images->tried(camera.notes->pixel, byCamera + byLight, byCamera,
                                        static_cast<size_t>(samples));
    };
    tried(0, draws_.count);
    if (light.vertices.empty() || k == 0) return;
    const uint32_t dimension = kConnectionPoint + plan_.vertex * kConnectionsPerVertex;
    const float scale = 1 / (static_cast<float>(k) * static_cast<float>(light.kept));
    counts_.joined[plan_.vertex == 0 ? 0 : 1] += k;
    for (uint32_t m = 0; m < k; ++m) {
      const uint32_t index = plan_.index * k + m;
      const Chosen chosen = chooseVertex(camera, x_, plan_.vertex, combine(combine(plan_.pixelKey, dimension), index));
      if (!(chosen.weight > 0)) continue;
      const Vec2f bounce = light.countsBounces ? sampler_.get2D(plan_.pixelKey, dimension + 1, index) : Vec2f{};
      const LightVertex& v = light.vertices[chosen.index];
      const Connection c =
          connect<N, K>(world_, camera, x_, mixture_.n, static_cast<int>(plan_.vertex), v, bounce, counts_);
      const Rgb value = c.value * (scale * chosen.weight);
      sum_ += value;
      tried(v.length, 1);
      if (camera.notes != nullptr) [[unlikely]]
        if (!isBlack(value)) camera.note(value, c.ways, c.weight, plan_.vertex, v.length);
    }
  }

  // ---- weigh ----

  // The techniques of an integrand, of those that find what lies there.
  TechniqueMask techniques(size_t integrand, TechniqueMask among) const {
    return static_cast<TechniqueMask>(techniquesFor<K>(plan_.integrand, integrand) & among);
  }

  // Light of an emitter, whose density is in s.p.
  void weigh(const Sample& s, Rgb radiance, uint8_t visibility) {
    const bool otherwise = s.otherwise();
    if (s.sharp || !(otherwise || s.moved > 0)) {
      add(s, s.own(), s.ahead, s.f, radiance, visibility);
      return;
    }
    const float strength = x_.surface.strength(), byLight = s.lit.share(s.lit.density, s.counted, strength);
    if (s.moved > 0) {  // what light samples see from elsewhere is theirs alone
      if (s.technique == kLight)
        add(s, kByLight, s.ahead, otherwise ? s.lit.same : s.f, radiance * byLight, visibility);
      else
        add(s, kBySurface, s.ahead, s.lit.bySurface(s.f, s.counted, strength), radiance, visibility);
    } else {
      add(s, kAny, s.ahead, s.lit.blended(s.f, s.counted, strength), radiance, visibility);
    }
    if (s.technique == kLight && otherwise) add(s, kByLight, !s.ahead, s.lit.other, radiance * byLight, visibility);
  }

  // The sum of the densities of paths from the lights that bring the same.
  double othersOf(const Sample& s) const { return plan_.camera != nullptr ? plan_.camera->ways.others(s.others) : 0; }

  float scaleOf(const Sample& s, TechniqueMask used, bool shared) const {
    if constexpr (kConnects) return mixture_.scale(s.technique, s.p, used, shared ? othersOf(s) : 0);
    return mixture_.scale(s.technique, s.p, used);
  }

  // One sample's share of light, by MIS over the techniques of each integrand. among: those that find what lies there.
  void add(const Sample& s, TechniqueMask among, bool ahead, const Values& all, Rgb radiance, uint8_t visibility) {
    constexpr uint8_t kAll = kSeenBySurfaces | kSeenByTranslucence;
    const bool byAll = (visibility & kAll) == kAll;
    const Values masked = byAll ? Values{} : seen<K>(x_.surface, all, visibility, ahead);
    const Values& f = byAll ? all : masked;
    const size_t t = s.technique;
    if (!split_) {
      const Rgb value = total(f) * radiance;
      const TechniqueMask used = techniques(t, among);
      const bool shared = ahead == s.ahead && among != kByLight;
      const float scale = scaleOf(s, used, shared);
      sum_ += value * scale;
      if constexpr (kConnects) noteWays(s, value * scale, s.p, used, shared);
      note(0, value, s.p, used, s.set);
      for (size_t i = 0; i < f.size(); ++i) noteLight(i, f[i] * radiance * scale);
      return;
    }
    for (size_t i = 0; i < f.size(); ++i) {
      if (!present_[i] || (t != i && t != kLight)) continue;
      const TechniqueMask used = techniques(i, among);
      const Rgb value = f[i] * radiance;
      const float scale = mixture_.scale(t, s.p, used);
      sum_ += value * scale;
      note(i, value, s.p, used, s.set);
      noteLight(i, value * scale);
    }
    noteBoth(s, among, f, radiance);
  }

  // Light of an emitter that no other technique meets.
  void weighExclusive(const Sample& s, const LightSample& l, Rgb radiance) {
    Values each = seen<K>(x_.surface, s.otherwise() ? s.lit.same : s.f, l.visibility, s.ahead);
    if (s.otherwise()) [[unlikely]] {
      const Values more = seen<K>(x_.surface, s.lit.other, l.visibility, !s.ahead);
      for (size_t i = 0; i < each.size(); ++i) each[i] += more[i];
    }
    for (Rgb& value : each) value = value * radiance;
    float scale = 1 / (l.pdf * mixture_.n[kLight]);
    if constexpr (kConnects) {
      Fractions<K> alone{};
      alone[kLight] = l.pdf;
      scale = mixture_.scale(kLight, alone, kByLight, s.moved > 0 ? 0 : othersOf(s));
      sum_ += total(each) * scale;
      noteWays(s, total(each) * scale, alone, kByLight, !(s.moved > 0));
    } else {
      sum_ += total(each) / (l.pdf * mixture_.n[kLight]);
    }
    for (size_t i = 0; i < each.size(); ++i) noteLight(i, each[i] * scale);
    if constexpr (Watch::kWatches) {
      // which of the lights is drawn is noise, too, and no other technique covers them
      Fractions<K> alone{};
      alone[kLight] = l.pdf;
      if (split_ && watch_.moments != nullptr) {
        for (size_t i = 0; i < each.size(); ++i) note(i, each[i], alone, kByLight, s.set);
      } else {
        note(0, total(each), alone, kByLight, s.set);
      }
    }
  }

  // ---- watch ----

  void note(size_t integrand, Rgb f, const Fractions<K>& p, TechniqueMask used, int set) {
    if constexpr (Watch::kWatches) watch_.add(integrand, std::abs(luminance(f)), p, mixture_.n, used, set);
  }
  // Of samples that bring light to two integrands at once.
  void noteBoth(const Sample& s, TechniqueMask among, const Values& f, Rgb radiance) {
    if constexpr (Watch::kWatches) {
      if (watch_.candidates == nullptr || !has(among, kLight)) return;
      Fractions<K> found = s.p;
      for (size_t i = 0; i < K; ++i)
        if (!has(among, i)) found[i] = 0;
      for (size_t i = 0; i < f.size(); ++i)
        for (size_t k = i + 1; k < f.size(); ++k)
          watch_.candidates->addBoth(i, std::abs(luminance(f[i] * radiance)), k, std::abs(luminance(f[k] * radiance)),
                                     found, mixture_.n);
    }
  }
  // Calls to(component, part) for what an integrand's value is made of.
  template <class To>
  void eachComponent(size_t integrand, Rgb value, To&& to) const {
    if constexpr (kGeneral) {
      for (size_t c = 0; c < kComponents; ++c) to(static_cast<Component>(c), value * byComponent_.part(integrand, c));
    } else {
      to(integrand == kCosine ? Component::kDiffuse : Component::kGlossy, value);
    }
  }
  // What an integrand adds to the estimate.
  void noteLight(size_t integrand, Rgb value) {
    if constexpr (Watch::kWatches)
      if (watch_.light != nullptr) [[unlikely]]
        eachComponent(integrand, value, [&](Component c, Rgb part) { watch_.light->add(c, part); });
  }
  // Of what components the light of the path that goes on from a sample is.
  void noteShare(const Sample& s) {
    if constexpr (Watch::kWatches) {
      if (watch_.light == nullptr) [[likely]]
        return;
      watch_.light->share.set(continuations_.count, {});
      PerComponent& share = watch_.light->share[continuations_.count];
      const Rgb all = total(s.f);
      const auto part = [](float a, float b) { return b > 0 ? a / b : 0; };
      for (size_t i = 0; i < s.f.size(); ++i) {
        if (split_ && i != s.technique) continue;
        const Rgb of = split_ ? Rgb{1, 1, 1} : Rgb{part(s.f[i].x, all.x), part(s.f[i].y, all.y), part(s.f[i].z, all.z)};
        eachComponent(i, of, [&](Component c, Rgb its) { share[static_cast<size_t>(c)] += its; });
      }
    }
  }

  const RenderScene& world_;
  const X& x_;
  const HitPlan<K>& plan_;
  Counts& counts_;
  Watch watch_;
  Continuations<K>& continuations_;
  const bool split_;
  const PerIntegrand<bool, K> present_;
  const Vec3<T> wo_;  // local
  const LightView view_;
  [[no_unique_address]] const OwnSampler sampler_;
  const Mixture<K> mixture_;
  Draws<N, T, K> draws_;
  bool vectorised_ = false;
  Rgb sum_{0, 0, 0};
  FByComponent<K> byComponent_;  // of the sample at hand, where there are passes of light
};

// The direct light at x. record: null, or where its samples are noted.
template <uint32_t N, size_t K>
Rgb estimateHit(const RenderScene& world, const Sampler& sampler, const InteractionOf<SurfaceOf<N, K>>& x,
                const HitPlan<K>& plan, Counts& counts, const HitRecord<K>* record, Continuations<K>& more) {
  if ((N & kNeedsSpecular) != 0 && x.surface.needsDouble(dot(x.frame.z, x.wo)))
    return HitEstimate<N, double, K, HitRecord<K>>(world, sampler, x, plan, counts,
                                                   record != nullptr ? *record : HitRecord<K>{}, more)();
  if (record != nullptr)
    return HitEstimate<N, float, K, HitRecord<K>>(world, sampler, x, plan, counts, *record, more)();
  return HitEstimate<N, float, K, Unwatched>(world, sampler, x, plan, counts, {}, more)();
}

}  // namespace wardmis
