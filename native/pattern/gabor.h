// SPDX-License-Identifier: GPL-3.0-or-later
// Gabor noise (Lagae et al., "Procedural Noise using Sparse Gabor Convolution", 2009), as complex numbers (Tricard et
// al., "Procedural Phasor Noise", 2019) and with a fixed number of kernels a cell (Tavernier et al., "Making Gabor
// Noise Fast and Normalized", 2019). The node Gabor Texture of Blender 4.3 and later.
#pragma once

#include "pattern/point.h"

namespace wardmis::pattern {

struct GaborInputs {
  float scale = 5, frequency = 2, anisotropy = 1;
  float orientation2d = 0.785398163f;                // radians
  Vec3f orientation3d{0.70710678f, 0.70710678f, 0};  // any length but 0
};
struct GaborValue {
  float value = 0, phase = 0;  // in [0, 1], the value but for rare points
  float intensity = 0;
};
// dimensions: 2 or 3.
GaborValue gabor(int dimensions, const GaborInputs& inputs, Vec3f p);

}  // namespace wardmis::pattern
