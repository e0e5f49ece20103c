// SPDX-License-Identifier: GPL-3.0-or-later
// The reflecting and transmitting surface at one hit: any lobes, each with a normal of its own, shared out among the K
// techniques: what is sampled by the cosine goes to that one, every other lobe has its own as long as there are enough.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "bsdf/bump_shadow.h"
#include "bsdf/closure.h"
#include "bsdf/energy.h"
#include "bsdf/lobe.h"
#include "bsdf/shadow_terminator.h"
#include "math/component.h"
#include "math/scratch.h"
#include "mis/technique.h"
#include "world/geometry.h"

namespace wardmis {

// f cos of what samples of lights bring, by technique, where it is not what samples of the surface bring, as in Cycles:
// of lobes to whose normal light leaves on the same side as to the face, and on the other. Among
// them what unseen() of lobe.h tells. `strays`: what of the samples of the surface is none of it, each with a density
// of its own.
template <size_t K>
struct LitOtherwise {
  std::array<Rgb, K - 1> same{}, other{};
  struct Stray {
    Rgb f;
    float density;
    uint8_t slot;
  };
  static constexpr int kMostStrays = 4;
  Scratch<Stray, kMostStrays> stray;
  int strays = 0;
  float density = 0;  // of all lobes, wherever they may leave, times their strengths; as Cycles counts it
  bool any = false;
  // The part of light that light samples, of density `light`, bring where surface samples of this strength find it,
  // too: Cycles' power heuristic, which is all that is left where it lets the latter find nothing.
  static float share(float density, float light, float strength) {
    const float ratio = density / (strength * light);
    return density > 0 ? 1 / (1 + ratio * ratio) : 1;
  }
  // Of light along a direction that both find, what belongs to each integrand; f: of surface samples, all of it.
  std::array<Rgb, K - 1> blended(const std::array<Rgb, K - 1>& f, float light, float strength) const {
    const float byLight = share(density, light, strength);
    std::array<Rgb, K - 1> sum = bySurface(f, light, strength);
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += same[i] * byLight;
    return sum;
  }
  // The part of it that is surface samples'.
  std::array<Rgb, K - 1> bySurface(const std::array<Rgb, K - 1>& f, float light, float strength) const {
    const float byLight = share(density, light, strength);
    std::array<Rgb, K - 1> sum;
    for (size_t i = 0; i < sum.size(); ++i) sum[i] = f[i] * (1 - byLight);
    for (int k = 0; k < strays; ++k)
      sum[stray[k].slot] += stray[k].f * (byLight - share(stray[k].density, light, strength));
    return sum;
  }
};

// f cos of each technique's lobes by what they are to passes of light: a technique that several share may be more than
// one thing.
template <size_t K>
struct FByComponent {
  std::array<PerComponent, K - 1> of;
  void clear() { of.fill({}); }
  void add(size_t slot, Component c, Rgb f) { of[slot][static_cast<size_t>(c)] += f; }
  // The part of a technique's value that is component c's, by channel; they sum to 1 where there is any.
  Rgb part(size_t slot, size_t c) const {
    const Rgb sum = of[slot][0] + of[slot][1] + of[slot][2], &one = of[slot][c];
    const auto ratio = [](float a, float b) { return b != 0 ? a / b : 0; };
    return {ratio(one.x, sum.x), ratio(one.y, sum.y), ratio(one.z, sum.z)};
  }
};

template <size_t K>
class LobeSurface {
 public:
  static constexpr size_t kCosine = Techniques<K>::kCosine, kSlots = Techniques<K>::kLobes;
  static constexpr int kMostLobes = 24, kMostFrames = 8;

  float terminator = 1;      // as of shadow_terminator.h; what goes through the surface is as it is
  float holdout = 0;         // how much of it is a hole for the camera
  Rgb transparent{0, 0, 0};  // of the light that goes straight through, what arrives

  // frame: the surface's own; wo in world space, unit; mixes: see straight(); defended: no lobe is drawn less often
  // than once in nine times.
  void begin(const Framef& frame, Vec3f wo, bool mixes = false, bool defended = false) {
    count_ = 0, frames_ = 0, mixes_ = mixes, defended_ = defended, plain_ = true, least_ = 0;
    transparent = {0, 0, 0}, diffuse_ = {0, 0, 0}, holdout = 0;
    wo_ = wo;
    addFrame(frame);
  }
  // A frame for lobes to refer to; the last one again where there are too many. bump: the version by whose rules its
  // normal, which is not the surface's own, is in shadow; 0: it is the own one.
  uint8_t addFrame(const Framef& frame, int bump = 0) {
    const int i = std::min(frames_, kMostFrames - 1);
    frame_.set(i, frame);
    bump_[i] = static_cast<uint8_t>(bump);
    if (bump > 0) ownCosine_[i] = dot(frame_[0].z, frame.z), plain_ = false;
    frames_ = i + 1;
    return static_cast<uint8_t>(i);
  }
  float cosine(uint8_t frame) const { return dot(frame_[frame].z, wo_); }

