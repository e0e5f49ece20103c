// SPDX-License-Identifier: GPL-3.0-or-later
// A material's inputs at a point of its surface.
#pragma once

#include <algorithm>

#include "image/texture.h"
#include "scene/scene.h"

namespace wardmis {

inline Vec2f transformed(const TextureUse& use, Vec2f uv) {
  const float* m = use.transform;
  return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
}

// What a texture contributes at the surface's uv; 1 if there is none. Negative where its texels are: so may light be,
// and what goes straight through; who makes a reflectance of it sees to that.
inline Rgb sampleRgb(const Scene& scene, const TextureUse& use, Vec2f uv) {
  if (use.texture < 0) return {1, 1, 1};
  const Texture& texture = scene.textures[use.texture];
  return lookUpRgb(scene.images[texture.image], texture, transformed(use, uv));
}
inline float sampleScalar(const Scene& scene, const TextureUse& use, Vec2f uv) {
  if (use.texture < 0) return 1;
  const Texture& texture = scene.textures[use.texture];
  return lookUpScalar(scene.images[texture.image], texture, transformed(use, uv), use.channel);
}

// A material's input at the surface's uv.
inline Rgb evaluate(const Scene& scene, const ColorInput& input, Vec2f uv) {
  return input.value * sampleRgb(scene, input.texture, uv);
}

// Ward's alpha, within what the format allows.
inline float clampedAlpha(float alpha) { return std::clamp(alpha, 1e-6f, 10.0f); }
inline float evaluateAlpha(const Scene& scene, const ScalarInput& input, Vec2f uv) {
  return clampedAlpha(input.value * sampleScalar(scene, input.texture, uv));
}

}  // namespace wardmis
