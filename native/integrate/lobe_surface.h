// SPDX-License-Identifier: GPL-3.0-or-later
// The reflecting and transmitting surface at one hit: any lobes, each with a normal of its own, shared out among the K
// techniques: what is sampled by the cosine goes to that one, every other lobe has its own as long as there are enough.
#pragma once

#include <algorithm>
#include <array>

#include "bsdf/lobe.h"
#include "mis/technique.h"

namespace wardmis {

template <size_t K>
class LobeSurface {
 public:
  static constexpr size_t kCosine = Techniques<K>::kCosine, kSlots = Techniques<K>::kLobes;
  static constexpr int kMostLobes = 24, kMostFrames = 8;

  Rgb transparent{0, 0, 0};  // of the light that goes straight through, what arrives

  // frame: the surface's own; wo in world space, unit.
  void begin(const Framef& frame, Vec3f wo) {
    count_ = 0, frames_ = 0;
    transparent = {0, 0, 0}, diffuse_ = {0, 0, 0};
    wo_ = wo;
    addFrame(frame);
  }
  // A frame for lobes to refer to; the last one again where there are too many.
  uint8_t addFrame(const Framef& frame) {
    const int i = std::min(frames_, kMostFrames - 1);
    frame_[i] = frame;
    frames_ = i + 1;
    return static_cast<uint8_t>(i);
  }
  float cosine(uint8_t frame) const { return dot(frame_[frame].z, wo_); }

  void add(const Lobe& lobe) {
    if (lobe.kind == LobeKind::kTransparent) {
      transparent += lobe.weight;
    } else if (lobe.kind == LobeKind::kLambert && lobe.frame == 0) {
      diffuse_ += lobe.weight;
    } else if (count_ < kMostLobes) {
      lobe_[count_++] = lobe;
    }
  }
  // Shares the lobes out among the techniques, in their order; those that are too many share one.
  void finish() {
    strength_.fill(0), sum_.fill(0), delta_.fill(false);
    strength_[kCosine] = luminance(diffuse_);
    std::array<float, kMostLobes> strength;
    size_t rough = 0, sharp = 0;
    for (int i = 0; i < count_; ++i) {
      strength[i] = strengthOf(lobe_[i]);
      if (isDelta(lobe_[i].kind))
        ++sharp;
      else if (!byCosine(lobe_[i]))
        ++rough;
    }
    // sharp ones never share with others: one technique is theirs at least
    const size_t forRough = std::min(rough, kSlots - (sharp > 0 ? 1 : 0)),
                 forSharp = std::min(sharp, kSlots - forRough);
    size_t nextRough = 0, nextSharp = forRough;
    for (int i = 0; i < count_; ++i) {
      size_t slot = kCosine;
      if (isDelta(lobe_[i].kind)) {
        slot = std::min(nextSharp++, forRough + forSharp - 1);
        delta_[slot] = true;
      } else if (!byCosine(lobe_[i])) {
        slot = std::min(nextRough++, forRough - 1);
      }
      slot_[i] = static_cast<uint8_t>(slot);
      share_[i] = strength[i];
      strength_[slot] += strength[i];
      sum_[slot] += strength[i];
    }
    for (int i = 0; i < count_; ++i) share_[i] = sum_[slot_[i]] > 0 ? share_[i] / sum_[slot_[i]] : 1;
  }

  bool hasLobe(size_t slot) const { return strength_[slot] > 0; }
  bool hasDiffuse() const { return strength_[kCosine] > 0; }
  bool reflects() const {
    return std::any_of(strength_.begin(), strength_.end(), [](float s) { return s > 0; });
  }
  bool delta(size_t slot) const { return delta_[slot]; }
  // About the share of light from all around that it sends to the viewer.
  float strength(size_t slot) const { return strength_[slot]; }
  float diffuseStrength() const { return strength_[kCosine]; }
  Rgb albedo() const {
    Rgb sum = diffuse_;
    for (int i = 0; i < count_; ++i) sum += lobe_[i].weight * lookOf(lobe_[i]);
    return sum;
  }
  bool transmits() const {
    return std::any_of(lobe_.begin(), lobe_.begin() + count_, [](const Lobe& l) { return wardmis::transmits(l.kind); });
  }
  // Whether the rounding of float directions would show, as Surface has it.
  bool needsDouble(float cosThetaO) const {
    return std::any_of(lobe_.begin(), lobe_.begin() + count_, [&](const Lobe& l) {
      if (isDelta(l.kind) || byCosine(l) || l.kind == LobeKind::kPhong || l.kind == LobeKind::kFibres) return false;
      const float narrow = std::min(l.ax, l.ay), wide = std::max(l.ax, l.ay);
      return narrow * std::min(narrow, cosThetaO) < 4e-6f * (1 + wide * wide);
    });
  }

