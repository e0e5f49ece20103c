// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/closure.h"

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
};

}  // namespace

const ClosureInfo& info(ClosureType type) { return kTable[static_cast<size_t>(type)]; }

size_t mostLobes(const Closure& c) {
  switch (c.type) {
    case ClosureType::kTranslucent:
    case ClosureType::kWard:
    case ClosureType::kGlossy:
    case ClosureType::kRefraction:
    case ClosureType::kSheen:
      return 1;
    case ClosureType::kGlass:
      return 2;
    case ClosureType::kPrincipled3: {
      using namespace principled3;
      const bool gloss = !c.isConstant(kSpecular, 0) || !c.isConstant(kMetallic, 0);
      return size_t{gloss} + size_t{!c.isConstant(kClearcoat, 0)} + 2 * size_t{!c.isConstant(kTransmission, 0)};
    }
    case ClosureType::kPrincipled: {
      using namespace principled;
      const size_t through = c.isConstant(kTransmissionWeight, 0) ? 0 : 2,
                   thin = c.thinWall && !c.isConstant(kSubsurfaceWeight, 0) ? 1 : 0;
      const bool dielectric = !c.isConstant(kMetallic, 1);
      return size_t{!c.isConstant(kMetallic, 0)} + (dielectric ? 1 + through + thin : 0) +
             size_t{!c.isConstant(kCoatWeight, 0)} + size_t{!c.isConstant(kSheenWeight, 0)};
    }
    default:
      return 0;
  }
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
