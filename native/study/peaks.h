// SPDX-License-Identifier: GPL-3.0-or-later
// Integrals over an angle of what is so sharp, or so small, that only its logarithm can be held.
#pragma once

#include <algorithm>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "math/number.h"

namespace wardmis {

// ln of sum_i exp(E_i) I_i over an angle, integrated: exp(peak(psi)) * rest(psi) over a whole turn, where peak may be
// so sharp that nothing but its maxima counts.
template <class Peak, class Rest>
double logIntegralOfPeaks(const Peak& peak, const Rest& rest) {
  constexpr int kGrid = 4096;
  constexpr double kPid = kPi<double>, kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> e(kGrid);
  for (int i = 0; i < kGrid; ++i) e[static_cast<size_t>(i)] = peak(2 * kPid * i / kGrid);
  const auto at = [&](int i) { return e[static_cast<size_t>((i + kGrid) % kGrid)]; };
  const double top = *std::max_element(e.begin(), e.end());
  if (top - *std::min_element(e.begin(), e.end()) < 1) {  // flat: the trapezoidal rule of a periodic function
    constexpr int kCoarse = 256;
    double sum = 0;
    for (int i = 0; i < kCoarse; ++i) {
      const double v = 2 * kPid * i / kCoarse;
      sum += std::exp(peak(v) - top) * rest(v) * (2 * kPid / kCoarse);
    }
    return top + std::log(sum);
  }
  std::vector<int> maxima;
  for (int i = 0; i < kGrid; ++i)
    if (at(i) > at(i - 1) && at(i) >= at(i + 1) && at(i) >= top - 700) maxima.push_back(i);
  boost::math::quadrature::tanh_sinh<double> quadrature(12);
  double sum = 0, scale = -kInfinity;
  std::vector<double> exact;
  for (int i : maxima) {
    const double step = 2 * kPid / kGrid;
    const auto [x, y] =
        boost::math::tools::brent_find_minima([&](double v) { return -peak(v); }, (i - 1) * step, (i + 1) * step, 50);
    exact.push_back(x);
    scale = std::max(scale, -y);
  }
  constexpr double kBeyond = 1e12;  // there the logarithm's own rounding is more than what the peak's width adds
  if (scale > kBeyond) return scale;
  for (size_t k = 0; k < maxima.size(); ++k)
    for (int side : {-1, 1}) {
      // to the lowest point on the way to the neighbouring maximum
      const size_t n = maxima.size(), other = (k + (side > 0 ? 1 : n - 1)) % n;
      int steps = side * (maxima[other] - maxima[k]);
      if (steps <= 0) steps += kGrid;
      int lowest = 0;
      for (int s = 0; s <= steps; ++s)
        if (at(maxima[k] + side * s) < at(maxima[k] + side * lowest)) lowest = s;
      const double length = std::abs(2 * kPid * (maxima[k] + side * lowest) / kGrid - exact[k]);
      sum += quadrature.integrate(
          [&](double d) {
            const double v = exact[k] + side * d, weight = peak(v) - scale;
            return weight < -700 ? 0.0 : std::exp(weight) * rest(v);
          },
          0.0, length, 1e-9);
    }
  return scale + std::log(sum);
}

}  // namespace wardmis
