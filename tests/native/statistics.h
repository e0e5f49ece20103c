// SPDX-License-Identifier: GPL-3.0-or-later
// Chi-square test of a sampler against its density.
#pragma once

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss.hpp>
#include <vector>

#include "math/number.h"
#include "math/vec.h"

namespace wardmis::test {

// p-value of: sample(u) has density pdf(direction) per solid angle, on a grid over the sphere in (cos theta, phi). What
// the density says nothing of (its integral may be below 1) forms one more cell, as do cells that expect under 5.
template <class Sample, class Pdf, class Random>
double chiSquare(Sample&& sample, Pdf&& pdf, Random&& random, int count, int rows, int columns, double* integral = nullptr) {
  const double pi = kPi<double>;
  std::vector<double> observed(static_cast<size_t>(rows * columns), 0), expected(observed.size(), 0);
  double outside = 0;
  for (int i = 0; i < count; ++i) {
    const Vec3<double> d = sample(random());
    if (!(pdf(d) > 0)) {
      ++outside;
      continue;
    }
    const int r = std::clamp(static_cast<int>((d.z + 1) / 2 * rows), 0, rows - 1);
    const int c = std::clamp(static_cast<int>((std::atan2(d.y, d.x) + pi) / (2 * pi) * columns), 0, columns - 1);
    ++observed[static_cast<size_t>(r * columns + c)];
  }
  using Gauss = boost::math::quadrature::gauss<double, 15>;
  double total = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto at = [&](double z, double phi) {
        const double s = std::sqrt(std::max(0.0, 1 - z * z));
        return pdf(Vec3<double>{s * std::cos(phi), s * std::sin(phi), z});
      };
      double cell = 0;
      constexpr int kSplit = 4;  // narrow lobes: several panels a cell
      for (int i = 0; i < kSplit; ++i)
        for (int j = 0; j < kSplit; ++j) {
          const double z0 = -1 + 2 * (r + double(i) / kSplit) / rows, z1 = -1 + 2 * (r + double(i + 1) / kSplit) / rows;
          const double p0 = -pi + 2 * pi * (c + double(j) / kSplit) / columns, p1 = -pi + 2 * pi * (c + double(j + 1) / kSplit) / columns;
          cell += Gauss::integrate([&](double z) { return Gauss::integrate([&](double phi) { return at(z, phi); }, p0, p1); }, z0, z1);
        }
      expected[static_cast<size_t>(r * columns + c)] = cell * count;
      total += cell;
    }
  if (integral != nullptr) *integral = total;
  double statistic = 0, poolObserved = outside, poolExpected = std::max(0.0, 1 - total) * count;
  int cells = 0;
  for (size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 5) {
      poolObserved += observed[i], poolExpected += expected[i];
      continue;
    }
    statistic += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
    ++cells;
  }
  if (poolExpected >= 5) statistic += (poolObserved - poolExpected) * (poolObserved - poolExpected) / poolExpected, ++cells;
  else if (poolObserved > poolExpected + 30) return 0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(std::max(1, cells - 1)), statistic));
}

}  // namespace wardmis::test
