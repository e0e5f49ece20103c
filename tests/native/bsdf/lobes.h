// SPDX-License-Identifier: GPL-3.0-or-later
// One lobe of every kind and more, for tests that hold of all; and lobes as tests/golden/lobes.json writes them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bsdf/closure.h"

namespace wardmis::test {

inline constexpr const char* kKindNames[kLobeKinds] = {
    "lambert",           "oren_nayar", "burley",         "translucent", "rough_translucent", "ward",
    "ward_dur",          "ward_gmd",   "phong",          "ggx",         "beckmann",          "ashikhmin_shirley",
    "clearcoat",         "velvet",     "schlick_sheen",  "fibres",      "ggx_refraction",    "beckmann_refraction",
    "thin_transmission", "ggx_glass",  "beckmann_glass", "mirror",      "sharp_refraction",  "transparent"};
inline const char* name(LobeKind kind) { return kKindNames[static_cast<int>(kind)]; }

inline Rgb rgbOf(const nlohmann::json& j) { return {j[0].get<float>(), j[1].get<float>(), j[2].get<float>()}; }
inline Lobe lobeOf(const nlohmann::json& j) {
  Lobe l;
  for (int k = 0; k < kLobeKinds; ++k)
    if (j["kind"] == kKindNames[k]) l.kind = static_cast<LobeKind>(k);
  const std::string fresnel = j.value("fresnel", "none");
  l.fresnel = fresnel == "blended"      ? Fresnel::kBlended
              : fresnel == "dielectric" ? Fresnel::kDielectric
              : fresnel == "tinted"     ? Fresnel::kTinted
              : fresnel == "f82"        ? Fresnel::kF82
                                        : Fresnel::kNone;
  l.masking = j.value("masking", "correlated") == "separable" ? Masking::kSeparable : Masking::kCorrelated;
  l.ax = j.value("ax", 1.0f), l.ay = j.value("ay", 1.0f), l.eta = j.value("eta", 1.0f);
  l.a = j.value("a", 0.0f), l.b = j.value("b", 0.0f);
  if (j.contains("f0")) l.f0 = rgbOf(j["f0"]);
  if (j.contains("edge")) l.edge = rgbOf(j["edge"]);
  return l;
}

inline Lobe lobe(LobeKind kind, float ax, float ay, float eta, Fresnel fresnel, Masking masking) {
  Lobe l;
  l.kind = kind, l.ax = ax, l.ay = ay, l.eta = eta, l.fresnel = fresnel, l.masking = masking;
  if (fresnel == Fresnel::kBlended) l.f0 = {0.04f, 0.2f, 0.9f};
  if (fresnel == Fresnel::kTinted) l.f0 = {1, 0.7f, 0.4f};
  if (fresnel == Fresnel::kF82)
    l.f0 = {0.9f, 0.6f, 0.3f}, l.edge = {f82Edge(0.9f, 1), f82Edge(0.6f, 0.5f), f82Edge(0.3f, 0.2f)};
  return l;
}

// Lobes that are not deltas, rough enough for quadrature.
inline std::vector<Lobe> roughLobes() {
  const Fresnel none = Fresnel::kNone, blended = Fresnel::kBlended;
  const Masking together = Masking::kCorrelated, apart = Masking::kSeparable;
  std::vector<Lobe> all{
      lobe(LobeKind::kLambert, 1, 1, 1, none, together),
      lobe(LobeKind::kSchlickSheen, 1, 1, 1, none, together),
      lobe(LobeKind::kTranslucent, 1, 1, 1, none, together),
      lobe(LobeKind::kWard, 0.2f, 0.1f, 1, none, together),
      lobe(LobeKind::kWardDur, 0.2f, 0.1f, 1, none, together),
      lobe(LobeKind::kWardGmd, 0.2f, 0.1f, 1, none, together),
      lobe(LobeKind::kGgx, 0.1f, 0.1f, 1.5f, blended, apart),
      lobe(LobeKind::kGgx, 0.5f, 0.15f, 1, Fresnel::kF82, together),
      lobe(LobeKind::kGgx, 1, 1, 1.33f, Fresnel::kTinted, together),
      lobe(LobeKind::kBeckmann, 0.1f, 0.1f, 1, none, apart),
      lobe(LobeKind::kBeckmann, 0.5f, 0.15f, 1, none, together),
      lobe(LobeKind::kBeckmann, 1, 1, 1.5f, blended, together),
      lobe(LobeKind::kAshikhminShirley, 0.3f, 0.1f, 1, none, together),
      lobe(LobeKind::kAshikhminShirley, 1, 1, 1, none, together),
      lobe(LobeKind::kClearcoat, 0.09f, 0.09f, 1.5f, blended, apart),
      lobe(LobeKind::kClearcoat, 1, 1, 1.5f, blended, apart),
      lobe(LobeKind::kGgxRefraction, 0.2f, 0.2f, 1.5f, blended, together),
      lobe(LobeKind::kGgxRefraction, 0.3f, 0.3f, 0.7f, Fresnel::kTinted, apart),
      lobe(LobeKind::kGgxRefraction, 0.8f, 0.8f, 3, none, together),
      lobe(LobeKind::kBeckmannRefraction, 0.2f, 0.2f, 1.5f, blended, together),
      lobe(LobeKind::kBeckmannRefraction, 0.6f, 0.6f, 0.9f, none, apart),
      lobe(LobeKind::kThinTransmission, 0.4f, 0.4f, 1, none, together),
      lobe(LobeKind::kGgxGlass, 0.2f, 0.2f, 1.5f, blended, together),
      lobe(LobeKind::kGgxGlass, 0.5f, 0.2f, 0.7f, Fresnel::kTinted, apart),
      lobe(LobeKind::kGgxGlass, 0.8f, 0.8f, 0.9f, none, apart),
      lobe(LobeKind::kBeckmannGlass, 0.3f, 0.3f, 1.5f, Fresnel::kDielectric, together),
  };
  const auto with = [&](LobeKind kind, float a, float b) {
    Lobe l;
    l.kind = kind, l.a = a, l.b = b;
    all.push_back(l);
    return all.size() - 1;
  };
  with(LobeKind::kPhong, 20, 0);
  with(LobeKind::kBurley, 0.8f, 0);
  with(LobeKind::kVelvet, 0.5f, 0);
  with(LobeKind::kFibres, 0.3f, -0.1f);
  for (const LobeKind kind : {LobeKind::kOrenNayar, LobeKind::kRoughTranslucent}) {
    const auto model = OrenNayar<float>::of(0.7f);
    all[with(kind, model.a, model.b)].f0 = {0, 0.002f, 0.05f};
  }
  const auto again = [&](LobeKind kind, float ax, float ay, float eta, bool Lobe::*what) {
    all.push_back(lobe(kind, ax, ay, eta, none, apart));
    all.back().*what = true;
  };
  again(LobeKind::kBeckmann, 0.5f, 0.15f, 1, &Lobe::byFirstAxis);
  again(LobeKind::kGgxRefraction, 0.4f, 0.4f, 0.7f, &Lobe::refractsUp);
  again(LobeKind::kBeckmannRefraction, 0.4f, 0.4f, 0.9f, &Lobe::refractsUp);
  for (Lobe& l : all) l.weight = {0.5f, 0.25f, 0.75f}, l.through = {0.3f, 0.6f, 0.2f};
  return all;
}

// A direction of the lobe; random: statistics.h's.
template <class T = double, class Random>
Vec3<T> drawn(const Lobe& l, Vec3<T> wo, Random& random) {
  const Vec2<T> u = random.template square<T>();
  return sample(l, wo, u, isGlass(l.kind) ? T(random.uniform() * (1 - 0x1p-24)) : T(0));
}

// f cos as samples of the lobe bring it: as the density that Cycles counts has it, and by strays.
inline Vec3<double> brought(const Lobe& l, Vec3<double> wi, Vec3<double> wo) {
  const LobeValue<double> v = evaluate(l, wi, wo);
  if (!(v.pdf > 0)) return {};
  const SampleDensities<double> d = sampleDensities(l, wi, wo, v.pdf);
  Vec3<double> sum = d.counted > 0 ? v.fCos * (d.pdf / d.counted) : Vec3<double>{};
  strays(l, wi, wo, [&](const Stray<double>& s) { sum += s.fCos; });
  return sum;
}

// Glass as the two lobes whose light it sends, each sampled on its own; another lobe itself.
inline std::vector<Lobe> halves(const Lobe& l) {
  if (!isGlass(l.kind)) return {l};
  Lobe up = l, down = l;
  down.weight = l.through, up.refractsUp = false;
  const bool ggx = l.kind == LobeKind::kGgxGlass;
  up.kind = ggx ? LobeKind::kGgx : LobeKind::kBeckmann;
  down.kind = ggx ? LobeKind::kGgxRefraction : LobeKind::kBeckmannRefraction;
  return {up, down};
}

}  // namespace wardmis::test

namespace wardmis {
inline void PrintTo(const Lobe& l, std::ostream* out) {  // NOLINT(readability-identifier-naming): GoogleTest's name
  *out << test::name(l.kind) << " alpha " << l.ax << " " << l.ay << " eta " << l.eta << " a " << l.a << " b " << l.b;
}
}  // namespace wardmis
