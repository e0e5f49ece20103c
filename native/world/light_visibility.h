// SPDX-License-Identifier: GPL-3.0-or-later
// How often the lights of each entry of the light tree are seen from about a place, learned in a pilot, so that light
// samples are not spent on lamps behind a wall (after Vevoda, Kondapaneni and Krivanek 2018, "Bayesian online
// regression for adaptive direct illumination sampling", whose cells learn more than that). Places are cells of space
// and of the surface's direction, as wide as some pixels, in a hash table. What is learned is a number for each cell,
// so that nothing is biased.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "world/light_tree.h"

namespace wardmis {

class LightVisibility {
 public:
  LightVisibility(const Camera& camera, const Film& film);

  // A light sample of an entry, drawn at p, which faces n (of length 0: any way), would bring light, and is seen or
  // hidden. By any threads in any order: the counts are the same.
  void note(Vec3f p, Vec3f n, size_t entry, bool seen) {
    Tally& t = tallies_[cell(p, n)];
    t.drawn[entry].fetch_add(1, std::memory_order_relaxed);
    if (seen) t.seen[entry].fetch_add(1, std::memory_order_relaxed);
  }

  // From now on at() knows. Returns which part of the variance of whether a light sample is seen is left by drawing
  // lights by what is known of them: 1 where nothing is hidden, or all alike.
  double learn();

  // By what each entry's probability is to be multiplied at p.
  const LightTree::Factors& at(Vec3f p, Vec3f n) const { return factors_[cell(p, n)]; }

 private:
  struct Tally {
    std::array<std::atomic<uint32_t>, LightTree::kMostEntries> drawn{}, seen{};
  };
  size_t cell(Vec3f p, Vec3f n) const;

  Vec3f eye_;
  float width2_;  // of a cell, squared; but for orthographic cameras over the distance from the eye
  bool orthographic_;
  std::vector<Tally> tallies_;
  std::vector<LightTree::Factors> factors_;
};

}  // namespace wardmis