  // f cos of each technique's lobes and their densities at a direction wi, both in frame 0; ahead: it leaves on the
  // side of the viewer. Sharp lobes are zero.
  template <class T>
  void evaluate(Vec3<T> wi, Vec3<T> wo, bool ahead, std::array<Rgb, K - 1>& f, Fractions<K>& p) const {
    const float cosine = ahead ? std::max(static_cast<float>(wi.z), 0.0f) * (1 / kPi<float>) : 0;
    f[kCosine] = diffuse_ * cosine;
    p[kCosine] = hasDiffuse() ? cosine : 0;
    for (int i = 0; i < count_; ++i) {
      const Lobe& l = lobe_[i];
      if (isDelta(l.kind) || wardmis::transmits(l.kind) == ahead) continue;
      const LobeValue<T> v = wardmis::evaluate(l, local(l, wi), local(l, wo));
      f[slot_[i]] += Rgb{static_cast<float>(v.fCos.x), static_cast<float>(v.fCos.y), static_cast<float>(v.fCos.z)};
      if (slot_[i] != kCosine) p[slot_[i]] += share_[i] * static_cast<float>(v.pdf);
    }
  }

  struct Sample {
    int lobe = 0;
    bool glossy = true, transmits = false;
  };
  // A direction of a technique's lobes, in frame 0. u.x chooses among several, and is used again.
  template <class T>
  Vec3<T> sample(size_t slot, Vec3<T> wo, Vec2<T> u, Sample& from) const {
    float left = static_cast<float>(u.x);
    int chosen = -1;
    for (int i = 0; i < count_; ++i) {
      if (slot_[i] != slot) continue;
      chosen = i;
      if (left < share_[i]) break;
      left -= share_[i];
    }
    const Lobe& l = lobe_[chosen];
    if (share_[chosen] < 1) u.x = T(std::clamp(left / share_[chosen], 0.0f, 0x1.fffffep-1f));
    from = {chosen, true, wardmis::transmits(l.kind)};
    from.glossy = l.kind != LobeKind::kTranslucent && l.kind != LobeKind::kRoughTranslucent;
    return global(l, wardmis::sample(l, local(l, wo), u));
  }
  // Of a sharp lobe's sample: f cos / pdf, the choice of the lobe included.
  template <class T>
  Rgb weight(const Sample& from, Vec3<T> wi, Vec3<T> wo) const {
    const Lobe& l = lobe_[from.lobe];
    const Vec3<T> w = wardmis::weight(l, local(l, wi), local(l, wo));
    return Rgb{static_cast<float>(w.x), static_cast<float>(w.y), static_cast<float>(w.z)} / share_[from.lobe];
  }

 private:
  // Reflects as the cosine goes, about the surface's own normal.
  static bool byCosine(const Lobe& l) {
    return l.frame == 0 && detail::isDiffuse(l.kind) && !wardmis::transmits(l.kind);
  }

  // What a lobe's facets do to light from the view, of rough ones in mean over what they are turned by.
  Rgb lookOf(const Lobe& l) const {
    const bool refracts = l.kind == LobeKind::kSharpRefraction || l.kind == LobeKind::kGgxRefraction ||
                          l.kind == LobeKind::kBeckmannRefraction;
    const float c = cosine(l.frame), spread = isDelta(l.kind) ? 0 : std::sqrt(l.ax * l.ay);
    const auto at = [&](float x) {
      const float clamped = std::clamp(x, 0.0f, 1.0f);
      return refracts ? transmittance(l, clamped) : reflectance(l, clamped);
    };
    return spread > 0 ? (at(c - spread) + at(c) + at(c + spread)) / 3.0f : at(c);
  }
  // Never so little that its light would be rare and bright.
  float strengthOf(const Lobe& l) const {
    const float w = luminance(l.weight), least = isDelta(l.kind) ? 0 : 0.05f;
    return w * std::clamp(luminance(lookOf(l)), least, 1.0f);
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
  std::array<Lobe, kMostLobes> lobe_;
  std::array<uint8_t, kMostLobes> slot_;
  std::array<float, kMostLobes> share_;
  std::array<Framef, kMostFrames> frame_;
  std::array<float, K - 1> strength_, sum_;
  std::array<bool, K - 1> delta_;
};

}  // namespace wardmis
