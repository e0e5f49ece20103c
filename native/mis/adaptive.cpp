// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/adaptive.h"

#include <algorithm>
#include <cmath>

namespace wardmis {

namespace {

size_t at(int i) { return static_cast<size_t>(i); }

double mixture(const Densities& a, const Densities& p, int n) {
  double q = 0;
  for (int k = 0; k < n; ++k) q += a[at(k)] * p[at(k)];
  return q;
}

}  // namespace

Point pooledPoint(double f, const Densities& p, const Densities& n, int techniques) {
  Point x;
  x.f = f, x.p = p;
  const double q = mixture(n, p, techniques);
  x.w = q > 0 ? 1 / q : 0;
  for (int k = 0; k < techniques; ++k) x.logP[at(k)] = std::log(p[at(k)]);
  return x;
}

Densities equaliseSecondMoments(const Points& points, Densities a) {
  const int n = points.techniques;
  for (int step = 0; step < 30; ++step) {
    Densities m{}, next{};
    for (const Point& x : points.list) {
      const double q = mixture(a, x.p, n);
      if (!(q > 0)) continue;
      const double g = x.f / q;
      for (int i = 0; i < n; ++i) m[at(i)] += x.w * g * g * x.p[at(i)];
    }
    double sum = 0, change = 0;
    for (int i = 0; i < n; ++i) sum += next[at(i)] = a[at(i)] * std::sqrt(m[at(i)]);
    if (!(sum > 0) || std::isinf(sum)) return a;
    for (int i = 0; i < n; ++i) {
      next[at(i)] /= sum;
      change = std::max(change, std::abs(next[at(i)] - a[at(i)]));
    }
    a = next;
    if (change < 1e-3) break;
  }
  return a;
}

Densities clampFractions(Densities a, int n, double least) {
  least = std::min(least, 1.0 / n);
  std::array<bool, kMaxTechniques> raised{};
  for (bool again = true; again;) {
    again = false;
    double rest = 1, free = 0;
    for (int i = 0; i < n; ++i) raised[at(i)] ? rest -= least : free += a[at(i)];
    for (int i = 0; i < n; ++i)
      if (!raised[at(i)] && a[at(i)] * rest < least * free * (1 - 1e-12)) raised[at(i)] = again = true;
    if (!again)
      for (int i = 0; i < n; ++i) a[at(i)] = raised[at(i)] ? least : a[at(i)] * rest / free;
  }
  return a;
}

}  // namespace wardmis
