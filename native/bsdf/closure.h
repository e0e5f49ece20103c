// SPDX-License-Identifier: GPL-3.0-or-later
// From the shader nodes of Cycles to lobes, as each version of Blender has them: 3 (3.4), 4 (4.3) and 5 (5.2).
// cosThetaO: of the view and the lobe's normal; weights of lobes may depend on it. add(Lobe) takes a lobe; lobes that
// give nothing are not made. alpha is the square of a node's roughness, within [0, 1]. eta: of the side beyond the
// surface over that of the view, so the inverse of the node's index where the view is from inside.
#pragma once

#include "bsdf/energy.h"
#include "bsdf/fibre_table.h"
#include "bsdf/lobe.h"

namespace wardmis {

enum class Glossy : uint8_t { kGgx, kBeckmann, kMultiGgx, kAshikhminShirley };

inline constexpr float kLeastWeight = 1e-5f;  // Cycles makes no closure of less
inline float meanOf(Rgb weight) { return std::abs(weight.x + weight.y + weight.z) / 3; }
inline Rgb gray(float v) { return {v, v, v}; }
inline Rgb clampedTo1(Rgb c) {
  return {std::clamp(c.x, 0.0f, 1.0f), std::clamp(c.y, 0.0f, 1.0f), std::clamp(c.z, 0.0f, 1.0f)};
}
// Roughness that the tables of albedos are read at.
inline float tableRoughness(const Lobe& l) { return std::sqrt(std::sqrt(l.ax * l.ay)); }

// Cycles makes some facets no smoother.
inline void atLeastRough(Lobe& l) { l.ax = std::max(l.ax, 1e-4f), l.ay = std::max(l.ay, 1e-4f); }

// Hands on a lobe that gives something; rough ones below Cycles' threshold as perfectly smooth. Changes it.
template <class Add>
inline void addLobe(int version, Lobe& l, Add&& add) {
  const auto gives = [](Rgb w) { return meanOf(w) >= kLeastWeight; };
  if (!gives(l.weight) && !(isGlass(l.kind) && gives(l.through))) return;
  bool smooth = l.ax * l.ay <= (version == 3 ? 1e-7f : 2e-10f);
  if (smooth && version == 3 && (l.kind == LobeKind::kGgx || l.kind == LobeKind::kBeckmann)) {
    // which asks both axes together, and takes the one mirror's direction from facets that may be rough along one
    if (l.byFirstAxis) l.ay = l.ax, l.byFirstAxis = false;
    smooth = std::max(l.ax, l.ay) <= 1e-3f;
    if (!smooth) l.masking = Masking::kOfView, atLeastRough(l);
  }
  const bool straight = smooth || std::abs(l.eta - 1) < 1e-4f;
  if (straight) l.unseenFacets = l.refractsUp = false;
  switch (l.kind) {
    case LobeKind::kGgx:
    case LobeKind::kBeckmann:
    case LobeKind::kClearcoat:
      if (smooth) l.kind = LobeKind::kMirror;
      break;
    case LobeKind::kGgxRefraction:
    case LobeKind::kBeckmannRefraction:
      if (straight) l.kind = LobeKind::kSharpRefraction;
      break;
    case LobeKind::kGgxGlass:
    case LobeKind::kBeckmannGlass:
      if (!straight) break;
      // two directions are two techniques: what Fresnel makes of them is known before one is drawn
      l.kind = LobeKind::kMirror;
      if (gives(l.weight)) {
        add(l);
        l.closure = 0;
      }
      l.kind = LobeKind::kSharpRefraction, l.weight = l.through;
      if (!gives(l.weight)) return;
      break;
    case LobeKind::kThinTransmission:
      if (smooth) l.kind = LobeKind::kTransparent;
      break;
    case LobeKind::kAshikhminShirley:
      if (std::max(l.ax, l.ay) <= 1e-4f) l.kind = LobeKind::kMirror;
      break;
    default:
      break;
  }
  add(l);
}

inline Lobe roughLobe(int version, LobeKind kind, Rgb weight, float ax, float ay) {
  Lobe l;
  l.kind = kind, l.weight = weight, l.ax = std::clamp(ax, 0.0f, 1.0f), l.ay = std::clamp(ay, 0.0f, 1.0f);
  l.masking = version == 3 ? Masking::kSeparable : Masking::kCorrelated;
  return l;
}

inline Lobe refractionLobe(int version, LobeKind kind, Rgb weight, float alpha, float eta) {
  Lobe l = roughLobe(version, kind, weight, alpha, alpha);
  l.eta = eta, l.unseenFacets = true, l.refractsUp = version == 3;
  return l;
}

// Diffuse: color alone is what decides over the light reflected more than once; weight contains it, too.
template <class Add>
inline void addDiffuse(int version, Rgb weight, Rgb color, float roughness, float cosThetaO, Add&& add,
                       LobeKind rough = LobeKind::kOrenNayar) {
  const bool below = rough == LobeKind::kRoughTranslucent;
  Lobe l;
  l.weight = weight;
  l.kind = below ? LobeKind::kTranslucent : LobeKind::kLambert;
  if (version == 3 ? roughness != 0 : roughness >= 1e-5f) {
    const OrenNayar<float> model = OrenNayar<float>::of(std::clamp(roughness, 0.0f, 1.0f));
    const Rgb rho = clampedTo1(color);
    const auto multiple = [&](float r) { return version == 3 ? 0 : orenNayarMultiple(model, r, cosThetaO); };
    l.kind = rough, l.a = model.a, l.b = model.b, l.f0 = {multiple(rho.x), multiple(rho.y), multiple(rho.z)};
  }
  addLobe(version, l, add);
}
template <class Add>
inline void addTranslucent(int version, Rgb weight, Add&& add) {
  Lobe l;
  l.kind = LobeKind::kTranslucent, l.weight = weight;
  addLobe(version, l, add);
}
template <class Add>
inline void addTransparent(int version, Rgb weight, Add&& add) {
  Lobe l;
  l.kind = LobeKind::kTransparent, l.weight = weight;
  addLobe(version, l, add);
}

// Gives a lobe the light that it reflects more than once. Colours of passes are without it: in Cycles 3.4, which
// follows light from facet to facet, as it is; later but for the darkening, which its closures' weights hold.
template <class Look>
inline Rgb addEnergy(int version, Look& look, const Compensation& c) {
  look.compensation = version == 3 ? c.factor() : gray(c.scale);
  return c.factor();
}
inline void addEnergy(int version, Lobe& l, const Compensation& c) { l.weight *= addEnergy<Lobe>(version, l, c); }

// The color that light reflected more than once takes: since 4.0 as it is, also where it is brighter than white.
inline Rgb compensated(int version, Rgb color) { return version == 3 ? clampedTo1(color) : color; }

// Glossy: color decides over multiple reflections alone; weight contains it, too.
template <class Add>
inline void addGlossy(int version, Glossy distribution, Rgb weight, Rgb color, float ax, float ay, float cosThetaO,
                      Add&& add) {
  const LobeKind kind = distribution == Glossy::kBeckmann           ? LobeKind::kBeckmann
                        : distribution == Glossy::kAshikhminShirley ? LobeKind::kAshikhminShirley
                                                                    : LobeKind::kGgx;
  Lobe l = roughLobe(version, kind, weight, ax, ay);
  if (kind == LobeKind::kAshikhminShirley) atLeastRough(l);
  l.byFirstAxis = version == 3 && kind == LobeKind::kBeckmann && ax != ay;
  if (distribution == Glossy::kMultiGgx) {
    l.masking = Masking::kCorrelated;
    if (version == 3) atLeastRough(l);
    addEnergy(version, l, compensate(reflectionAlbedo(tableRoughness(l), cosThetaO), compensated(version, color)));
  }
  addLobe(version, l, add);
}

// Glass. fresnel and f0 as in Lobe; tints multiply what is reflected and what is transmitted.
struct GlassLook {
  LobeKind kind = LobeKind::kGgxGlass;
  Masking masking = Masking::kCorrelated;
  Fresnel fresnel = Fresnel::kBlended;
  Rgb f0, reflectionTint, transmissionTint;
  Rgb compensation{1, 1, 1};
  bool unseenFacets = true;  // not where Cycles follows light from facet to facet
  bool refractsUp = false;
};
template <class Add>
inline void addGlassLobe(int version, const GlassLook& look, Rgb weight, float alpha, float eta, Add&& add) {
  Lobe l = roughLobe(version, look.kind, weight * look.reflectionTint, alpha, alpha);
  l.masking = look.masking, l.fresnel = look.fresnel, l.f0 = look.f0, l.eta = eta;
  l.through = weight * look.transmissionTint, l.compensation = look.compensation;
  if (version == 3 && !look.unseenFacets) l.passColor = PassColor::kPale;  // which passes take for transmission
  if (version == 4) l.passColor = PassColor::kMeanReflected;
  l.closure = meanOf(version == 3 && look.unseenFacets ? l.weight + l.through : weight / look.compensation);
  l.unseenFacets = look.unseenFacets, l.refractsUp = look.refractsUp;
  addLobe(version, l, add);
}

// Glass: weight without the color.
template <class Add>
inline void addGlass(int version, Glossy distribution, Rgb weight, Rgb color, float alpha, float eta, float cosThetaO,
                     Add&& add) {
  GlassLook look{.f0 = gray(fresnelNormal(eta)), .reflectionTint = color, .transmissionTint = color};
  if (distribution == Glossy::kBeckmann) look.kind = LobeKind::kBeckmannGlass;
  if (distribution == Glossy::kMultiGgx) {
    if (version == 3) look.fresnel = Fresnel::kDielectric, look.unseenFacets = false;
    const float roughness = std::sqrt(alpha);
    weight *= addEnergy(version, look, compensate(glassAlbedo(roughness, cosThetaO, eta), compensated(version, color)));
  } else if (version == 3) {  // Fresnel of the mean surface, and of its facets total internal reflection alone
    const float f = fresnelDielectric(cosThetaO, eta);
    look.masking = Masking::kSeparable, look.fresnel = Fresnel::kNone, look.refractsUp = true;
    look.reflectionTint = color * f, look.transmissionTint = color * std::max(1e-4f, 1 - f);
  }
  addGlassLobe(version, look, weight, alpha, eta, add);
}

template <class Add>
inline void addRefraction(int version, Glossy distribution, Rgb weight, float alpha, float eta, Add&& add) {
  const bool beckmann = distribution == Glossy::kBeckmann;
  Lobe l =
      refractionLobe(version, beckmann ? LobeKind::kBeckmannRefraction : LobeKind::kGgxRefraction, weight, alpha, eta);
  addLobe(version, l, add);
}

// Velvet (3.4, and the Ashikhmin sheen since), sigma in [0, 1].
template <class Add>
inline void addVelvet(int version, Rgb weight, float sigma, Add&& add) {
  Lobe l;
  l.kind = LobeKind::kVelvet, l.weight = weight, l.a = std::clamp(sigma, 0.01f, 1.0f);
  addLobe(version, l, add);
}

// Sheen of fibres (since 4.0): its albedo is in the weight. Returns the albedo, 0 where there is no lobe.
template <class Add>
inline float addFibres(Rgb weight, float roughness, float cosThetaO, uint8_t frame, Add&& add) {
  const std::array<float, 2> at{std::sqrt(std::max(cosThetaO, 0.0f)), std::clamp(roughness, 1e-3f, 1.0f)};
  const auto read = [&](const auto* table, float unit) { return lookUp<fibre::kSteps, 2>(table, at) * (65535 / unit); };
  const float albedo = read(fibre::kAlbedo, 65535);
  Lobe l;
  l.kind = LobeKind::kFibres, l.frame = frame, l.a = read(fibre::kScale, 65535), l.b = read(fibre::kSkew, 32767);
  if (std::abs(l.a) < 1e-5f || albedo < 1e-5f) return 0;
  l.weight = weight * albedo;
  addLobe(4, l, add);
  return albedo;
}

}  // namespace wardmis
