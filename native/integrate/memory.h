// SPDX-License-Identifier: GPL-3.0-or-later
// What a render's frame takes of memory, and whether there is so much.
#pragma once

#include "integrate/render.h"

namespace wardmis {

// lobes: that a surface may have.
// Of the largest moment of a render: the film with the pilot, or with the passes that are written.
uint64_t bytesPerPixel(const RenderSettings& settings, size_t lobes);

// Throws Error (memory), with the numbers, where a frame does not fit.
void requireMemory(int width, int height, const RenderSettings& settings, size_t lobes);

}  // namespace wardmis
