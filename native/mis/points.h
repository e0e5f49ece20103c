// SPDX-License-Identifier: GPL-3.0-or-later
// Weighted points that stand for an integral over the domain: sum_m w_m h(x_m) for the integral of h, with the
// integrand f and every technique's density p_k known at each. The nodes of a quadrature and the samples of a pilot are
// both such points, so that what an allocation needs to know of an integrand is written once for both.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "mis/technique.h"

namespace wardmis {

using Densities = std::array<double, kMaxTechniques>;  // one number a technique

struct Point {
  double f = 0;      // integrand, >= 0
  double w = 0;      // weight: the measure that the point stands for
  double error = 0;  // weight of the embedded lower rule (quadrature alone): its sum differs by the estimated error
  Densities p{};     // densities
  Densities logP{};  // their logarithms, finite where p underflows
};

constexpr Densities noLogarithms() {
  Densities log{};
  for (double& x : log) x = -std::numeric_limits<double>::infinity();
  return log;
}

struct Points {
  int techniques = 0;
  std::vector<Point> list;
  // Probability that a sample of the technique lies outside the domain, where f = 0 (below the horizon), and its
  // logarithm, finite where it underflows.
  Densities outside{}, logOutside = noLogarithms();

  void setOutside(size_t i, double log) { outside[i] = std::exp(log), logOutside[i] = log; }

  // sum of w h(point)
  template <class F>
  double integrate(F&& h) const {
    double sum = 0;
    for (const Point& x : list) sum += x.w * h(x);
    return sum;
  }
};

}  // namespace wardmis
