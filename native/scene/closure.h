// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface is made of, as docs/scene-format.md ("Closures") has it: plain data.
#pragma once

#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <string_view>
#include <vector>

#include "bsdf/closure.h"
#include "bsdf/ward.h"
#include "scene/material_input.h"

namespace wardmis {

enum class ClosureType : uint8_t {
  kDiffuse,
  kTranslucent,
  kTransparent,
  kWard,
  kGlossy,
  kGlass,
  kRefraction,
  kVelvet,
  kSheen,
  kPrincipled3,  // of version 3
  kPrincipled,
  kHoldout,
};

// An input's name and its default, of a colour in all channels.
struct ClosureInput {
  std::string_view name;
  float value;
};

// One row of the table: how a type is called, which versions have it, and its inputs in the order of Closure's.
struct ClosureInfo {
  std::string_view name;
  int firstVersion, lastVersion;
  std::span<const ClosureInput> colors, scalars;
  bool distribution = false;  // has the parameter
};
const ClosureInfo& info(ClosureType type);
inline constexpr size_t kClosureTypes = 12;

struct Closure {
  ClosureType type = ClosureType::kDiffuse;
  uint8_t version = 5;
  Glossy distribution = Glossy::kGgx;
  WardVariant variant = WardVariant::kWardGmd;
  bool thinWall = false;
  int normal = -1, coatNormal = -1, tangent = -1;  // indices into Program::results: directions; -1: the mesh's own
  ColorInput weight{{1, 1, 1}, {}};
  ScalarInput rotation;  // of the anisotropy, radians
  std::vector<ColorInput> colors;
  std::vector<ScalarInput> scalars;

  bool isConstant(size_t scalar, float value) const {
    const ScalarInput& s = scalars[scalar];
    return s.value == value && s.texture.texture < 0 && s.result < 0;
  }
};

// How many lobes of each class there may be, beside those that reflect diffusely about the mesh's normal.
using LobeCounts = std::array<uint8_t, kLobeClasses>;
inline size_t total(const LobeCounts& counts) { return std::accumulate(counts.begin(), counts.end(), size_t{0}); }
// What it may become at most; what lets light straight through, and a hole, is no lobe.
LobeCounts mostLobes(const Closure& closure);
// Whether light may go straight through.
bool mayBeTransparent(const Closure& closure);
// Whether some of it reflects diffusely.
bool mayBeDiffuse(const Closure& closure);

// Names of the inputs of the principled shader, by their place in the table.
namespace principled3 {
enum Color : uint8_t { kBaseColor, kSubsurfaceColor };
enum Scalar : uint8_t {
  kSubsurface,
  kMetallic,
  kSpecular,
  kSpecularTint,
  kRoughness,
  kAnisotropic,
  kSheen,
  kSheenTint,
  kClearcoat,
  kClearcoatRoughness,
  kIor,
  kTransmission,
  kTransmissionRoughness
};
}  // namespace principled3
namespace principled {
enum Color : uint8_t { kBaseColor, kSpecularTint, kCoatTint, kSheenTint };
enum Scalar : uint8_t {
  kMetallic,
  kRoughness,
  kIor,
  kAlpha,
  kDiffuseRoughness,
  kSubsurfaceWeight,
  kSubsurfaceAnisotropy,
  kSpecularIorLevel,
  kAnisotropic,
  kTransmissionWeight,
  kCoatWeight,
  kCoatRoughness,
  kCoatIor,
  kSheenWeight,
  kSheenRoughness
};
}  // namespace principled

}  // namespace wardmis