  void add(const Lobe& lobe) {
    if (lobe.kind == LobeKind::kTransparent) {
      transparent += lobe.weight;
      return;
    }
    // what has no direction but the normal needs no frame of its own for another tangent
    const bool own = lobe.frame != 0 && !(detail::isDiffuse(lobe.kind) && frame_[lobe.frame].z == frame_[0].z);
    if (lobe.kind == LobeKind::kLambert && !own) {
      diffuse_ += lobe.weight;
    } else if (count_ < kMostLobes) {
      lobe_.set(count_, lobe);
      if (!own) lobe_[count_].frame = 0;
      lobe_[count_].defended = defended_ && lobe.refractsUp;
      plain_ = plain_ && isPlain(lobe);
      ++count_;
    }
  }
  // Shares the lobes out among the techniques, by their classes or in their order; those that are too many share one.
  void finish(const LobeNumbers& numbers) {
    strength_.fill(0), delta_.fill(false), reflection_.fill(0), transmission_.fill(0);
    strength_[kCosine] = luminance(diffuse_);
    std::array<float, kMostLobes> strength;
    size_t rough = 0, sharp = 0;
    LobeCounts of{};
    for (int i = 0; i < count_; ++i) {
      strength[i] = strengthOf(lobe_[i]);
      if (byCosine(lobe_[i])) continue;
      ++(isDelta(lobe_[i].kind) ? sharp : rough);
      ++of[static_cast<size_t>(classOf(lobe_[i].kind))];
    }
    if (defended_) {
      float sum = strength_[kCosine] + luminance(transparent);
      for (int i = 0; i < count_; ++i) sum += strength[i];
      least_ = 0.125f * sum;
      for (int i = 0; i < count_; ++i) strength[i] = std::max(strength[i], least_);
      if (strength_[kCosine] > 0) strength_[kCosine] = std::max(strength_[kCosine], least_);
    }
    bool byClass = numbers.byClass;
    for (size_t c = 0; c < kLobeClasses; ++c) byClass = byClass && of[c] <= numbers.count[c];
    // sharp ones never share with others: one technique is theirs at least
    const size_t forRough = std::min(rough, kSlots - (sharp > 0 ? 1 : 0)),
                 forSharp = std::min(sharp, kSlots - forRough);
    size_t nextRough = 0, nextSharp = forRough;
    LobeCounts next = numbers.first;
    for (int i = 0; i < count_; ++i) {
      const bool delta = isDelta(lobe_[i].kind);
      size_t slot = kCosine;
      if (!byCosine(lobe_[i]))
        slot = byClass ? next[static_cast<size_t>(classOf(lobe_[i].kind))]++
               : delta ? std::min(nextSharp++, forRough + forSharp - 1)
                       : std::min(nextRough++, forRough - 1);
      if (delta) delta_[slot] = true;
      slot_[i] = static_cast<uint8_t>(slot);
      strength_[slot] += strength[i];
      const bool matte = isMatte(lobe_[i].kind);
      reflection_[slot] |= matte ? kSeenByDiffuse : kSeenByGlossy;
      transmission_[slot] |= matte ? kSeenByTranslucence : kSeenByTransmission;
    }
    for (int i = 0; i < count_; ++i) share_[i] = strength_[slot_[i]] > 0 ? strength[i] / strength_[slot_[i]] : 1;
  }

  // What rays find of the light that goes straight through. Cycles 3.4 takes the one direction for one among those of
  // the other lobes, and adds their densities and their light to it.
  Rgb straight() const {
    if (!mixes_ || isBlack(transparent)) return transparent;
    LitOtherwise<K> lit;
    std::array<Rgb, K - 1> f{};
    Fractions<K> p{};
    const Vec3f wo = frame_[0].toLocal(wo_);
    evaluate(-wo, wo, false, f, p, lit);
    Rgb all = transparent;
    for (size_t i = 0; i < f.size(); ++i) all += lit.same[i] + lit.other[i];
    const float own = std::max(luminance(absolute(transparent)), least_);
    return all * (own / (own + lit.density));
  }

