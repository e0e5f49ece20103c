// SPDX-License-Identifier: GPL-3.0-or-later
// Adaptive quadrature of several integrals at once, over the charts of a problem, that keeps its nodes: afterwards any
// other integral of the same functions is a sum over them. The rule is Boost's Gauss-Kronrod 7-15, in two dimensions
// its product; a cell is halved along the direction that converges worse.
#pragma once

#include <optional>

#include "study/problem.h"

namespace wardmis {

// Writes the integrands that are to be accurate, at one point, to out[0..count).
struct Integrands {
  int count = 0;
  std::function<void(const Point&, double* out)> evaluate;
};

class Cubature {
 public:
  using Side = std::function<unsigned(const Point&)>;

  explicit Cubature(const Problem& problem);
  ~Cubature();

  // Halves cells until the estimated error of each integral is below `tolerance` of its value, or `more` cells have
  // been added. May be called again with others: what was refined stays so. Returns, for
  // integrands that jump, their absolute errors: the differences of the two rules, of the sign of chance in each cell.
  std::vector<double> refine(const Integrands& integrands, double tolerance, size_t more = 4000);

  // For integrands that jump: `side` tells the sides apart. In one dimension cells are split where it changes, so that
  // each integral is smooth in every cell. (The rules do not always see a jump.) In two, every line of a cell's nodes
  // is split where it changes, and cells that it crosses are halved across the lines until the estimated error of each
  // of the integrals is below `tolerance` of its value, or `more` have been added. The last of all calls: refine() does
  // not know such cells. Returns absolute errors as refine() does.
  std::vector<double> splitAtJumps(const Side& side, const Integrands& integrands, double tolerance, size_t more);

  // The nodes, with the techniques' masses outside the domain.
  Points points() const;

 private:
  struct Cell;
  Cell make(int chart, double u0, double u1, double v0, double v1) const;
  // Halves the cell with the largest estimated error until each integral's is below `tolerance` of its value, or `more`
  // cells have been added. total: of each integral, kept up to date; halve: two measured cells in place of one.
  template <class Halve>
  void halveTheWorst(std::vector<double>& total, double tolerance, size_t more, Halve&& halve);
  // Of the two rules, over all cells.
  std::vector<double> differences(size_t integrals) const;
  // Where along u, between two of the ascending `nodes`, the side changes.
  std::vector<double> jumpsAlong(const Chart& chart, double v, const std::vector<double>& nodes,
                                 const Side& side) const;
  // A cell whose lines of nodes are split at jumps; nothing if none crosses it.
  std::optional<Cell> makeSplit(const Cell& whole, const Side& side) const;

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
