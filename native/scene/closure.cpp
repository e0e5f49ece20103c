// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/closure.h"

#include "bsdf/principled3.h"

namespace wardmis {

namespace {

constexpr ClosureInput kReflects[] = {{"color", 0.8f}}, kPasses[] = {{"color", 1}};
constexpr ClosureInput kOrenNayar[] = {{"roughness", 0}};
constexpr ClosureInput kWardAlphas[] = {{"alphaX", 0.1f}, {"alphaY", 0.1f}};
constexpr ClosureInput kAlphas[] = {{"alphaX", 0.25f}, {"alphaY", 0.25f}};
constexpr ClosureInput kGlass[] = {{"alpha", 0}, {"ior", 1.5f}};
constexpr ClosureInput kVelvet[] = {{"sigma", 1}};
constexpr ClosureInput kFibres[] = {{"roughness", 0.5f}};
constexpr ClosureInput kColors3[] = {{"baseColor", 0.8f}, {"subsurfaceColor", 0.8f}};
constexpr ClosureInput kScalars3[] = {{"subsurface", 0},
                                      {"metallic", 0},
                                      {"specular", 0.5f},
                                      {"specularTint", 0},
                                      {"roughness", 0.5f},
                                      {"anisotropic", 0},
                                      {"sheen", 0},
                                      {"sheenTint", 0.5f},
                                      {"clearcoat", 0},
                                      {"clearcoatRoughness", 0.03f},
                                      {"ior", 1.45f},
                                      {"transmission", 0},
                                      {"transmissionRoughness", 0}};
constexpr ClosureInput kColors[] = {{"baseColor", 0.8f}, {"specularTint", 1}, {"coatTint", 1}, {"sheenTint", 1}};
constexpr ClosureInput kScalars[] = {{"metallic", 0},
                                     {"roughness", 0.5f},
                                     {"ior", 1.5f},
                                     {"alpha", 1},
                                     {"diffuseRoughness", 0},
                                     {"subsurfaceWeight", 0},
                                     {"subsurfaceAnisotropy", 0},
                                     {"specularIorLevel", 0.5f},
                                     {"anisotropic", 0},
                                     {"transmissionWeight", 0},
                                     {"coatWeight", 0},
                                     {"coatRoughness", 0.03f},
                                     {"coatIor", 1.5f},
                                     {"sheenWeight", 0},
                                     {"sheenRoughness", 0.5f}};

constexpr ClosureInfo kTable[kClosureTypes] = {
    {"diffuse", 3, 5, kReflects, kOrenNayar},
    {"translucent", 3, 5, kReflects, {}},
    {"transparent", 3, 5, kPasses, {}},
    {"ward", 3, 5, kReflects, kWardAlphas},
    {"glossy", 3, 5, kReflects, kAlphas, true},
    {"glass", 3, 5, kPasses, kGlass, true},
    {"refraction", 3, 5, kPasses, kGlass, true},
    {"velvet", 3, 5, kReflects, kVelvet},
    {"sheen", 4, 5, kReflects, kFibres},
    {"principled", 3, 3, kColors3, kScalars3, true},
    {"principled", 4, 5, kColors, kScalars, true},
    {"holdout", 3, 5, {}, {}},
};

}  // namespace

const ClosureInfo& info(ClosureType type) { return kTable[static_cast<size_t>(type)]; }

LobeCounts mostLobes(const Closure& c) {
  LobeCounts counts{};
  const auto add = [&](LobeClass kind, bool is = true) { counts[static_cast<size_t>(kind)] += is ? 1 : 0; };
  // about a normal of its own a diffuse lobe has a technique of its own; by the rules of version 3 it may have one
  // wherever the mesh's is not the face's
  add(LobeClass::kDiffuse, (c.normal >= 0 || (c.version == 3 && c.type == ClosureType::kDiffuse)) && mayBeDiffuse(c));
  const auto addGlass = [&](const ScalarInput& roughness) {
    const bool known = roughness.texture.texture < 0 && roughness.result < 0, smooth = known && !(roughness.value > 0);
    add(LobeClass::kGlass, !smooth);
    add(LobeClass::kGlossy, !known || smooth), add(LobeClass::kRefraction, !known || smooth);
  };
  switch (c.type) {
    case ClosureType::kTranslucent:
      add(LobeClass::kTranslucent);
      break;
    case ClosureType::kWard:
    case ClosureType::kGlossy:
      add(LobeClass::kGlossy);
      break;
    case ClosureType::kGlass:
      addGlass(c.scalars[0]);
      break;
    case ClosureType::kRefraction:
      add(LobeClass::kRefraction);
      break;
    case ClosureType::kSheen:
      add(LobeClass::kSheen);
      break;
    case ClosureType::kPrincipled3: {
      using namespace principled3;
      const ScalarInput& r = c.scalars[kRoughness];
      const bool through = !c.isConstant(kTransmission, 0), white = c.distribution == Glossy::kMultiGgx;
      const bool rough = r.texture.texture < 0 && r.result < 0 && r.value > kLeastCompensated3;
      add(LobeClass::kGlossy, !c.isConstant(kSpecular, 0) || !c.isConstant(kMetallic, 0));
      add(LobeClass::kGlossy, !c.isConstant(kClearcoat, 0));
      add(LobeClass::kGlass, through && white);
      add(LobeClass::kGlossy, through && !(white && rough)), add(LobeClass::kRefraction, through && !(white && rough));
      break;
    }
    case ClosureType::kPrincipled: {
      using namespace principled;
      const bool dielectric = !c.isConstant(kMetallic, 1),
                 through = dielectric && !c.isConstant(kTransmissionWeight, 0);
      add(LobeClass::kGlossy, dielectric), add(LobeClass::kGlossy, !c.isConstant(kMetallic, 0));
      add(LobeClass::kGlossy, !c.isConstant(kCoatWeight, 0));
      add(LobeClass::kSheen, !c.isConstant(kSheenWeight, 0));
      if (through && !c.thinWall) addGlass(c.scalars[kRoughness]);
      add(LobeClass::kGlossy, through && c.thinWall), add(LobeClass::kRefraction, through && c.thinWall);
      add(LobeClass::kTranslucent, dielectric && c.thinWall && !c.isConstant(kSubsurfaceWeight, 0));
      break;
    }
    default:
      break;
  }
  return counts;
}

bool mayBeTransparent(const Closure& c) {
  if (c.type == ClosureType::kPrincipled)
    return !c.isConstant(principled::kAlpha, 1) || (c.thinWall && !c.isConstant(principled::kTransmissionWeight, 0));
  return c.type == ClosureType::kTransparent;
}

bool mayBeDiffuse(const Closure& c) {
  switch (c.type) {
    case ClosureType::kDiffuse:
    case ClosureType::kVelvet:
      return true;
    case ClosureType::kPrincipled3:
      return !c.isConstant(principled3::kMetallic, 1) || !c.isConstant(principled3::kSheen, 0);
    case ClosureType::kPrincipled:
      return !c.isConstant(principled::kMetallic, 1);
    default:
      return false;
  }
}

}  // namespace wardmis
