// SPDX-License-Identifier: GPL-3.0-or-later
// The Principled shader of Blender 4.3 and 5.2 as lobes (closure.h), from the top: transparency by alpha, sheen, coat,
// metal, glass, specular reflection, diffuse; each layer takes from those below what it reflects towards the view.
// Left out: thin films. Subsurface scattering is rendered as diffuse reflection of its color; in thin walls (5.2) it is
// reflected and transmitted diffusely, which is exact.
#pragma once

#include "bsdf/principled3.h"

namespace wardmis {

struct Principled {
  int version = 4;
  Rgb baseColor{0.8f, 0.8f, 0.8f};
  float metallic = 0, roughness = 0.5f, ior = 1.5f, alpha = 1, diffuseRoughness = 0;
  float subsurfaceWeight = 0, subsurfaceAnisotropy = 0;
  float specularIorLevel = 0.5f, anisotropic = 0;
  Rgb specularTint{1, 1, 1};
  float transmissionWeight = 0;
  float coatWeight = 0, coatRoughness = 0.03f, coatIor = 1.5f;
  Rgb coatTint{1, 1, 1};
  float sheenWeight = 0, sheenRoughness = 0.5f;
  Rgb sheenTint{1, 1, 1};
  bool multiscatter = true, thinWall = false, backfacing = false;
};

namespace detail {

// What a layer leaves of the weight of those below: its strongest channel is taken off.
inline float passed(Rgb layer) { return std::clamp(1 - maxComponent(layer), 0.0f, 1.0f); }

// Reflectance of a blend from f0 to white that Cycles takes a rough layer to have.
inline Rgb blendedAlbedo(Rgb f0, float roughness, float cosThetaO, float eta) {
  return whitened(f0, blendAlbedo(roughness, cosThetaO, eta));
}

template <class Add>
inline Rgb addCoat(const Principled& p, Rgb weight, float cosThetaO, Add&& add) {
  const float coat = std::max(p.coatWeight, 0.0f), eta = std::max(p.coatIor, 1.0f),
              rough = std::clamp(p.coatRoughness, 0.0f, 1.0f);
  Lobe l = roughLobe(p.version, LobeKind::kGgx, weight * coat, rough * rough, rough * rough);
  l.frame = kCoatFrame, l.fresnel = Fresnel::kDielectric, l.eta = eta;
  Rgb albedo = gray(coat * fresnelDielectric(cosThetaO, eta));
  if (p.version >= 5) {
    const Compensation c = compensate(reflectionAlbedo(rough, cosThetaO), gray(fresnelMean(eta)));
    addEnergy(p.version, l, c);
    if (eta > 1)
      l.fresnel = Fresnel::kBlended, l.f0 = gray(fresnelNormal(eta));  // the same, to passes of colour by table
    if (eta > 1) albedo = blendedAlbedo(gray(fresnelNormal(eta)), rough, cosThetaO, eta) * coat;
    albedo *= c.darkening;
  }
  addLobe(p.version, l, add);
  weight *= passed(albedo);
  const Rgb tint = notNegative(p.coatTint);
  if (tint == Rgb{1, 1, 1}) return weight;
  // Beer's law: the tint is what passes at normal incidence, the way is longer at others
  const float depth = 1 / std::sqrt(1 - (1 - square(cosThetaO)) / square(eta));
  const auto layer = [&](float t) { return std::max(0.0f, 1 + coat * (std::pow(t, depth) - 1)); };
  return weight * Rgb{layer(tint.x), layer(tint.y), layer(tint.z)};
}

template <class Add>
inline void addMetal(const Principled& p, Rgb weight, float ax, float ay, float cosThetaO, Add&& add) {
  Lobe l = roughLobe(p.version, LobeKind::kGgx, weight, ax, ay);
  const Rgb tint = clampedTo1(p.specularTint);
  l.fresnel = Fresnel::kF82, l.f0 = clampedTo1(p.baseColor);
  l.edge = {f82Edge(l.f0.x, tint.x), f82Edge(l.f0.y, tint.y), f82Edge(l.f0.z, tint.z)};
  if (p.multiscatter)
    addEnergy(p.version, l, compensate(reflectionAlbedo(tableRoughness(l), cosThetaO), f82Mean(l.f0, l.edge)));
  addLobe(p.version, l, add);
}

// A sheet of glass without thickness (OpenPBR): what is reflected and transmitted after all reflections inside.
template <class Add>
inline void addThinGlass(const Principled& p, Rgb weight, float ior, float cosThetaO, Add&& add) {
  const float alpha = square(std::clamp(p.roughness, 0.0f, 1.0f)), s = fresnelBlend(cosThetaO, ior);
  const Rgb tint = notNegative(p.specularTint), color = clampedTo1(p.baseColor);
  const float cosInside = std::sqrt(std::max(0.0f, 1 - (1 - square(cosThetaO)) / square(ior)));
  Rgb reflects, passes;
  const auto channel = [&](float t, float c, float& r, float& through) {
    const float f0 = std::clamp(fresnelNormal(ior) * t, 0.0f, 1.0f), f = f0 * (1 - s) + s;
    const float absorbed = cosInside > 0 ? std::pow(c, 1 / cosInside) : 0, round = 1 - square(f * absorbed);
    through = round != 0 ? absorbed * square(1 - f) / round : 0;
    r = f + through * f * absorbed;
  };
  channel(tint.x, color.x, reflects.x, passes.x);
  channel(tint.y, color.y, reflects.y, passes.y);
  channel(tint.z, color.z, reflects.z, passes.z);
  if (fresnelDielectric(cosThetaO, ior) >= 1) reflects = gray(1), passes = gray(0);
  Lobe l = roughLobe(p.version, LobeKind::kGgx, weight * reflects, alpha, alpha);
  addEnergy(p.version, l, compensate(reflectionAlbedo(tableRoughness(l), cosThetaO), clampedTo1(tint)));
  addLobe(p.version, l, add);
  const float wide = alpha * std::sqrt(std::max(0.0f, 3.4f * (ior - 1) * square(ior - 0.5f) / (square(ior) * ior)));
  l = roughLobe(p.version, LobeKind::kThinTransmission, weight * passes, wide, wide);
  addEnergy(p.version, l, compensate(reflectionAlbedo(tableRoughness(l), cosThetaO), {1, 1, 1}));
  addLobe(p.version, l, add);
}

template <class Add>
inline void addTransmission(const Principled& p, Rgb weight, float ior, float cosThetaO, Add&& add) {
  if (p.thinWall) return addThinGlass(p, weight, ior, cosThetaO, add);
  const float rough = std::clamp(p.roughness, 0.0f, 1.0f), eta = p.backfacing ? 1 / ior : ior;
  const Rgb base = clampedTo1(p.baseColor), tint{std::sqrt(base.x), std::sqrt(base.y), std::sqrt(base.z)};
  GlassLook look{.fresnel = Fresnel::kBlended,
                 .f0 = clampedTo1(notNegative(p.specularTint) * fresnelNormal(ior)),
                 .reflectionTint = gray(1),
                 .transmissionTint = tint};
  // no light is refracted where the tint is black: the tables are then those of reflection
  if (p.multiscatter) {
    const Rgb fss = isBlack(tint) ? blendedMean(look.f0, eta) : tint;
    weight *= addEnergy(p.version, look, compensate(glassAlbedo(rough, cosThetaO, eta), fss));
  }
  addGlassLobe(p.version, look, weight, rough * rough, eta, add);
}

}  // namespace detail

// What the emission of the shader is to be multiplied by, and the lobes. The sheen's normal
// goes from the base's to the coat's by the coat's weight.
template <class Add>
inline Rgb expand(const Principled& p, Rgb weight, const ViewCosines& cosines, Add&& add) {
  using namespace detail;
  const float alpha = std::clamp(p.alpha, 0.0f, 1.0f), rough = std::clamp(p.roughness, 0.0f, 1.0f);
  if (alpha < 1) {
    addTransparent(p.version, weight * (1 - alpha), add);
    weight *= alpha;
  }
  if (p.sheenWeight > kLeastWeight) {
    const Rgb tint = notNegative(p.sheenTint) * p.sheenWeight;
    weight *= passed(
        tint * addFibres(weight * tint, std::clamp(p.sheenRoughness, 0.0f, 1.0f), cosines.sheen, kSheenFrame, add));
  }
  if (p.coatWeight > kLeastWeight) weight = addCoat(p, weight, cosines.coat, add);
  const Rgb emission = weight;

  const float anisotropic = std::clamp(p.anisotropic, 0.0f, 1.0f), aspect = std::sqrt(1 - anisotropic * 0.9f);
  const float ax = rough * rough / aspect, ay = rough * rough * aspect;
  const float metallic = std::clamp(p.metallic, 0.0f, 1.0f);
  if (metallic > kLeastWeight) {
    addMetal(p, weight * metallic, ax, ay, cosines.base, add);
    weight *= 1 - metallic;
  }
  const float ior = std::max(p.ior, 1e-5f), transmission = std::clamp(p.transmissionWeight, 0.0f, 1.0f);
  if (transmission > kLeastWeight) {
    addTransmission(p, weight * transmission, ior, cosines.base, add);
    weight *= 1 - transmission;
  }

  float f0 = fresnelNormal(ior), eta = ior;
  const float level = std::max(p.specularIorLevel, 0.0f);
  if (level != 0.5f) {
    f0 *= 2 * level;
    const float root = std::sqrt(std::clamp(f0, 0.0f, 0.99f));
    eta = (1 + root) / (1 - root);
    if (ior < 1) eta = 1 / eta;
  }
  if (eta != 1) {
    Lobe l = roughLobe(p.version, LobeKind::kGgx, weight, ax, ay);
    l.fresnel = Fresnel::kBlended, l.eta = eta, l.f0 = clampedTo1(notNegative(p.specularTint) * f0);
    Rgb albedo = blendedAlbedo(l.f0, tableRoughness(l), cosines.base, eta);
    if (p.multiscatter) {
      const Compensation c = compensate(reflectionAlbedo(tableRoughness(l), cosines.base), blendedMean(l.f0, eta));
      addEnergy(p.version, l, c);
      albedo *= c.darkening;
    }
    addLobe(p.version, l, add);
    weight *= passed(albedo);
  }

  const Rgb base = notNegative(p.baseColor), clamped = clampedTo1(base);
  const float under = std::clamp(p.subsurfaceWeight, 0.0f, 1.0f),
              diffuseRoughness = std::clamp(p.diffuseRoughness, 0.0f, 1.0f);
  if (under > kLeastWeight) {
    const Rgb inside = weight * clamped * under;
    if (p.thinWall) {
      const float back = std::clamp(0.5f * (1 - p.subsurfaceAnisotropy), 0.0f, 1.0f);
      const float ahead = std::clamp(0.5f * (1 + p.subsurfaceAnisotropy), 0.0f, 1.0f);
      addDiffuse(p.version, inside * back, clamped, diffuseRoughness, cosines.diffuse, add);
      addDiffuse(p.version, inside * ahead, clamped, diffuseRoughness, cosines.diffuse, add,
                 LobeKind::kRoughTranslucent);
    } else {
      addDiffuse(p.version, inside, clamped, 0, cosines.diffuse, add);
    }
  }
  addDiffuse(p.version, weight * base * (1 - under), base, diffuseRoughness, cosines.diffuse, add);
  return emission;
}

}  // namespace wardmis
