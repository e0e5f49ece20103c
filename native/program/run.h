// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a program: no allocation, no virtual call.
#pragma once

#include <array>

#include "program/context.h"
#include "program/program.h"

namespace wardmis {

using Slots = std::array<float, kMostSlots>;

// Afterwards the values that inputs refer to are in their slots, and the context has the normal that `bend` gave it.
void run(const Program& program, ShadingContext& context, const TextureAccess& textures, Slots& slots);

}  // namespace wardmis
