// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/cubature.h"

#include <algorithm>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <queue>

namespace wardmis {

namespace {

constexpr int kNodes = 15;
constexpr int kMaxDepth = 48;

struct Rule {
  std::array<double, kNodes> x{}, kronrod{}, gauss{};  // on [-1, 1]; gauss: 0 at the nodes that it lacks

  Rule() {
    using Kronrod = boost::math::quadrature::gauss_kronrod<double, kNodes>;
    using Gauss = boost::math::quadrature::gauss<double, 7>;
    const auto& nodes = Kronrod::abscissa();  // 0 and the positive ones; every other one is Gauss'
    for (size_t i = 0; i < nodes.size(); ++i) {
      const double k = Kronrod::weights()[i], g = i % 2 == 0 ? Gauss::weights()[i / 2] : 0;
      x[7 + i] = nodes[i], kronrod[7 + i] = k, gauss[7 + i] = g;
      x[7 - i] = -nodes[i], kronrod[7 - i] = k, gauss[7 - i] = g;
    }
  }
};

const Rule& rule() {
  static const Rule r;
  return r;
}

}  // namespace

struct Cubature::Cell {
  int chart = 0;
  double u0 = 0, u1 = 1, v0 = 0, v1 = 1;
  std::vector<Point> points;  // u fastest; w holds measure x both Kronrod weights

  // Of the current integrands.
  std::vector<double> value, error;
  std::vector<double> difference;  // of the two rules, the larger of both directions
  bool alongU = true;
  std::vector<uint8_t> lines{};  // of each point, where lines are split at jumps; else empty

  int rows() const { return static_cast<int>(points.size()) / kNodes; }
  bool tiny() const { return u1 - u0 < std::ldexp(1.0, -kMaxDepth) && v1 - v0 < std::ldexp(1.0, -kMaxDepth); }
};

Cubature::Cubature(const Problem& problem) : problem_(problem), charts_(problem.charts()) {
  for (size_t c = 0; c < charts_.size(); ++c) {
    const bool flat = charts_[c].dimensions == 1;
    const int columns = flat ? 16 : 4;
    const std::vector<double> v = flat ? std::vector<double>{0, 1} : charts_[c].breaks;
    for (size_t i = 0; i + 1 < v.size(); ++i)
      for (int j = 0; j < columns; ++j)
        cells_.push_back(make(static_cast<int>(c), double(j) / columns, (j + 1.0) / columns, v[i], v[i + 1]));
  }
}
Cubature::~Cubature() = default;

Cubature::Cell Cubature::make(int chart, double u0, double u1, double v0, double v1) const {
  Cell cell{chart, u0, u1, v0, v1, {}, {}, {}, {}, true};
  const Chart& map = charts_[static_cast<size_t>(chart)];
  const Rule& r = rule();
  const int rows = map.dimensions == 1 ? 1 : kNodes;
  cell.points.reserve(static_cast<size_t>(rows) * kNodes);
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t j = 0; j < kNodes; ++j) {
      const double u = 0.5 * (u0 + u1) + 0.5 * (u1 - u0) * r.x[j];
      const double v = rows == 1 ? 0.5 : 0.5 * (v0 + v1) + 0.5 * (v1 - v0) * r.x[i];
      Point p = map.at(u, v);
      const double size = p.w * 0.5 * (u1 - u0) * (rows == 1 ? 1 : 0.5 * (v1 - v0));
      p.w = size * r.kronrod[j] * (rows == 1 ? 1 : r.kronrod[i]);
      p.error = size * r.gauss[j] * (rows == 1 ? 1 : r.gauss[i]);
      cell.points.push_back(p);
    }
  return cell;
}

