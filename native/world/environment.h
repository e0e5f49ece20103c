// SPDX-License-Identifier: GPL-3.0-or-later
// Light from infinitely far: a constant, an image or a program, the latter two with importance sampling.
#pragma once

#include "math/random.h"
#include "math/vec.h"
#include "scene/scene.h"
#include "world/piecewise2d.h"
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
  // Mean radiance over the sphere times 4 pi: of what directions are drawn by the mean of the channels, else luminance.
  float integral() const { return integral_; }

  Rgb radiance(Vec3f direction, const SkyRay& ray = {}) const;
  // A place in the sky's tables. They are larger than the processor's caches, and directions are random: who finds a
  // place asks for what look() will read there, and work between the two hides a wait that would be longer than all the
  // rest of a path.
  struct Place {
    const Environment* sky = nullptr;  // whose place it is; null: nobody's
    Vec3f direction{0, 0, 1};          // unit
    uint32_t node = 0;                 // the lower left one of the four around the place
    Vec2f share{0, 0};                 // of the next node across and up
    Vec2f uv{0, 0};                    // in the sky's image
    float density = 0;                 // per solid angle: of what is even over the table, or in a cone
  };
  // A direction is drawn in three steps: prefetch(u) asks for what cell(u) reads, which draws a cell of the table and
  // leaves in u what is left of it; that asks for what sample() reads.
  void prefetch(ChoicePoint u) const {
    if (tabulated()) table_.prefetch(u);
  }
  uint32_t cell(ChoicePoint& u) const;
  Place sample(uint32_t cell, ChoicePoint u) const;
  Place sample(ChoicePoint u) const {  // without a wait between
    const uint32_t c = cell(u);
    return sample(c, u);
  }
  Place find(Vec3f direction) const;
  // The radiance that comes from there, and the density of sample(), per solid angle; 0 where !sampled().
  struct Look {
    Rgb radiance;
    float pdf;
  };
  Look look(const Place& place, const SkyRay& ray = {}) const;
  Look look(Vec3f direction, const SkyRay& ray = {}) const { return look(find(direction), ray); }
  bool tabulated() const { return !table_.empty(); }

 private:
  void tabulateImage();
  void tabulateMeans();
  void tabulateProgram();
  void measureCone();
  bool inCone(Vec3f direction) const {
    const Vec3f apart = direction - axis_;  // 1 - cos = |d - a|^2 / 2, exact for narrow cones
    return 0.5f * dot(apart, apart) <= oneMinusCos_;
  }
  // World -> the frame of the table, not normalised: the world's matrix may be any that has an inverse.
  Vec3f toImage(Vec3f world) const;
  Vec3f fromImage(Vec3f image) const;  // not normalised
  void putInTable(Place& place, Vec2f uv) const;
  Look filtered(const Place& place) const;
  void prefetchNodes(uint32_t node) const;
  void prefetch(const Place& place) const;
  Rgb imageAt(Vec2f uv) const;
  template <class Weight>
  void tabulate(const Weight& weight);
  void tabulate(const std::vector<float>& weights);
  void makeTexels();
  struct Cell;
  Cell cellAt(uint32_t node) const;
  float densityOverMean(uint32_t node, const Cell& cell) const;
  uint32_t nodeAt(int x, int y) const {
    return static_cast<uint32_t>(y + 1) * static_cast<uint32_t>(width_ + 2) + static_cast<uint32_t>(x + 1);
  }
  // Solid angle in the image's frame over that of the world, where `image` is toImage() of a unit vector: a linear map
  // M takes the solid angle dw at d to |det M| / |M d|^3 dw.
  float stretch(Vec3f image) const { return determinant_ / (dot(image, image) * length(image)); }

  const Scene& scene_;
  const World& world_;
  const Image* image_ = nullptr;  // of the world's texture
  bool exists_ = false;
  float integral_ = 0;
  Vec3f axis_{0, 0, 1};    // of a sky that is within a cone alone
  float oneMinusCos_ = 0;  // of its half angle; 0: there is no cone
  // Directions are drawn as a weight at nodes says, which goes bilinearly from each to the next: of an image that is
  // filtered so, as its radiance itself. Nodes lie at the middles of width x height parts of the sphere between
  // meridians and parallels about this frame's z axis, as an equirectangular image's texels do; in a mirror ball's, z
  // is the axis of the ball, towards which all of the image's rim looks, so that its meridians are straight and its
  // parallels circles about the middle. The table's cells lie between the nodes; those below the first row of nodes and
  // above the last one are half as high.
  float matrix_[9] = {}, inverse_[9] = {}, determinant_ = 1;  // the determinant without its sign
  int width_ = 0, height_ = 0;                                // of the nodes, row 0 at the bottom (-z)
  PiecewiseConstant2D table_;                                 // (height + 1) x width
  Table<float> nodes_;  // weights, with a border of one as they go on there; empty where there are texels_
  // Of an image with a node for each texel, with the same border, its colours beside the density of the cell of which
  // it is the lower left node, over the mean of the nodes' weights: then a look at both reads two places of memory and
  // not four. Empty of other images.
  struct alignas(16) Texel {
    float r, g, b, scale;
  };
  Table<Texel> texels_;
};

// One for each of the scene's worlds, which must stay where they are.
std::vector<Environment> environmentsOf(const Scene& scene);

}  // namespace wardmis
