// SPDX-License-Identifier: GPL-3.0-or-later
// Light from infinitely far in all directions: a constant, or an equirectangular image with importance sampling.
#pragma once

#include "math/vec.h"
#include "scene/alias.h"
#include "scene/scene.h"

namespace wardmis {

class Environment {
 public:
  explicit Environment(const Scene& scene);

  bool exists() const { return exists_; }
  // Worth sampling by itself. A constant sky is not: the techniques of the surface cover it evenly.
  bool sampled() const { return !table_.empty(); }
  // Mean radiance over the sphere times 4 pi, by luminance.
  float integral() const { return integral_; }

  Rgb radiance(Vec3f direction) const;
  // A direction of density pdf(direction), per solid angle.
  Vec3f sample(Vec2f u) const;
  float pdf(Vec3f direction) const;

 private:
  Vec3f toImage(Vec3f world) const;  // world -> the image's Z-up frame
  Vec3f fromImage(Vec3f image) const;

  const Scene& scene_;
  bool exists_ = false;
  float integral_ = 0;
  float inverse_[9] = {};
  int width_ = 0, height_ = 0;  // of the table, row 0 at v = 0 (down)
  AliasTable table_;
  std::vector<float> bandCos_;  // cos of the polar angle at the table's row borders, increasing with v
};

}  // namespace wardmis