std::vector<double> Cubature::refine(const Integrands& integrands, double tolerance, size_t more) {
  const auto n = static_cast<size_t>(integrands.count);
  const Rule& r = rule();
  std::vector<double> total(n, 0), h(n);
  const auto measure = [&](Cell& cell) {
    // differences of the two rules along each line of nodes: summed over the lines with their signs, they may cancel
    // where the integral's error does not
    std::vector<std::array<double, kNodes>> lineU(n), lineV(n);
    std::vector<double> size(n, 0);
    cell.value.assign(n, 0), cell.error.assign(n, 0), cell.difference.assign(n, 0);
    for (size_t m = 0; m < cell.points.size(); ++m) {
      const Point& p = cell.points[m];
      integrands.evaluate(p, h.data());
      const size_t j = m % kNodes, i = m / kNodes;
      const double gu = r.gauss[j] / r.kronrod[j], gv = cell.rows() == 1 ? 1 : r.gauss[i] / r.kronrod[i];
      for (size_t k = 0; k < n; ++k) {
        const double v = p.w * h[k];
        cell.value[k] += v, size[k] += std::abs(v), lineU[k][i] += v * (gu - 1), lineV[k][j] += v * (gv - 1);
      }
    }
    double worstU = 0, worstV = 0;
    for (size_t k = 0; k < n; ++k) {
      if (!(size[k] > 0)) continue;
      // QUADPACK's estimate: the difference of the two rules is the error of the lower one
      const auto estimate = [&](double difference) {
        return size[k] * std::pow(std::min(1.0, 200 * difference / size[k]), 1.5);
      };
      const auto sum = [](const auto& lines) {
        double all = 0;
        for (double line : lines) all += std::abs(line);
        return all;
      };
      const double inU = sum(lineU[k]), inV = sum(lineV[k]);
      const double eu = estimate(inU), ev = estimate(inV);
      cell.error[k] = eu + ev;
      cell.difference[k] = std::max(inU, inV);
      const double scale = std::max(std::abs(total[k]), size[k]);
      worstU = std::max(worstU, eu / scale), worstV = std::max(worstV, ev / scale);
    }
    cell.alongU = worstU >= worstV;
  };
  for (Cell& cell : cells_) {
    measure(cell);
    for (size_t k = 0; k < n; ++k) total[k] += cell.value[k];
  }
  for (Cell& cell : cells_) measure(cell);  // again, now that the totals are known
  halveTheWorst(total, tolerance, more, [&](const Cell& parent) {
    const double u = 0.5 * (parent.u0 + parent.u1), v = 0.5 * (parent.v0 + parent.v1);
    Cell one = parent.alongU ? make(parent.chart, parent.u0, u, parent.v0, parent.v1)
                             : make(parent.chart, parent.u0, parent.u1, parent.v0, v);
    Cell two = parent.alongU ? make(parent.chart, u, parent.u1, parent.v0, parent.v1)
                             : make(parent.chart, parent.u0, parent.u1, v, parent.v1);
    measure(one), measure(two);
    return std::pair{std::move(one), std::move(two)};
  });
  return differences(n);
}

template <class Halve>
void Cubature::halveTheWorst(std::vector<double>& total, double tolerance, size_t more, Halve&& halve) {
  const size_t most = cells_.size() + more, n = total.size();
  std::vector<double> error(n, 0);
  for (const Cell& cell : cells_)
    for (size_t k = 0; k < n; ++k) error[k] += cell.error[k];
  const auto worst = [&](const Cell& cell) {
    double w = 0;
    for (size_t k = 0; k < n; ++k)
      if (error[k] > tolerance * std::abs(total[k])) w = std::max(w, cell.error[k] / std::abs(total[k]));
    return w;
  };
  std::priority_queue<std::pair<double, size_t>> queue;
  for (size_t c = 0; c < cells_.size(); ++c) queue.emplace(worst(cells_[c]), c);
  while (!queue.empty() && cells_.size() < most) {
    const auto [was, c] = queue.top();
    queue.pop();
    const double now = worst(cells_[c]);
    if (now < was * (1 - 1e-9)) {  // its integrals have converged meanwhile, or grown
      if (now > 0) queue.emplace(now, c);
      continue;
    }
    if (!(now > 0) || cells_[c].tiny()) continue;
    const Cell parent = std::move(cells_[c]);
    auto [one, two] = halve(parent);
    for (size_t k = 0; k < n; ++k) {
      total[k] += one.value[k] + two.value[k] - parent.value[k];
      error[k] += one.error[k] + two.error[k] - parent.error[k];
    }
    cells_[c] = std::move(one);
    cells_.push_back(std::move(two));
    queue.emplace(worst(cells_[c]), c);
    queue.emplace(worst(cells_.back()), cells_.size() - 1);
  }
}

std::vector<double> Cubature::differences(size_t n) const {
  std::vector<double> difference(n, 0);
  for (const Cell& cell : cells_)
    for (size_t k = 0; k < n; ++k) difference[k] += cell.difference[k] * cell.difference[k];
  for (double& d : difference) d = std::sqrt(d);
  return difference;
}

std::vector<double> Cubature::jumpsAlong(const Chart& chart, double v, const std::vector<double>& nodes,
                                         const Side& side) const {
  std::vector<double> jumps;
  const auto sideAt = [&](double u) { return side(chart.at(u, v)); };
  unsigned before = sideAt(nodes.front());
  for (size_t k = 0; k + 1 < nodes.size(); ++k) {
    double low = nodes[k], high = nodes[k + 1];
    const unsigned after = sideAt(high);
    if (before != after) {
      for (double middle; (middle = 0.5 * (low + high)) > low && middle < high;)
        (sideAt(middle) == before ? low : high) = middle;
      jumps.push_back(high);
    }
    before = after;
  }
  return jumps;
}