  bool hasLobe(size_t slot) const { return strength_[slot] > 0; }
  bool hasDiffuse() const { return strength_[kCosine] > 0; }
  bool reflects() const {
    return std::any_of(strength_.begin(), strength_.end(), [](float s) { return s > 0; });
  }
  bool transmits() const {
    return anyLobe([](const Lobe& l) { return wardmis::transmits(l.kind); });
  }
  bool delta(size_t slot) const { return delta_[slot]; }
  // The kinds of ray, of Visibility, that a technique's lobes send to the viewer's side or to the other.
  uint8_t rays(size_t slot, bool ahead) const { return ahead ? reflection_[slot] : transmission_[slot]; }
  // About the share of light from all around that it sends to the viewer.
  float strength(size_t slot) const { return strength_[slot]; }
  float strength() const { return std::accumulate(strength_.begin(), strength_.end(), 0.0f); }  // of all
  float diffuseStrength() const { return strength_[kCosine]; }
  Rgb albedo() const {
    Rgb sum = diffuse_;
    for (int i = 0; i < count_; ++i) sum += albedoOf(lobe_[i]);
    return sum;
  }
  // The mean of the lobes' normals, unit, in world space, which Cycles shows in passes.
  Vec3f normal() const {
    Vec3f sum = frame_[0].z * (meanOf(diffuse_) + meanOf(transparent));
    for (int i = 0; i < count_; ++i) {
      const Lobe& l = lobe_[i];
      sum += frame_[l.frame].z * (l.closure < 0 ? meanOf(l.weight / l.compensation) : l.closure);
    }
    const float length2 = dot(sum, sum);
    return length2 > 0 ? sum / std::sqrt(length2) : frame_[0].z;
  }
  // Colours by component, for passes: as Cycles estimates albedos, by facets along the normal, and where those blend to
  // white by tables of the mean over facets.
  PerComponent colors() const {
    PerComponent sum{diffuse_, Rgb{0, 0, 0}, Rgb{0, 0, 0}};
    for (int i = 0; i < count_; ++i) {
      const Lobe& l = lobe_[i];
      Lobe near = l;
      near.through = {0, 0, 0};
      Rgb reflected = albedoAt(near, cosine(l.frame)), passed = albedoAt(l, cosine(l.frame)) - reflected;
      if (l.passColor == PassColor::kPale) {
        reflected = l.weight, passed = {0, 0, 0};
      } else if (wardmis::reflects(l.kind) && (l.fresnel == Fresnel::kBlended || l.fresnel == Fresnel::kF82)) {
        const float rough = tableRoughness(l), c = cosine(l.frame);
        const Rgb facets =
            whitened(l.f0, l.fresnel == Fresnel::kF82 ? schlickAlbedo(rough, c) : blendAlbedo(rough, c, l.eta));
        reflected = l.weight * facets;
        if (isGlass(l.kind) && l.passColor == PassColor::kMean) passed = l.through * (Rgb{1, 1, 1} - facets);
      }
      sum[static_cast<size_t>(componentOf(l, wardmis::reflects(l.kind)))] += reflected / l.compensation;
      sum[static_cast<size_t>(Component::kTransmission)] += passed / l.compensation;
    }
    return sum;
  }
  // Whether the rounding of float directions would show, as Surface has it.
  bool needsDouble(float cosThetaO) const {
    return anyLobe([&](const Lobe& l) { return wardmis::needsDouble(l, cosThetaO); });
  }

  // f cos of each technique's lobes and their densities at a direction wi, both in frame 0; ahead: it leaves on the
  // side of the viewer. Sharp lobes are zero. by: null, or where f cos is told by component.
  template <class T>
  void evaluate(Vec3<T> wi, Vec3<T> wo, bool ahead, std::array<Rgb, K - 1>& f, Fractions<K>& p, LitOtherwise<K>& lit,
                FByComponent<K>* by = nullptr) const {
    if (plain_ && by == nullptr)
      evaluateAs<true>(wi, wo, ahead, f, p, lit, nullptr);
    else
      evaluateAs<false>(wi, wo, ahead, f, p, lit, by);
  }

