// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface does to light, as passes tell it apart.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wardmis {

enum class Component : uint8_t { kDiffuse, kGlossy, kTransmission };
inline constexpr size_t kComponents = 3;

}  // namespace wardmis
