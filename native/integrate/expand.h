// SPDX-License-Identifier: GPL-3.0-or-later
// From a material's closures, their inputs resolved to numbers, to the lobes of one hit.
#pragma once

#include "bsdf/principled.h"
#include "scene/closure.h"

namespace wardmis {

// A closure's inputs at the hit.
struct ClosureValues {
  Rgb weight;
  std::array<Rgb, 4> colors;
  std::array<float, 15> scalars;
};

// Calls add(Lobe) for each. backfacing: the surface is seen from its other side.
template <class Add>
void expand(const Closure& c, const ClosureValues& v, const ViewCosines& cosines, bool backfacing, Add&& add) {
  const auto alpha = [](float a) { return std::clamp(a, 0.0f, 1.0f); };
  const auto eta = [&](float ior) {
    const float n = std::max(ior, 1e-5f);
    return backfacing ? 1 / n : n;
  };
  const int version = c.version;
  const Rgb color = notNegative(v.colors[0]), weight = v.weight * color;
  const auto s = [&](size_t i) { return v.scalars[i]; };
  switch (c.type) {
    case ClosureType::kHoldout:
      return;
    case ClosureType::kDiffuse:
      return addDiffuse(version, weight, color, s(0), cosines.diffuse, add);
    case ClosureType::kTranslucent:
      return addTranslucent(version, weight, add);
    case ClosureType::kTransparent:
      return addTransparent(version, v.weight * v.colors[0], add);  // which may take light away
    case ClosureType::kWard: {
      Lobe l;
      l.kind = wardKind(c.variant);
      l.weight = weight, l.ax = std::clamp(s(0), 1e-6f, 10.0f), l.ay = std::clamp(s(1), 1e-6f, 10.0f);
      if (maxComponent(weight) > 0) add(l);
      return;
    }
    case ClosureType::kGlossy:
      return addGlossy(version, c.distribution, weight, color, alpha(s(0)), alpha(s(1)), cosines.base, add);
    case ClosureType::kGlass:
      return addGlass(version, c.distribution, v.weight, color, alpha(s(0)), eta(s(1)), cosines.base, add);
    case ClosureType::kRefraction:
      return addRefraction(version, c.distribution, weight, alpha(s(0)), eta(s(1)), add);
    case ClosureType::kVelvet:
      return addVelvet(version, weight, s(0), add);
    case ClosureType::kSheen:
      addFibres(weight, s(0), cosines.base, 0, add);
      return;
    case ClosureType::kPrincipled3: {
      using namespace principled3;
      Principled3 p;
      p.baseColor = notNegative(v.colors[kBaseColor]), p.subsurfaceColor = notNegative(v.colors[kSubsurfaceColor]);
      p.subsurface = s(kSubsurface), p.metallic = s(kMetallic), p.specular = s(kSpecular);
      p.specularTint = s(kSpecularTint), p.roughness = s(kRoughness), p.anisotropic = s(kAnisotropic);
      p.sheen = s(kSheen), p.sheenTint = s(kSheenTint), p.clearcoat = s(kClearcoat);
      p.clearcoatRoughness = s(kClearcoatRoughness), p.ior = s(kIor), p.transmission = s(kTransmission);
      p.transmissionRoughness = s(kTransmissionRoughness);
      p.multiscatter = c.distribution == Glossy::kMultiGgx, p.backfacing = backfacing;
      return wardmis::expand(p, v.weight, cosines.base, cosines.coat, add);
    }
    case ClosureType::kPrincipled: {
      using namespace principled;
      Principled p;
      p.version = version;
      p.baseColor = notNegative(v.colors[kBaseColor]), p.specularTint = v.colors[kSpecularTint];
      p.coatTint = v.colors[kCoatTint], p.sheenTint = v.colors[kSheenTint];
      p.metallic = s(kMetallic), p.roughness = s(kRoughness), p.ior = s(kIor), p.alpha = s(kAlpha);
      p.diffuseRoughness = s(kDiffuseRoughness), p.subsurfaceWeight = s(kSubsurfaceWeight);
      p.subsurfaceAnisotropy = s(kSubsurfaceAnisotropy), p.specularIorLevel = s(kSpecularIorLevel);
      p.anisotropic = s(kAnisotropic), p.transmissionWeight = s(kTransmissionWeight), p.coatWeight = s(kCoatWeight);
      p.coatRoughness = s(kCoatRoughness), p.coatIor = s(kCoatIor), p.sheenWeight = s(kSheenWeight);
      p.sheenRoughness = s(kSheenRoughness);
      p.multiscatter = c.distribution == Glossy::kMultiGgx, p.thinWall = c.thinWall, p.backfacing = backfacing;
      wardmis::expand(p, v.weight, cosines, add);
      return;
    }
  }
}

}  // namespace wardmis