  struct Sample {
    int lobe = 0;
    bool glossy = true, transmits = false;
    bool lost = false;  // zero, and it counts: it left on a side where the lobe has nothing
  };
  // A direction of a technique's lobes, in frame 0. v chooses among several, and what is left of it in glass.
  template <class T>
  Vec3<T> sample(size_t slot, Vec3<T> wo, Vec2<T> u, float v, Sample& from) const {
    float left = v;
    int chosen = -1;
    for (int i = 0; i < count_; ++i) {
      if (slot_[i] != slot) continue;
      chosen = i;
      if (left < share_[i]) break;
      left -= share_[i];
    }
    const Lobe& l = lobe_[chosen];
    if (share_[chosen] < 1) left = std::clamp(left / share_[chosen], 0.0f, 0x1.fffffep-1f);
    const Vec3<T> wi = wardmis::sample(l, local(l, wo), u, T(left));
    from = {chosen, true, wi.z < T(0)};
    from.glossy = !isMatte(l.kind);
    from.lost = !(wi.z != T(0)) || !leaves(l, wi.z > T(0));
    return global(l, wi);
  }
  // The sharp lobes of which a sample goes from wo to wi: to(slot, sample).
  template <class T, class To>
  void eachSharp(Vec3<T> wi, Vec3<T> wo, To&& to) const {
    constexpr T kApart2 = T(1e-6);  // of directions that are one but for rounding, squared
    for (int i = 0; i < count_; ++i) {
      const Lobe& l = lobe_[i];
      if (!isDelta(l.kind)) continue;
      const Vec3<T> asked = local(l, wi), from = wardmis::sample(l, local(l, wo), Vec2<T>{}, T(0)) - asked;
      if (dot(from, from) < kApart2 && asked.z != T(0) && leaves(l, asked.z > T(0)))
        to(size_t{slot_[i]}, Sample{i, true, asked.z < T(0)});
    }
  }
  Component component(const Sample& from) const { return componentOf(lobe_[from.lobe], !from.transmits); }
  // How often its technique takes the sample's lobe.
  float share(const Sample& from) const { return share_[from.lobe]; }
  Vec3f normal(const Sample& from) const { return frame_[lobe_[from.lobe].frame].z; }  // world
  // Of a sharp lobe's sample: solid angle of viewers over that of the light that it sends them.
  template <class T>
  float spread(const Sample& from, Vec3<T> wi, Vec3<T> wo) const {
    const Lobe& l = lobe_[from.lobe];
    if (l.kind != LobeKind::kSharpRefraction) return 1;
    return static_cast<float>(T(l.eta) * T(l.eta) * std::abs(local(l, wi).z / local(l, wo).z));
  }
  // Of a sharp lobe's sample: f cos / pdf, the choice of the lobe included.
  template <class T>
  Rgb weight(const Sample& from, Vec3<T> wi, Vec3<T> wo) const {
    const Lobe& l = lobe_[from.lobe];
    const Vec3<T> out = local(l, wi), w = wardmis::weight(l, out, local(l, wo));
    return single(w) * (left(static_cast<float>(out.z)) / share_[from.lobe]);
  }

