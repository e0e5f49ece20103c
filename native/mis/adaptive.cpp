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

std::vector<Densities> candidates(int n, double step, int power) {
  std::vector<Densities> list;
  int combinations = 1;
  const int levels = power + 1;
  for (int i = 0; i < n; ++i) combinations *= levels;
  for (int c = 0; c < combinations; ++c) {
    Densities a{};
    double sum = 0;
    bool smallestIsOne = false;
    for (int i = 0, rest = c; i < n; ++i, rest /= levels) {
      a[at(i)] = std::pow(step, rest % levels);
      smallestIsOne |= rest % levels == 0;
      sum += a[at(i)];
    }
    if (!smallestIsOne) continue;  // the same as another one
    for (int i = 0; i < n; ++i) a[at(i)] /= sum;
    list.push_back(a);
  }
  return list;
}

Densities autoFractions(const Points& pilot, const Densities* cost, double sigmas) {
  const int n = pilot.techniques;
  const std::vector<Densities> all = candidates(n, 2, 4);  // down to 1/17 of two techniques
  // Of each candidate N Var x cost = sum_i a_i Var_{p_i}[f/q] x cost, and what each point (and, at the end, what lies
  // outside the domain) contributes to it, from whose spread the standard error of the gain over equal counts follows.
  const size_t parts = pilot.list.size();
  const auto contributions = [&](const Densities& a, std::vector<double>& part) {
    double meanCost = 0;
    for (int i = 0; i < n; ++i) meanCost += a[at(i)] * (cost != nullptr ? (*cost)[at(i)] : 1);
    Densities mean{}, mass{};
    for (const Point& x : pilot.list) {
      const double q = mixture(a, x.p, n);
      if (!(q > 0)) continue;
      for (int i = 0; i < n; ++i) mean[at(i)] += x.w * x.p[at(i)] * (x.f / q), mass[at(i)] += x.w * x.p[at(i)];
    }
    double value = 0;
    // by the mass that the points show, so that these are variances, never less than nothing
    for (int i = 0; i < n; ++i) {
      const double whole = mass[at(i)] + pilot.outside[at(i)];
      mean[at(i)] = whole > 0 ? mean[at(i)] / whole : 0;
      value += a[at(i)] * pilot.outside[at(i)] * mean[at(i)] * mean[at(i)] * meanCost;
    }
    part.assign(parts, 0);
    for (size_t k = 0; k < parts; ++k) {
      const Point& x = pilot.list[k];
      const double q = mixture(a, x.p, n);
      if (!(q > 0)) continue;
      for (int i = 0; i < n; ++i) {
        const double d = x.f / q - mean[at(i)];
        part[k] += x.w * a[at(i)] * x.p[at(i)] * d * d * meanCost;
      }
      value += part[k];
    }
    return value;
  };
  std::vector<double> ofEqual, part;
  const double equal = contributions(all.front(), ofEqual);
  const Densities* best = &all.front();
  double bestGain = 0;
  for (const Densities& a : all) {
    if (&a == &all.front()) continue;
    const double gain = equal - contributions(a, part);
    double gain2 = 0;
    for (size_t k = 0; k < parts; ++k) gain2 += (ofEqual[k] - part[k]) * (ofEqual[k] - part[k]);
    const double error = std::sqrt(std::max(0.0, gain2 - gain * gain / std::max<double>(1, double(parts))));
    // the largest gain that is sure, not the largest: that of many candidates is half luck
    if (const double sure = gain - sigmas * error; sure > bestGain) best = &a, bestGain = sure;
  }
  return *best;
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
