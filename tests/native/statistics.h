// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of random quantities need: a generator that is not the renderer's own, and the chi-square test of a
// sampler against its density.
#pragma once

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "math/number.h"
#include "math/statistics.h"
#include "math/vec.h"

namespace wardmis::test {

// Reproducible on every platform: the standard fixes mt19937_64, and the distributions here are our own.
class Random {
 public:
  explicit Random(uint64_t seed) : bits_(seed) {}
  double uniform() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }
  double uniform(double lo, double hi) { return lo + (hi - lo) * uniform(); }
  double logUniform(double lo, double hi) { return std::exp(uniform(std::log(lo), std::log(hi))); }
  int integer(int lo, int hi) { return lo + static_cast<int>(uniform() * (hi - lo + 1)); }
  template <class T = double>
  Vec2<T> square() {
    // a multiple of 2^-24, as the renderer's own numbers
    const auto one = [&] { return static_cast<T>(bits_() >> 40) * T(0x1p-24); };
    const T x = one();
    return {x, one()};
  }
  // Uniform on the sphere.
  Vec3<double> direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * kPi<double>), s = std::sqrt(1 - z * z);
    return {s * std::cos(phi), s * std::sin(phi), z};
  }
  Vec3<double> above() {
    Vec3<double> d = direction();
    d.z = std::abs(d.z);
    return d;
  }

 private:
  std::mt19937_64 bits_;
};

using wardmis::Estimate;

struct Fit {
  double p;     // probability of a worse fit if the density is right
  double mass;  // integral of the density over the grid
};

// sample() gives a point of the chart, or nothing where the density is zero; massOf(x0, x1, y0, y1) is the density's
// integral over a cell. Outside the grid, and in cells that expect under 5 samples, all counts are pooled into one
// cell.
template <class Sample, class Mass>
Fit chiSquareOfCells(Sample&& sample, Mass&& massOf, int count, const std::vector<double>& xs,
                     const std::vector<double>& ys) {
  const size_t columns = xs.size() - 1, rows = ys.size() - 1;
  std::vector<double> observed(columns * rows, 0);
  double poolObserved = 0;
  const auto cell = [](const std::vector<double>& edges, double v) {
    return static_cast<size_t>(std::upper_bound(edges.begin(), edges.end(), v) - edges.begin()) -
           1;  // edges.size() and more: outside
  };
  for (int i = 0; i < count; ++i) {
    const std::optional<Vec2<double>> v = sample();
    const size_t x = v ? cell(xs, v->x) : columns, y = v ? cell(ys, v->y) : rows;
    if (x < columns && y < rows)
      ++observed[y * columns + x];
    else
      ++poolObserved;
  }
  double mass = 0, statistic = 0, poolExpected = 0;
  int cells = 0;
  for (size_t y = 0; y < rows; ++y)
    for (size_t x = 0; x < columns; ++x) {
      const double in = massOf(xs[x], xs[x + 1], ys[y], ys[y + 1]), expected = in * count;
      mass += in;
      if (expected < 5) {
        poolObserved += observed[y * columns + x], poolExpected += expected;
        continue;
      }
      statistic += square(observed[y * columns + x] - expected) / expected;
      ++cells;
    }
  poolExpected += std::max(0.0, 1 - mass) * count;
  if (poolExpected >= 5)
    statistic += square(poolObserved - poolExpected) / poolExpected, ++cells;
  else if (poolObserved > poolExpected + 25)
    return {0, mass};
  return {boost::math::cdf(boost::math::complement(boost::math::chi_squared(std::max(1, cells - 1)), statistic)), mass};
}

// The same of density(x, y), per area of the chart, which is smooth.
template <class Sample, class Density>
Fit chiSquare(Sample&& sample, Density&& density, int count, const std::vector<double>& xs,
              const std::vector<double>& ys) {
  using Quadrature = boost::math::quadrature::gauss_kronrod<double, 15>;
  const auto mass = [&](double x0, double x1, double y0, double y1) {
    const auto line = [&](double v) {
      return Quadrature::integrate([&](double u) { return density(u, v); }, x0, x1, 5, 1e-6);
    };
    return Quadrature::integrate(line, y0, y1, 5, 1e-6);
  };
  return chiSquareOfCells(sample, mass, count, xs, ys);
}

inline std::vector<double> evenEdges(double lo, double hi, int cells) {
  std::vector<double> edges;
  for (int i = 0; i <= cells; ++i) edges.push_back(lo + (hi - lo) * i / cells);
  return edges;
}

// Edges that part the values into `cells` of about equal number; two more cells reach from the values to lo and hi.
inline std::vector<double> quantileEdges(std::vector<double> values, double lo, double hi, int cells) {
  std::sort(values.begin(), values.end());
  std::vector<double> edges{lo};
  for (int i = 0; i <= cells; ++i) {
    const double v = values[(values.size() - 1) * static_cast<size_t>(i) / static_cast<size_t>(cells)];
    if (v > edges.back() && v < hi) edges.push_back(v);
  }
  edges.push_back(hi);
  return edges;
}

// The test on the upper hemisphere: sample() gives directions, pdf is per solid angle. The grid in (z, phi) follows the
// lobe: its edges are quantiles of other samples.
template <class Sample, class Pdf>
Fit chiSquareHemisphere(Sample&& sample, Pdf&& pdf, int count, int cells) {
  std::vector<double> zs, phis;
  std::vector<Vec3<double>> others;
  Vec3<double> middle;
  for (int i = 0; i < 4000; ++i) {
    others.push_back(sample());
    if (others.back().z > 0) middle += others.back();
  }
  // phi from the middle of the lobe, so that the cut at +-pi is far from it
  const double turn = std::atan2(middle.y, middle.x), c = std::cos(turn), s = std::sin(turn);
  const auto phi = [&](Vec3<double> d) { return std::atan2(c * d.y - s * d.x, c * d.x + s * d.y); };
  for (const Vec3<double>& d : others)
    if (d.z > 0) zs.push_back(d.z), phis.push_back(phi(d));
  if (zs.size() < static_cast<size_t>(cells)) return {1, 0};  // nothing there
  const auto point = [&]() -> std::optional<Vec2<double>> {
    const Vec3<double> d = sample();
    if (!(d.z > 0)) return std::nullopt;
    return Vec2<double>{std::min(d.z, std::nextafter(1.0, 0.0)), phi(d)};
  };
  const auto density = [&](double z, double p) {
    const double sine = std::sqrt(1 - z * z);
    return pdf(Vec3<double>{sine * std::cos(p + turn), sine * std::sin(p + turn), z});
  };
  const double pi = kPi<double>;
  return chiSquare(point, density, count, quantileEdges(zs, 0, 1, cells), quantileEdges(phis, -pi, pi, cells));
}

}  // namespace wardmis::test
