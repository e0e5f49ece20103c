// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many lights a point draws from: a tree of bounds of where they are and where they shine, walked down by what
// each half may send to the point (Conty Estevez and Kulla 2018, "Importance sampling of many lights with adaptive tree
// splitting"). The probability of each light is known exactly. A part is drawn by power, wherever the lights
// are, the more of it the glossier the surface is: what a mirror shows is not what sends it most.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace wardmis {

// Where a light is, or several are, and where they shine. World space.
struct LightBounds {
  Vec3f lower{0, 0, 0}, upper{0, 0, 0};
  // The normals lie within the angle o of the axis (cosO = -1: all), and light leaves within the angle e of a normal.
  Vec3f axis{0, 0, 1};
  float cosO = 1, cosE = 0;
  float intensity = 0;  // by strength(): W sr^-1 along a normal; from infinitely far: W m^-2 facing it
  float power = 0;      // by strength(), in W; from infinitely far: through the scene's cross-section
  bool twoSided = false;
  bool distant = false;  // infinitely far, in the direction of the axis, within the angle o; -1: all around

  // About the irradiance at p, which faces n, without occlusion; n of length 0: any way. Above 0 wherever light may
  // arrive.
  float importance(Vec3f p, Vec3f n) const;
  static LightBounds join(const LightBounds& a, const LightBounds& b);
};

// Several of them, for a loop over all.
struct LightLanes {
  static constexpr size_t kLanes = 8;
  using Floats = std::array<float, kLanes>;
  Floats centerX{}, centerY{}, centerZ{}, halfX{}, halfY{}, halfZ{}, axisX{}, axisY{}, axisZ{};
  Floats cosO{}, sinO{}, cosE{}, intensity{}, twoSided{}, distant{};  // the last two: 0 or 1
  void set(size_t i, const LightBounds& b);
};

class LightTree {
 public:
  // Lights of no intensity are never drawn.
  LightTree() = default;
  explicit LightTree(const std::vector<LightBounds>& lights);

  bool empty() const { return entries_ == 0; }
  uint32_t entries() const { return entries_; }

  // The lights as a point sees them, who faces n (of length 0: any way).
  static constexpr size_t kMostEntries = 16;
  struct View {
    Vec3f p{0, 0, 0}, n{0, 0, 0};
    std::array<float, kMostEntries> probability;  // of each entry
  };
  using Factors = std::array<float, kMostEntries>;  // of each entry's probability, above 0
  // matte: which part of the light the surface there sends to all sides alike, 0 to 1; known: null, or what else is
  // known there.
  View from(Vec3f p, Vec3f n, float matte, const Factors* known = nullptr) const;

  struct Choice {
    uint32_t light = 0, entry = 0;
    float probability = 0;  // 0: none
  };
  // u in [0, 1) is replaced by what is left of it.
  Choice choose(const View& view, double& u) const;
  float probability(const View& view, uint32_t light) const;

 private:
  static constexpr size_t kMostDistant = 7, kGroup = LightLanes::kLanes;
  static constexpr uint32_t kNone = ~0u, kGroupFlag = 1u << 31;
  // Lights or groups of them, of which a walk takes one.
  struct Group {
    LightLanes lanes;
    std::array<uint32_t, kGroup> child;  // a light, or kGroupFlag and a group's index
    uint32_t count, place;               // where it is itself, as in place_
  };
  // A range of lights while the tree is built.
  struct Part {
    uint32_t begin, end;
    LightBounds bounds;
  };
  class Builder;

  // The probability of each child; false: of none.
  static bool shares(const Group& group, const View& view, std::array<float, kGroup>& to);

  // The entries, where a walk begins, beside each other: of one that a point is within little is known.
  std::array<LightLanes, kMostEntries / kGroup> lanes_;
  std::array<uint32_t, kMostEntries> entry_{};  // as Group::child
  std::array<float, kMostEntries> power_{};     // their shares
  uint32_t entries_ = 0;
  std::vector<Group> groups_;
  // Of each light, which child it is of which group, 16 times 1 + the group's index, or 0 for an entry; kNone: it is
  // never drawn.
  std::vector<uint32_t> place_;
};

}  // namespace wardmis