 private:
  struct Part {
    Rgb f;
    float density;  // as Cycles counts it, times the strength
    Component component;
  };
  struct OwnStray {
    Rgb f;
    float pdf, counted;  // times the strength
    int without;         // the part that is not asked there, or none
    Component component;
  };
  // kPlain: see plain_; without passes.
  template <bool kPlain, class T>
  void evaluateAs(Vec3<T> wi, Vec3<T> wo, bool ahead, std::array<Rgb, K - 1>& f, Fractions<K>& p, LitOtherwise<K>& lit,
                  FByComponent<K>* by) const {
    Scratch<Part, kPlain ? 1 : kMostLobes + 1> part;
    Scratch<OwnStray, LitOtherwise<K>::kMostStrays> own;
    int parts = 0;
    const float cosine = std::max(static_cast<float>(wi.z), 0.0f) * (1 / kPi<float>);
    (ahead ? f : lit.other)[kCosine] = diffuse_ * (cosine * left(static_cast<float>(wi.z)));
    p[kCosine] = hasDiffuse() && ahead ? cosine : 0;
    lit.same[kCosine] = f[kCosine];
    lit.density = strength_[kCosine] * cosine;
    lit.any = !ahead && hasDiffuse() && cosine > 0;
    if constexpr (!kPlain) {
      part.set(parts++, {f[kCosine] + lit.other[kCosine], lit.density, Component::kDiffuse});
      if (by != nullptr) [[unlikely]]
        by->add(kCosine, Component::kDiffuse, part[0].f);
    }
    float drawn = ahead ? lit.density : 0, counted = drawn;  // of samples that leave there, and as Cycles has it
    for (int i = 0; i < count_; ++i) {
      const Lobe& l = lobe_[i];
      if (isDelta(l.kind)) continue;
      const Vec3<T> w = local(l, wi);
      const bool above = w.z > T(0);
      if (!(w.z != T(0)) || !leaves(l, above)) continue;
      const Vec3<T> view = local(l, wo);
      LobeValue<T> v = wardmis::evaluate(l, w, view);
      const bool seen = v.pdf > T(0);
      if constexpr (kPlain) {
        if (!seen) continue;
        const float strength = slot_[i] == kCosine ? 0 : strength_[slot_[i]] * share_[i],
                    density = strength * static_cast<float>(v.pdf);
        const Rgb value = single(v.fCos) * left(static_cast<float>(w.z));
        lit.density += density;
        if (above == ahead) {
          f[slot_[i]] += value, lit.same[slot_[i]] += value;
          if (slot_[i] != kCosine) p[slot_[i]] += share_[i] * static_cast<float>(v.pdf);
        } else {
          lit.other[slot_[i]] += value, lit.any = true;
        }
        continue;
      }
      if (!seen) v = unseen(l, w, view);
      if (!(v.pdf > T(0))) continue;
      const SampleDensities<T> d = seen ? sampleDensities(l, w, view, v.pdf) : SampleDensities<T>{T(0), v.pdf};
      const float strength = slot_[i] == kCosine ? 0 : strength_[slot_[i]] * share_[i],
                  density = strength * static_cast<float>(d.counted), reached = left(static_cast<float>(w.z));
      const Rgb value = single(v.fCos) * reached;
      const BumpShadow shadow = bump_[l.frame] == 0 ? BumpShadow{1, 1}
                                                    : bumpShadow(bump_[l.frame], l.kind, static_cast<float>(wi.z),
                                                                 ownCosine_[l.frame], static_cast<float>(w.z));
      const bool sampled = seen && above == ahead;
      Component component{};
      if (by != nullptr) [[unlikely]] {
        component = componentOf(l, above);
        if (!shadow.refused) by->add(slot_[i], component, value);
      }
      if (shadow.refused && lit.strays < lit.kMostStrays) {
        // to light samples and to those of other lobes it is not there, nor is its density; its own bring theirs
        lit.any = true;
        if (!sampled) continue;
        if (slot_[i] != kCosine) p[slot_[i]] += share_[i] * static_cast<float>(v.pdf);
        if (!(density > std::numeric_limits<float>::min())) continue;
        own.set(lit.strays, {value * shadow.bySurface, density, density, -1, component});
        lit.stray.set(lit.strays++, {{}, 0, slot_[i]});
        continue;
      }
      if (sampled) {
        f[slot_[i]] += value * shadow.bySurface;
        if (slot_[i] != kCosine) p[slot_[i]] += share_[i] * static_cast<float>(v.pdf);
        drawn += strength * static_cast<float>(d.pdf), counted += density;
        strays(l, w, view, [&](const Stray<T>& s) {
          const float pdf = strength * static_cast<float>(s.pdf);
          if (lit.strays == lit.kMostStrays || !(pdf > std::numeric_limits<float>::min())) return;
          own.set(lit.strays, {single(s.fCos) * reached, pdf, strength * static_cast<float>(s.counted),
                               s.alone ? parts : -1, component});
          lit.stray.set(lit.strays++, {{}, 0, slot_[i]});
        });
      }
      part.set(parts++, {value, density, component});
      lit.density += density;
      (above == ahead ? lit.same : lit.other)[slot_[i]] += value * shadow.byLight;
      lit.any = lit.any || shadow.byLight != (sampled ? shadow.bySurface : 0);
    }
    // a sample brings what all lobes have there, over the density that is counted for all
    if (counted > 0 && drawn != counted) {
      for (Rgb& value : f) value = value * (drawn / counted);
      lit.any = true;
    }
    for (int k = 0; k < lit.strays; ++k) {
      typename LitOtherwise<K>::Stray& s = lit.stray[k];
      s.f = own[k].f * (own[k].counted / own[k].pdf), s.density = own[k].counted;
      for (int i = 0; i < parts; ++i)
        if (i != own[k].without) s.f += part[i].f, s.density += part[i].density;
      const float scale = own[k].pdf / s.density;
      s.f = s.f * scale;
      f[s.slot] += s.f;
      if (by != nullptr) [[unlikely]] {
        by->add(s.slot, own[k].component, own[k].f * (own[k].counted / s.density));
        for (int i = 0; i < parts; ++i)
          if (i != own[k].without) by->add(s.slot, part[i].component, part[i].f * scale);
      }
      lit.any = true;
    }
  }

