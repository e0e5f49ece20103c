// SPDX-License-Identifier: GPL-3.0-or-later
// The paths from the lights of one camera sample of the image, by all threads.
#pragma once

#include <functional>
#include <string>

#include "integrate/kernel.h"
#include "integrate/setup.h"

namespace wardmis {

// Why a scene gets none; empty: it does.
std::string noLightPaths(const Scene& scene, const Geometry& geometry, const Emitters& emitters,
                         const RenderSettings& settings);

// Vertices of a path, in mean over some that no image has.
template <size_t K>
double verticesPerPath(const KernelInput<K>& in);

// Traces those of a camera sample into `light`, which is in.light.
template <size_t K>
void traceLight(const KernelInput<K>& in, uint32_t sample, LightPaths& light, const std::function<Counts&()>& counts);

}  // namespace wardmis
