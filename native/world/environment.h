// SPDX-License-Identifier: GPL-3.0-or-later
// Light from infinitely far: a constant, an image or a program, the latter two with importance sampling.
#pragma once

#include "math/random.h"
#include "math/vec.h"
#include "scene/scene.h"
#include "world/alias.h"
#include "world/shading.h"

namespace wardmis {

class Environment {
 public:
  Environment(const Scene& scene, const World& world);

  bool exists() const { return exists_; }
  const World& world() const { return world_; }
  // Worth sampling by itself. A constant sky is not: the techniques of the surface cover it evenly; nor is one that no
  // surface sees.
  bool sampled() const { return !table_.empty() || oneMinusCos_ > 0; }
  // Mean radiance over the sphere times 4 pi, by luminance.
  float integral() const { return integral_; }

  Rgb radiance(Vec3f direction, const SkyRay& ray = {}) const;
  // A direction of density pdf(direction), per solid angle.
  Vec3f sample(ChoicePoint u) const;
  float pdf(Vec3f direction) const;

 private:
  void tabulateImage();
  void tabulateProgram();
  void measureCone();
  void makeBands();
  bool inCone(Vec3f direction) const {
    const Vec3f apart = direction - axis_;  // 1 - cos = |d - a|^2 / 2, exact for narrow cones
    return 0.5f * dot(apart, apart) <= oneMinusCos_;
  }
  // World -> the frame of the table, not normalised: the world's matrix may be any that has an inverse.
  Vec3f toImage(Vec3f world) const;
  Vec3f fromImage(Vec3f image) const;  // unit -> unit
  Vec3f inCell(int x, size_t y, float u, float v) const;
  // Solid angle in the image's frame over that of the world, where `image` is toImage() of a unit vector: a linear map
  // M takes the solid angle dw at d to |det M| / |M d|^3 dw.
  float stretch(Vec3f image) const { return determinant_ / (dot(image, image) * length(image)); }

  const Scene& scene_;
  const World& world_;
  bool exists_ = false;
  float integral_ = 0;
  Vec3f axis_{0, 0, 1};    // of a sky that is within a cone alone
  float oneMinusCos_ = 0;  // of its half angle; 0: there is no cone
  // The table's cells lie between meridians and parallels about this frame's z axis. It is that of an equirectangular
  // image; in a mirror ball's, z is the axis of the ball, towards which all of the image's rim looks, so that its
  // meridians are straight and its parallels circles about the middle.
  float matrix_[9] = {}, inverse_[9] = {}, determinant_ = 1;  // the determinant without its sign
  int width_ = 0, height_ = 0;                                // of the table, row 0 at the bottom (-z)
  AliasTable table_;
  // A row of the table lies between two polar angles; each is measured from the pole that is nearer to the row, by
  // 1 - cos, which is exact where cos alone is not.
  struct Band {
    float begin, height;  // of 1 - cos: at the border towards that pole, and between the borders
    bool up;              // the pole is +z
  };
  std::vector<Band> bands_;
};

// One for each of the scene's worlds, which must stay where they are.
std::vector<Environment> environmentsOf(const Scene& scene);

}  // namespace wardmis