  static Component componentOf(const Lobe& l, bool ahead) {
    if (l.kind == LobeKind::kVelvet) return Component::kGlossy;  // to Cycles 3.4's passes; its rays are diffuse
    if (isMatte(l.kind)) return Component::kDiffuse;
    return ahead && !(l.passColor == PassColor::kPale && isGlass(l.kind)) ? Component::kGlossy
                                                                          : Component::kTransmission;
  }
  template <class Is>
  bool anyLobe(Is&& is) const {
    for (int i = 0; i < count_; ++i)
      if (is(lobe_[i])) return true;
    return false;
  }
  template <class T>
  static Rgb single(Vec3<T> v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  }
  float left(float cosine) const { return terminator > 1 && cosine > 0 ? leftAtTerminator(terminator, cosine) : 1; }

  // Reflects as the cosine goes, about the surface's own normal.
  static bool byCosine(const Lobe& l) {
    return l.frame == 0 && detail::isDiffuse(l.kind) && !wardmis::transmits(l.kind);
  }

  // What facets that are met at a cosine send to the view.
  static Rgb albedoAt(const Lobe& l, float cosine) {
    const bool refracts = l.kind == LobeKind::kSharpRefraction || l.kind == LobeKind::kGgxRefraction ||
                          l.kind == LobeKind::kBeckmannRefraction;
    const float c = std::clamp(cosine, 0.0f, 1.0f);
    const Rgb all = l.weight * (refracts ? transmittance(l, c) : reflectance(l, c));
    return isGlass(l.kind) ? all + l.through * transmittance(l, c) : all;
  }
  // What a lobe sends to the view of light from all around: of rough facets in mean over what they are turned by.
  Rgb albedoOf(const Lobe& l) const {
    const float c = cosine(l.frame), spread = isDelta(l.kind) ? 0 : std::sqrt(l.ax * l.ay);
    return spread > 0 ? (albedoAt(l, c - spread) + albedoAt(l, c) + albedoAt(l, c + spread)) / 3.0f : albedoAt(l, c);
  }
  // By facets along the normal, as Cycles weighs closures: how often each is drawn tells which limit of bounces ends
  // paths. Never so little that its light would be rare and bright.
  float strengthOf(const Lobe& l) const {
    const float most = luminance(isGlass(l.kind) ? l.weight + l.through : l.weight),
                least = isDelta(l.kind) ? 0 : 0.05f * most;
    return std::clamp(luminance(albedoAt(l, cosine(l.frame))), least, most);
  }

  template <class T>
  Frame<T> frame(uint8_t i) const {
    const auto of = [](Vec3f v) { return Vec3<T>{T(v.x), T(v.y), T(v.z)}; };
    return {of(frame_[i].x), of(frame_[i].y), of(frame_[i].z)};
  }
  // Between frame 0 and a lobe's own.
  template <class T>
  Vec3<T> local(const Lobe& l, Vec3<T> w) const {
    return l.frame == 0 ? w : frame<T>(l.frame).toLocal(frame<T>(0).toWorld(w));
  }
  template <class T>
  Vec3<T> global(const Lobe& l, Vec3<T> w) const {
    return l.frame == 0 ? w : frame<T>(0).toLocal(frame<T>(l.frame).toWorld(w));
  }

  Rgb diffuse_{0, 0, 0};  // Lambert's, about frame 0
  Vec3f wo_;
  int count_, frames_;
  bool mixes_, defended_;
  bool plain_;   // what all lobes bring is f cos, of one density, whoever finds it
  float least_;  // strength of any lobe
  Scratch<Lobe, kMostLobes> lobe_;
  std::array<uint8_t, kMostLobes> slot_;
  std::array<float, kMostLobes> share_;
  Scratch<Framef, kMostFrames> frame_;
  std::array<uint8_t, kMostFrames> bump_;
  std::array<float, kMostFrames> ownCosine_;  // of the frame's normal and the surface's own
  std::array<float, K - 1> strength_;
  std::array<bool, K - 1> delta_;
  std::array<uint8_t, K - 1> reflection_, transmission_;
};

}  // namespace wardmis
