// SPDX-License-Identifier: GPL-3.0-or-later
// Light from infinitely far in all directions: a constant, or an equirectangular image with importance sampling.
#pragma once

#include "math/random.h"
#include "math/vec.h"
#include "scene/scene.h"
#include "world/alias.h"

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
  Vec3f sample(ChoicePoint u) const;
  float pdf(Vec3f direction) const;

 private:
  // World -> the image's Z-up frame, not normalised: the world's matrix may be any that has an inverse.
  Vec3f toImage(Vec3f world) const;
  Vec3f fromImage(Vec3f image) const;  // unit -> unit
  Vec3f inCell(int x, size_t y, float u, float v) const;
  // Solid angle in the image's frame over that of the world, where `image` is toImage() of a unit vector: a linear map
  // M takes the solid angle dw at d to |det M| / |M d|^3 dw.
  float stretch(Vec3f image) const { return determinant_ / (dot(image, image) * length(image)); }

  const Scene& scene_;
  bool exists_ = false;
  float integral_ = 0;
  float inverse_[9] = {}, determinant_ = 1;  // of the world's matrix; the determinant without its sign
  int width_ = 0, height_ = 0;               // of the table, row 0 at v = 0 (down)
  AliasTable table_;
  // A row of the table lies between two polar angles; each is measured from the pole that is nearer to the row, by
  // 1 - cos, which is exact where cos alone is not.
  struct Band {
    float begin, height;  // of 1 - cos: at the border towards that pole, and between the borders
    bool up;              // the pole is v = 1
  };
  std::vector<Band> bands_;
};

}  // namespace wardmis
