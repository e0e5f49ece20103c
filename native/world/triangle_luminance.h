// SPDX-License-Identifier: GPL-3.0-or-later
// How much emissive triangles shine, for their selection.
#pragma once

#include <unordered_map>
#include <vector>

#include "scene/scene.h"
#include "world/geometry.h"

namespace wardmis {

class TriangleLuminance {
 public:
  explicit TriangleLuminance(const Scene& scene) : scene_(scene), means_(scene.textures.size(), -1) {}

  // By strength(). Of a texture: the mean over a grid that is about as fine as the texels that the triangle covers. The
  // grid may miss what shines between its points, and a triangle that shines must be aimed at: never less than a share
  // of the image's own mean.
  double of(const Placement& p, const Shape& s, uint32_t triangle);

 private:
  double ofProgram(const Placement& p, const Shape& s, uint32_t triangle);
  const Image& image(int texture) const;
  int divisions(const TextureUse& use, Vec2f a, Vec2f b, Vec2f c) const;
  double mean(const ColorInput& e);

  const Scene& scene_;
  std::unordered_map<const Shape*, double> most_;  // of programs
  std::vector<double> means_;                      // luminance of each texture's image; < 0: not known yet
};

}  // namespace wardmis
