// SPDX-License-Identifier: GPL-3.0-or-later
// What moves while the shutter is open. Time goes from 0 to 1; a motion has equal steps of it, two or more.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "math/vec.h"

namespace wardmis {

inline constexpr float kMiddle = 0.5f;  // the time of what does not move, and of the frame itself

// Between which steps a time lies, and how far.
struct StepAt {
  size_t first;
  float way;
};
inline StepAt stepAt(size_t steps, float time) {
  const float s = time * static_cast<float>(steps - 1);
  const size_t first = std::min(static_cast<size_t>(std::max(s, 0.0f)), steps - 2);
  return {first, s - static_cast<float>(first)};
}

// A matrix as a rotation after a scale and shear, (row, column) of an upper triangle; a mirroring one has all of these
// negative.
struct Decomposed {
  float quaternion[4] = {0, 0, 0, 1};  // x, y, z, w
  float xx = 1, xy = 0, xz = 0, yy = 1, yz = 0, zz = 1;
  Vec3f translation{0, 0, 0};
};

// A transform that moves: rotations by the shortest way and evenly, all else linearly, as in Cycles and Embree.
class MovingFrame {
 public:
  explicit MovingFrame(std::span<const Affine> steps);
  Affine at(float time) const;
  std::span<const Decomposed> steps() const { return steps_; }

 private:
  std::vector<Decomposed> steps_;
};

// When a sample sees the scene: by how much of the light the shutter lets through, and from which line on it opens.
class Shutter {
 public:
  // curve: how far it is open at equal steps of the time; empty: always alike. rolling: the part of the time that each
  // line has, the top one being the first; below 0: all lines have all of it.
  explicit Shutter(std::span<const float> curve = {}, float rolling = -1);
  // u: uniform; line: of the pixel, from 0 at the bottom to 1.
  float at(float u, float line) const;

 private:
  std::vector<float> inverse_;  // of the integral of the curve
  float rolling_;
};

}  // namespace wardmis
