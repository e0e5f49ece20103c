// SPDX-License-Identifier: GPL-3.0-or-later
// The nodes Noise Texture and, up to Blender 4.0, Musgrave Texture: fractals of Perlin noise.
#pragma once

#include "pattern/fractal.h"

namespace wardmis::pattern {

// What a node's inputs may link are inputs, what it fixes are settings.
struct NoiseSettings {
  Version version = Version::kBlender5;
  int dimensions = 3;                    // 1 to 4: of w; (x, y); (x, y, z); (x, y, z, w)
  FractalType type = FractalType::kFbm;  // 3.4: kFbm, normalised
  bool normalize = true;
};
struct NoiseInputs {
  float scale = 5, detail = 2, roughness = 0.5f, lacunarity = 2, offset = 0, gain = 1, distortion = 0;
};
float noiseFactor(const NoiseSettings& settings, const NoiseInputs& inputs, Vec3f p, float w);
// The factor, and two more of its kind elsewhere.
Rgb noiseColor(const NoiseSettings& settings, const NoiseInputs& inputs, Vec3f p, float w);

struct MusgraveInputs {
  float scale = 5, detail = 2, dimension = 2, lacunarity = 2, offset = 0, gain = 1;
};
float musgrave(FractalType type, int dimensions, const MusgraveInputs& inputs, Vec3f p, float w);

}  // namespace wardmis::pattern
