// SPDX-License-Identifier: GPL-3.0-or-later
// What a render's frame takes of memory, and whether there is so much.
#pragma once

#include "integrate/settings.h"

namespace wardmis {

// Of the largest moment of a render: the film with the pilot, or with the passes that are written. lobes: that a
// surface may have; catchers: whether there are shadow catchers.
uint64_t bytesPerPixel(const RenderSettings& settings, size_t lobes, bool catchers = false);

// Throws Error (memory), with the numbers, where a frame does not fit.
void requireMemory(int width, int height, const RenderSettings& settings, size_t lobes, bool catchers);

}  // namespace wardmis