std::optional<Cubature::Cell> Cubature::makeSplit(const Cell& whole, const Side& side) const {
  const Chart& map = charts_[static_cast<size_t>(whole.chart)];
  const Rule& r = rule();
  const auto place = [&](double from, double to, size_t k) { return 0.5 * (from + to) + 0.5 * (to - from) * r.x[k]; };
  // where a cell's edge is the domain's, there may be no density to tell a side by
  const auto inside = [](double from, double to) { return from + 1e-9 * (to - from); };
  std::vector<double> nodes{inside(whole.u0, whole.u1)};
  for (size_t j = 0; j < kNodes; ++j) nodes.push_back(place(whole.u0, whole.u1, j));
  nodes.push_back(inside(whole.u1, whole.u0));
  Cell cell{whole.chart, whole.u0, whole.u1, whole.v0, whole.v1, {}, {}, {}, {}, false};
  // the first and last lines are no nodes: a jump may cross the cell between these and the edge
  bool crossed = !jumpsAlong(map, inside(whole.v0, whole.v1), nodes, side).empty() ||
                 !jumpsAlong(map, inside(whole.v1, whole.v0), nodes, side).empty();
  for (size_t i = 0; i < kNodes; ++i) {
    const double v = place(whole.v0, whole.v1, i), height = 0.5 * (whole.v1 - whole.v0);
    std::vector<double> ends = jumpsAlong(map, v, nodes, side);
    crossed = crossed || !ends.empty();
    ends.insert(ends.begin(), whole.u0), ends.push_back(whole.u1);
    for (size_t k = 0; k + 1 < ends.size(); ++k)
      for (size_t j = 0; j < kNodes; ++j) {
        Point p = map.at(place(ends[k], ends[k + 1], j), v);
        const double size = p.w * 0.5 * (ends[k + 1] - ends[k]) * height;
        p.w = size * r.kronrod[j] * r.kronrod[i];
        p.error = size * r.gauss[j] * r.gauss[i];
        cell.points.push_back(p);
        cell.lines.push_back(static_cast<uint8_t>(i));
      }
  }
  if (!crossed) return {};
  return cell;
}

std::vector<double> Cubature::splitAtJumps(const Side& side, const Integrands& integrands, double tolerance,
                                           size_t more) {
  for (size_t c = 0; c < charts_.size(); ++c) {
    if (charts_[c].dimensions != 1) continue;
    std::vector<double> nodes;
    for (const Cell& cell : cells_)
      if (cell.chart == static_cast<int>(c))
        for (double x : rule().x) nodes.push_back(0.5 * (cell.u0 + cell.u1) + 0.5 * (cell.u1 - cell.u0) * x);
    std::sort(nodes.begin(), nodes.end());
    for (const double jump : jumpsAlong(charts_[c], 0.5, nodes, side))
      for (Cell& cell : cells_) {
        if (cell.chart != static_cast<int>(c) || !(cell.u0 < jump && jump < cell.u1)) continue;
        Cell right = make(cell.chart, jump, cell.u1, cell.v0, cell.v1);
        cell = make(cell.chart, cell.u0, jump, cell.v0, cell.v1);
        cells_.push_back(std::move(right));
        break;
      }
  }
  if (charts_.front().dimensions == 1) return refine(integrands, tolerance, more);

  const auto n = static_cast<size_t>(integrands.count);
  const Rule& r = rule();
  std::vector<double> total(n, 0), h(n);
  // Along v: the sum over a line is smooth in v, but for where the jump leaves the cell.
  const auto splitAndMeasure = [&](Cell cell) {
    if (std::optional<Cell> split = makeSplit(cell, side)) cell = std::move(*split);
    cell.value.assign(n, 0), cell.difference.assign(n, 0);
    const bool split = !cell.lines.empty();
    for (size_t m = 0; m < cell.points.size(); ++m) {
      const Point& p = cell.points[m];
      integrands.evaluate(p, h.data());
      const size_t i = split ? cell.lines[m] : 0;
      for (size_t k = 0; k < n; ++k) {
        cell.value[k] += p.w * h[k];
        if (split) cell.difference[k] += p.w * h[k] * (r.gauss[i] / r.kronrod[i] - 1);
      }
    }
    for (double& d : cell.difference) d = std::abs(d);
    cell.error = cell.difference;
    return cell;
  };
  for (Cell& cell : cells_) {
    cell = splitAndMeasure(std::move(cell));
    for (size_t k = 0; k < n; ++k) total[k] += cell.value[k];
  }
  halveTheWorst(total, tolerance, more, [&](const Cell& parent) {
    const double v = 0.5 * (parent.v0 + parent.v1);
    return std::pair{splitAndMeasure(make(parent.chart, parent.u0, parent.u1, parent.v0, v)),
                     splitAndMeasure(make(parent.chart, parent.u0, parent.u1, v, parent.v1))};
  });
  return differences(n);
}

Points Cubature::points() const {
  Points all;
  all.techniques = problem_.techniques();
  for (int i = 0; i < all.techniques; ++i) all.setOutside(static_cast<size_t>(i), problem_.logOutside(i));
  for (const Cell& cell : cells_) all.list.insert(all.list.end(), cell.points.begin(), cell.points.end());
  return all;
}

}  // namespace wardmis
