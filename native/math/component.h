// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface does to light, as passes tell it apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "math/vec.h"

namespace wardmis {

enum class Component : uint8_t { kDiffuse, kGlossy, kTransmission };
inline constexpr size_t kComponents = 3;
using PerComponent = std::array<Rgb, kComponents>;

}  // namespace wardmis
