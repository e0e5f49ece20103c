// SPDX-License-Identifier: GPL-3.0-or-later
// The Principled shader of Blender 3.4 as lobes (closure.h). Subsurface scattering is rendered as diffuse reflection of
// its color. Alpha and emission are nodes of their own there: transparent with weight 1 - alpha, all else times alpha.
#pragma once

#include "bsdf/closure.h"
#include "math/rec709.h"

namespace wardmis {

// Normals that lobes refer to by `frame`.
enum PrincipledFrame : uint8_t { kBaseFrame, kCoatFrame, kSheenFrame };
// Cosines of the view with them; that of diffuse lobes, which name the base's, is another one since Blender 4.0.
struct ViewCosines {
  float base, coat, sheen, diffuse;
};

struct Principled3 {
  Rgb baseColor{0.8f, 0.8f, 0.8f}, subsurfaceColor{0.8f, 0.8f, 0.8f};
  float subsurface = 0, metallic = 0, specular = 0.5f, specularTint = 0, roughness = 0.5f, anisotropic = 0;
  float sheen = 0, sheenTint = 0.5f, clearcoat = 0, clearcoatRoughness = 0.03f;
  float ior = 1.45f, transmission = 0, transmissionRoughness = 0;
  bool multiscatter = false, backfacing = false;
};

// Color with its luminance divided out, blended from white by `tint`.
inline Rgb hueOf(Rgb color, float luminance, float tint) {
  return gray(1 - tint) + (luminance > 0 ? color * (1 / luminance) : gray(1)) * tint;
}

// Glass as rough as that gives back what is reflected more than once, and is one lobe.
inline constexpr float kLeastCompensated3 = 5e-2f;

namespace detail {

template <class Add>
inline void addSpecular3(const Principled3& p, Rgb weight, float cosThetaO, Add&& add) {
  const float aspect = std::sqrt(std::max(0.0f, 1 - p.anisotropic * 0.9f)), r2 = p.roughness * p.roughness;
  Lobe l = roughLobe(3, LobeKind::kGgx, weight, r2 / aspect, r2 * aspect);
  l.fresnel = Fresnel::kBlended, l.passColor = PassColor::kPale;
  l.eta = 2 / (1 - std::sqrt(std::max(0.0f, 0.08f * p.specular))) - 1;
  const float luminance = 0.3f * p.baseColor.x + 0.6f * p.baseColor.y + 0.1f * p.baseColor.z;
  l.f0 = clampedTo1(hueOf(p.baseColor, luminance, p.specularTint) * (p.specular * 0.08f * (1 - p.metallic)) +
                    p.baseColor * p.metallic);
  if (p.multiscatter && p.roughness > 0.075f) {
    l.masking = Masking::kCorrelated;
    atLeastRough(l);
    addEnergy(3, l, compensate(reflectionAlbedo(tableRoughness(l), cosThetaO), blendedMean(l.f0, l.eta)));
  }
  addLobe(3, l, add);
}

template <class Add>
inline void addGlass3(const Principled3& p, Rgb weight, float cosThetaO, Add&& add) {
  const float eta = p.backfacing ? 1 / std::max(p.ior, 1e-5f) : std::max(p.ior, 1e-5f),
              alpha = p.roughness * p.roughness;
  const Rgb tint = p.baseColor * p.specularTint + gray(1 - p.specularTint);
  if (p.multiscatter && p.roughness > kLeastCompensated3) {
    const Rgb base = clampedTo1(p.baseColor);
    GlassLook look{.fresnel = Fresnel::kTinted,
                   .f0 = clampedTo1(tint),
                   .reflectionTint = gray(1),
                   .transmissionTint = base,
                   .unseenFacets = false};
    weight *= addEnergy(3, look, compensate(glassAlbedo(p.roughness, cosThetaO, eta), base));
    return addGlassLobe(3, look, weight, alpha, eta, add);
  }
  const float f = fresnelDielectric(cosThetaO, eta);
  Lobe l = roughLobe(3, LobeKind::kGgx, weight * f, alpha, alpha);
  l.fresnel = Fresnel::kBlended, l.passColor = PassColor::kPale, l.f0 = tint, l.eta = eta;
  addLobe(3, l, add);
  const float through = p.multiscatter ? p.roughness : 1 - (1 - p.roughness) * (1 - p.transmissionRoughness);
  l = refractionLobe(3, LobeKind::kGgxRefraction, weight * p.baseColor * std::max(1e-4f, 1 - f), through * through,
                     eta);
  addLobe(3, l, add);
}

}  // namespace detail

// Whether Cycles makes a number that is none of glass of so low an index, which takes all light of the surface: its
// reflectance at normal incidence is 1 to a float, and divides.
inline bool isLost3(const Principled3& p) {
  const float eta = std::max(p.ior, 1e-5f);
  return !p.backfacing && !(eta * eta - 1 + 1 > 0);
}

// cosBase, cosCoat: of the view with the normal and the clearcoat normal.
template <class Add>
inline void expand(const Principled3& p, Rgb weight, float cosBase, float cosCoat, Add&& add) {
  const float metallic = std::clamp(p.metallic, 0.0f, 1.0f), transmission = std::clamp(p.transmission, 0.0f, 1.0f);
  const float diffuse = (1 - metallic) * (1 - transmission), glass = transmission * (1 - metallic);
  if (glass > kLeastWeight && isLost3(p)) return;
  if (diffuse > kLeastWeight) {
    Lobe l;
    l.weight = weight * diffuse;
    if (p.subsurface > kLeastWeight)
      l.weight *= p.subsurfaceColor * p.subsurface + p.baseColor * (1 - p.subsurface);
    else
      l.kind = LobeKind::kBurley, l.a = p.roughness, l.weight *= p.baseColor;
    addLobe(3, l, add);
    if (p.sheen > kLeastWeight) {
      l = Lobe{};
      l.kind = LobeKind::kSchlickSheen;
      l.weight = weight * hueOf(p.baseColor, rec709::luminance(p.baseColor, 3), p.sheenTint) * (p.sheen * diffuse);
      addLobe(3, l, add);
    }
  }
  if (1 - glass > kLeastWeight && (p.specular > kLeastWeight || p.metallic > kLeastWeight))
    detail::addSpecular3(p, weight * (1 - glass), cosBase, add);
  if (glass > kLeastWeight) detail::addGlass3(p, weight * glass, cosBase, add);
  if (p.clearcoat > kLeastWeight && cosCoat > 0) {
    const float alpha = p.clearcoatRoughness * p.clearcoatRoughness;
    Lobe l = roughLobe(3, LobeKind::kClearcoat, weight * (0.25f * p.clearcoat), alpha, alpha);
    l.frame = kCoatFrame, l.fresnel = Fresnel::kBlended, l.eta = 1.5f, l.f0 = gray(0.04f);
    l.passColor = PassColor::kPale,
    l.compensation = gray(0.25f * p.clearcoat);  // passes do not know how strong the coat is
    addLobe(3, l, add);
  }
}

}  // namespace wardmis
