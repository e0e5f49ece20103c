// SPDX-License-Identifier: GPL-3.0-or-later
// What the sheen and the coat of the Principled shader leave of light from below.
#pragma once

#include "bsdf/principled.h"
#include "program/context.h"

namespace wardmis {

// In the layers' colors. normal, coatNormal: in the axes of the context. What is not finite counts as 0.
Rgb belowLayers(const ShadingContext& context, Principled layers, Vec3f normal, Vec3f coatNormal);

}  // namespace wardmis
