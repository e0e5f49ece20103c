// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a program: no allocation, no virtual call.
#pragma once

#include <array>

#include "program/context.h"
#include "program/program.h"

namespace wardmis {

using Slots = std::array<float, kMostSlots>;

// Afterwards the values that inputs refer to are in their slots.
void run(const Program& program, const ShadingContext& context, const TextureAccess& textures, Slots& slots);

}  // namespace wardmis
