// SPDX-License-Identifier: GPL-3.0-or-later
// A piecewise constant distribution over the cells of a grid, drawn from by inversion: a row by the marginal, a column
// by the row's own distribution (Pharr, Jakob and Humphreys 2016, section 13.6.7; guide tables: Chen and Asau 1974).
// Points that are spread evenly over the square stay so over the cells. An alias table would scatter them: of the
// samples of a sun as many would be too many or too few as of independent ones.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "math/random.h"
#include "math/table.h"

namespace wardmis {

class PiecewiseConstant2D {
 public:
  PiecewiseConstant2D() = default;
  // row(y, w) writes the weights of row y, >= 0 and finite, `width` of them; of either at most 65535. Called for each
  // row once, by several threads. Cells of less than 2^-24 of their row may never be drawn: then their probability is
  // 0.
  template <class Row>
  PiecewiseConstant2D(std::size_t rows, int width, const Row& row)
      : width_(static_cast<uint32_t>(width)), rows_(rows + 1), columns_(rows * (width_ + 1)), rowGuide_(kGuides) {
    columnGuide_.resize(rows * kGuides);
    std::vector<double> each(rows);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows), [&](const tbb::blocked_range<std::size_t>& range) {
      std::vector<double> w(width_);
      for (std::size_t y = range.begin(); y < range.end(); ++y) {
        row(y, w.data());
        float* const c = &columns_[y * (width_ + 1)];
        each[y] = cumulate(w.data(), width_, c);
        guide(c, width_, &columnGuide_[y * kGuides]);
      }
    });
    sum_ = cumulate(each.data(), rows, rows_.data());
    if (sum_ > 0)
      guide(rows_.data(), rows, rowGuide_.data());
    else
      *this = {};
  }

  bool empty() const { return rows_.empty(); }
  double sum() const { return sum_; }
  float probability(uint32_t cell) const {
    const uint32_t y = cell / width_, x = cell - y * width_;
    const float* const c = &columns_[std::size_t{y} * (width_ + 1) + x];
    return static_cast<float>(rows_[y + 1] - rows_[y]) * (c[1] - c[0]);
  }
  // Asks for what sample(u) and probability(cell) read: in a table of millions each is a wait for memory.
  void prefetch(ChoicePoint u) const {
    const std::size_t y = find(rows_.data(), rowGuide_.data(), u.x);
    const uint16_t* const g = &columnGuide_[y * kGuides + step(u.y)];
    fetch(&columns_[y * (width_ + 1) + (g[0] + g[1]) / 2]);
  }
  void prefetchProbability(uint32_t cell) const {
    const uint32_t y = cell / width_;
    fetch(&columns_[std::size_t{y} * (width_ + 1) + (cell - y * width_)]);
  }
  // A cell; x is replaced by what is left of it within the row, y by what is left within the column.
  uint32_t sample(ChoicePoint& u) const {
    const std::size_t y = find(rows_.data(), rowGuide_.data(), u.x);
    u.x = std::min((u.x - rows_[y]) / (rows_[y + 1] - rows_[y]), 0x1.fffffffffffffp-1);
    const float* const c = &columns_[y * (width_ + 1)];
    const std::size_t x = find(c, &columnGuide_[y * kGuides], u.y);
    u.y = std::min((u.y - c[x]) / (c[x + 1] - c[x]), 0x1.fffffep-1f);
    return static_cast<uint32_t>(y * width_ + x);
  }

 private:
  // A guide to a cumulated table has, for each 128th part of [0, 1), the first entry that reaches into it, and the last
  // one: few enough for the cache that is near, and between two of them are few.
  static constexpr std::size_t kSteps = 128, kGuides = kSteps + 1;

  // From 0 to 1, n + 1 numbers; floats are multiples of 2^-24, as the coordinate is, so that what is drawn has exactly
  // their differences. Returns the sum.
  template <class T>
  static double cumulate(const double* w, std::size_t n, T* to) {
    const double sum = std::accumulate(w, w + n, 0.0);
    double part = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const double c = sum > 0 ? std::min(part / sum, 1.0) : 0;
      to[i] = static_cast<T>(sizeof(T) == sizeof(float) ? std::round(c * 0x1p24) * 0x1p-24 : c);
      part += w[i];
    }
    to[n] = 1;
    if (sum > 0)
      for (std::size_t i = n; i-- > 0 && !(w[i] > 0);)
        to[i] = 1;  // what rounding leaves is not the last ones', that have none
    return sum;
  }
  template <class T>
  static void guide(const T* c, std::size_t n, uint16_t* to) {
    std::size_t at = 0;
    for (std::size_t k = 0; k < kSteps; ++k) {
      while (c[at + 1] <= static_cast<T>(k) / static_cast<T>(kSteps)) ++at;
      to[k] = static_cast<uint16_t>(at);
    }
    to[kSteps] = static_cast<uint16_t>(n - 1);
  }
  template <class T>
  static std::size_t step(T u) {
    return static_cast<std::size_t>(u * static_cast<T>(kSteps));
  }
  // i with c[i] <= u < c[i + 1].
  template <class T>
  static std::size_t find(const T* c, const uint16_t* guide, T u) {
    const std::size_t k = step(u);
    return static_cast<std::size_t>(std::upper_bound(c + guide[k] + 1, c + guide[k + 1] + 1, u) - c) - 1;
  }

  uint32_t width_ = 1;
  double sum_ = 0;
  std::vector<double> rows_;                // cumulated
  Table<float> columns_;                    // of each row
  Table<uint16_t> rowGuide_, columnGuide_;  // the latter of each row
};

}  // namespace wardmis
