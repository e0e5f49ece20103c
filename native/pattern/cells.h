// SPDX-License-Identifier: GPL-3.0-or-later
// The lattice of Voronoi's points, one at random in each cell, and the cells around one.
#pragma once

#include "pattern/hash.h"

namespace wardmis::pattern {

template <int D>
using Offset = std::array<int, D>;

// The (2 Reach + 1)^D cells around one, the first dimension fastest: the order in which Cycles looks, which decides
// between equal distances and is part of what a smooth minimum is.
template <int D, int Reach>
struct Neighbours {
  static constexpr int kCount = [] {
    int n = 1;
    for (int d = 0; d < D; d++) n *= 2 * Reach + 1;
    return n;
  }();
  static constexpr std::array<std::array<int, kCount>, D> kOffsets = [] {
    std::array<std::array<int, kCount>, D> r{};
    for (int n = 0; n < kCount; n++) {
      for (int d = 0, rest = n; d < D; d++, rest /= 2 * Reach + 1) r[d][n] = rest % (2 * Reach + 1) - Reach;
    }
    return r;
  }();
  static constexpr Offset<D> offset(int n) {
    Offset<D> r{};
    for (int d = 0; d < D; d++) r[d] = kOffsets[d][n];
    return r;
  }
};

// The cells around p. A cell is named by its offset from that of p, a point by its place relative to p's cell.
template <int D>
class Cells {
 public:
  // The points of some cells as structure of arrays, so that loops over them vectorise.
  template <int Count>
  using Points = std::array<std::array<float, Count>, D>;

  Cells(Version version, float randomness, const Point<D>& p)
      : integer_(version == Version::kBlender5 && D > 1),
        randomness_(randomness),
        corner_(floor(p)),
        local_(p - corner_) {
    for (int d = 0; d < D; d++) index_[d] = static_cast<uint32_t>(toInt(corner_[d]));
  }
  const Point<D>& corner() const { return corner_; }  // of p's cell
  const Point<D>& local() const { return local_; }    // p from there

  // Those of the neighbours of the cell at `center`.
  template <int Reach>
  Points<Neighbours<D, Reach>::kCount> points(const Offset<D>& center = {}) const {
    using N = Neighbours<D, Reach>;
    Points<N::kCount> r;
    const auto place = [&](int n, const auto& hash) {
      Offset<D> offset = N::offset(n);
      for (int d = 0; d < D; d++) offset[d] += center[d];
      const std::array<float, D> u = hash(offset);
      for (int d = 0; d < D; d++) r[d][n] = static_cast<float>(offset[d]) + u[d] * randomness_;
    };
    if constexpr (D > 1) {
      if (integer_) {
        for (int n = 0; n < N::kCount; n++) place(n, [&](const Offset<D>& o) { return pcgToUnits(index(o)); });
        return r;
      }
    }
    for (int n = 0; n < N::kCount; n++) place(n, [&](const Offset<D>& o) { return hashToUnits<D>(cell(o)); });
    return r;
  }
  Rgb color(const Offset<D>& offset) const {
    if constexpr (D > 1) {
      if (integer_) {
        std::array<int, std::max(D, 3)> key{};
        const auto i = index(offset);
        for (int d = 0; d < D; d++) key[d] = i[d];
        const auto u = pcgToUnits(key);
        return {u[0], u[1], u[2]};
      }
    }
    return hashToColor(cell(offset));
  }

 private:
  Point<D> cell(const Offset<D>& offset) const {
    Point<D> r;
    for (int d = 0; d < D; d++) r[d] = corner_[d] + static_cast<float>(offset[d]);
    return r;
  }
  std::array<int, D> index(const Offset<D>& offset) const {
    std::array<int, D> r;
    for (int d = 0; d < D; d++) r[d] = static_cast<int>(index_[d] + static_cast<uint32_t>(offset[d]));
    return r;
  }

  bool integer_;  // cells are hashed as integers, by PCG, not as floats
  float randomness_;
  Point<D> corner_, local_;
  std::array<uint32_t, D> index_;
};

// The n-th of some points.
template <int D, size_t Count>
constexpr Point<D> nth(const std::array<std::array<float, Count>, D>& points, int n) {
  Point<D> r;
  for (int d = 0; d < D; d++) r[d] = points[d][n];
  return r;
}

}  // namespace wardmis::pattern
