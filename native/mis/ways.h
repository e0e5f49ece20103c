// SPDX-License-Identifier: GPL-3.0-or-later
// How many samples each group of ways gets, chosen from a pilot's: of a fixed set of numbers, those of least predicted
// second moment x cost (Grittmann, Yazici, Georgiev and Slusallek 2022, "Efficiency-aware multiple importance sampling
// for bidirectional rendering algorithms"). With the balance heuristic a sample that brings f out of all ways, whose
// densities sum up to D, brings f/D; with other numbers, D', the second moment of all samples is the integral of
// f^2/D', of which (f/D)^2 (D/D') is an estimate, whichever way the sample came.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "math/square_map.h"
#include "mis/path_end.h"
#include "mis/rules.h"
#include "mis/way_images.h"

namespace wardmis {

// Numbers of samples.
struct WayCounts {
  double atHit = 1;  // of the camera's techniques at its first hit, over those that are asked for
  double paths = 0;  // from the lights, for each camera sample of a pixel; 0: none
  double connections = 0, laterConnections = 0;  // of the first vertex of a camera's path, and of each other
};

// Those of a pixel.
struct PixelWays {
  int samples = 0;  // of the camera's techniques at its first hit
  int connections = 0, laterConnections = 0;
  // What the weights multiply each group's densities by (Grittmann, Georgiev, Slusallek and Krivanek 2019,
  // "Variance-aware multiple importance sampling"): variance-aware ones, else 1.
  std::array<float, kJoins> trust{1, 1, 1, 1};

  // The weight of a way of density `own`, of a group.
  double weight(Join join, double own, const Ways& all) const {
    double sum = 0;
    for (size_t j = 0; j < kJoins; ++j) sum += double(trust[j]) * all.of[j];
    return double(trust[join]) * own / sum;
  }
  // The sum of other ways' densities, with the camera's own as unit.
  double others(const Ways& w) const {
    double sum = 0;
    for (size_t j = 0; j < kJoins; ++j) sum += double(trust[j]) * w.of[j];
    return sum / double(trust[kByCamera]);
  }

  // How much larger than with `asked` samples at a hit and one connection the densities of a group are.
  std::array<double, kJoins> factors(int asked, WeightPower power) const {
    const double atHit = double(samples) / asked;
    return {power(atHit), power(connections), power(laterConnections * atHit), 1};
  }
};
using WayMap = SquareMap<PixelWays>;

// Those among which is chosen, paths from the camera alone first; and how much larger than with one path and one
// connection the densities of a group are.
class WayCandidates {
 public:
  static constexpr size_t kCount = 48;  // at most

  WayCandidates();
  size_t size() const { return counts_.size(); }
  const WayCounts& at(size_t c) const { return counts_[c]; }
  static std::array<double, kJoins> factors(const WayCounts& counts);

  // Adds to sums[c] the second moment that a sample of value v says candidate c has.
  void add(std::array<float, kCount>& sums, float v, const Ways& ways) const {
    const double own = double(v) * double(v) * ways.sum();
    for (size_t c = 0; c < kCount; ++c) {
      double mixture = kNever * ways.sum();
      for (size_t j = 0; j < kJoins; ++j) mixture += factor_[j][c] * ways.of[j];
      sums[c] += static_cast<float>(own / mixture);
    }
  }

 private:
  // What no way of a candidate finds is missing from its image: worse than any noise.
  static constexpr double kNever = 1e-6;
  std::vector<WayCounts> counts_;
  double factor_[kJoins][kCount]{};
};

using WaySums = std::array<float, WayCandidates::kCount>;

// Of one technique's samples at a hit: only what they scatter counts, of which sharing can make less.
struct WayScatter {
  WaySums sums{};
  float sum = 0, squares = 0;
  int count = 0;

  // n: samples that were drawn.
  void addTo(WaySums& to, int n) const {
    if (!(squares > 0)) return;
    const float even = sum * sum / (static_cast<float>(n) * squares);
    const float part = n > 1 ? std::max(0.0f, 1 - even) * static_cast<float>(n) / static_cast<float>(n - 1) : 1;
    for (size_t c = 0; c < sums.size(); ++c) to[c] += part * sums[c];
  }
};

// Sums of estimates of the moments of a pixel's light under each group, from the samples of all, as Moments has them of
// a hit's techniques. The parts are what the same groups find: a group is not better than another since it sees less.
struct WayMoments {
  static constexpr size_t kParts = size_t{1} << kJoins;  // masks of groups
  struct Part {
    std::array<float, kJoins> second{};  // m_j^2 = integral f^2/p_j
    float square = 0, integral = 0;      // integral f^2/sum_k p_k, integral f
  };
  std::array<Part, kParts> part{};
  std::array<float, kJoins> square{}, mean{};  // integrals of g^2 p_j and g p_j with g = f/sum_k p_k

  // A sample of value v.
  void add(float v, const Ways& ways);
};

// The shares of the groups by an allocation that moments suffice for: of pixels, with as many samples each, whose means
// are given. available: mask of the groups that there may be.
std::array<double, kJoins> wayShares(Allocation, const std::vector<WayMoments>& pixels,
                                     const std::vector<double>& means, uint32_t samples, uint32_t available,
                                     double least);

// Of one camera sample after the other what each group brings to a pixel, and from these how far it is to be trusted.
struct GroupSums {
  std::array<float, kJoins> now{}, sum{}, squares{};

  void endSample() {
    for (size_t j = 0; j < kJoins; ++j) sum[j] += now[j], squares[j] += now[j] * now[j], now[j] = 0;
  }
};
// v_j = second moment / variance of what group j brings in one sample of a pixel, with balance weights: sums over
// pixels (of the latter, too, since each has a mean of its own). Never more than 16, as far as few samples can tell.
std::array<float, kJoins> varianceAware(const std::vector<const GroupSums*>& pixels, uint32_t samples);

// What a pilot notes.
struct WayTally {
  struct Pixel {
    WaySums sums{};
    float rays = 0;                 // of the camera's samples at its hits, and of paths that go on from there
    std::array<float, 2> joined{};  // vertices that were joined: the first, and later ones
  };
  WayCandidates candidates;
  std::vector<Pixel> pixels;
  std::vector<WayMoments> moments;  // where shares are wanted,
  std::optional<WayImages> images;  // or what each way brings; else the candidates are asked

  std::vector<GroupSums> groups;  // of each pixel, where the weights want them

  bool asksCandidates() const { return moments.empty() && !images; }
  void endSample() {
    for (GroupSums& g : groups) g.endSample();
    if (images) images->endSample();
  }
  void noteGroup(size_t pixel, float v, Join join) {
    if (!groups.empty()) groups[pixel].now[join] += v;
  }
  // A sample's value, with its weight; byLight: surfaces that a path from a light made.
  void note(size_t pixel, Rgb value, const Ways& ways, double weight, int byCamera, int byLight) {
    const float v = luminance(absolute(value));
    noteGroup(pixel, v, byLight == 0 ? kByCamera : byCamera == 0 ? kAtFilm : byCamera == 1 ? kAtFirst : kAtLater);
    if (images)
      images->add(pixel, byCamera + byLight, byCamera, value, weight);
    else if (!moments.empty())
      moments[pixel].add(v, ways);
    else
      candidates.add(pixels[pixel].sums, v, ways);
  }
};

}  // namespace wardmis
