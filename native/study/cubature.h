// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive quadrature of several integrals at once, over the charts of a problem, that keeps its nodes: afterwards any
// other integral of the same functions is a sum over them. The rule is Boost's Gauss-Kronrod 7-15, in two dimensions
// its product; a cell is halved along the direction that converges worse.
#pragma once

#include "study/problem.h"

namespace wardmis {

// Writes the integrands that are to be accurate, at one point, to out[0..count).
struct Integrands {
  int count = 0;
  std::function<void(const Point&, double* out)> evaluate;
};

class Cubature {
 public:
  explicit Cubature(const Problem& problem);
  ~Cubature();

  // Halves cells until the estimated error of each integral is below `tolerance` of its value, or `more` cells have
  // been added. May be called again with others: what was refined stays so. Returns, for
  // integrands that jump, their absolute errors: the differences of the two rules, of the sign of chance in each cell.
  std::vector<double> refine(const Integrands& integrands, double tolerance, size_t more = 4000);

  // In one dimension, where integrands jump at points: `side` tells the sides apart, and cells are split where it
  // changes between two nodes, so that each integral is smooth in every cell. (The rules do not always see a jump.)
  void splitAtJumps(const std::function<unsigned(const Point&)>& side);

  // The nodes, with the techniques' masses outside the domain.
  Points points() const;

 private:
  struct Cell;
  Cell make(int chart, double u0, double u1, double v0, double v1) const;

  const Problem& problem_;
  std::vector<Chart> charts_;
  std::vector<Cell> cells_;
};

// The estimated relative error of the integral of h over such nodes: of the difference between the two rules, as
// QUADPACK scales it.
template <class F>
double relativeError(const Points& points, F&& h) {
  double sum = 0, lower = 0, size = 0;
  for (const Point& x : points.list) {
    const double v = h(x);
    sum += x.w * v, lower += x.error * v, size += x.w * std::abs(v);
  }
  if (!(size > 0)) return 0;
  return std::pow(std::min(1.0, 200 * std::abs(sum - lower) / size), 1.5);
}

}  // namespace wardmis
