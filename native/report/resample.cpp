// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/resample.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

namespace wardmis {

Bootstrap::Bootstrap(size_t n, uint64_t seed, size_t resamples) : n_(n), draws_(n * (resamples + 1)) {
  std::iota(draws_.begin(), draws_.begin() + static_cast<std::ptrdiff_t>(n), 0u);
  std::mt19937_64 random(seed);
  for (size_t i = n; i < draws_.size(); ++i)  // of 64 bits: the bias of the remainder is nothing
    draws_[i] = static_cast<uint32_t>(random() % n);
  tail_ = 0.025;
  if (n > 1) {
    const double t = boost::math::quantile(boost::math::students_t(double(n) - 1), 0.025);
    tail_ = boost::math::cdf(boost::math::normal(), std::sqrt(double(n) / (double(n) - 1)) * t);
  }
}

std::optional<Interval> Bootstrap::interval(const Statistic& statistic) const {
  const auto draw = [&](size_t row) { return statistic({draws_.data() + row * n_, n_}); };
  const std::optional<double> own = draw(0);
  if (!own || !std::isfinite(*own)) return {};
  if (n_ < kFewestDrawn) return jackknife(*own, statistic);
  const size_t rows = draws_.size() / std::max<size_t>(1, n_) - 1;
  std::vector<double> values;
  values.reserve(rows);
  for (size_t r = 1; r <= rows; ++r)
    if (const auto v = draw(r); v && std::isfinite(*v)) values.push_back(*v);
  if (double(values.size()) < 0.98 * double(rows)) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {  // with linear interpolation
    const double x = q * double(values.size() - 1);
    const auto i = static_cast<size_t>(x);
    return values[i] + (x - double(i)) * (values[std::min(i + 1, values.size() - 1)] - values[i]);
  };
  return Interval{*own, at(tail_), at(1 - tail_)};
}

std::optional<Interval> Bootstrap::jackknife(double own, const Statistic& statistic) const {
  if (n_ < 2) return {};
  std::vector<double> without;
  for (uint32_t left = 0; left < n_; ++left) {
    std::vector<uint32_t> draw;
    for (uint32_t i = 0; i < n_; ++i)
      if (i != left) draw.push_back(i);
    const auto v = statistic(draw);
    if (!v || !std::isfinite(*v)) return {};
    without.push_back(*v);
  }
  const bool positive = own > 0 && std::all_of(without.begin(), without.end(), [](double v) { return v > 0; });
  if (positive)
    for (double& v : without) v = std::log(v);
  double mean = 0, squares = 0;
  for (const double v : without) mean += v / double(n_);
  for (const double v : without) squares += (v - mean) * (v - mean);
  const double reach = boost::math::quantile(boost::math::students_t(double(n_) - 1), 0.975) *
                       std::sqrt((double(n_) - 1) / double(n_) * squares);
  if (positive) return Interval{own, own * std::exp(-reach), own * std::exp(reach)};
  return Interval{own, own - reach, own + reach};
}

Interval Bootstrap::mean(std::span<const double> values) const {
  return interval([&](std::span<const uint32_t> draw) {
           double sum = 0;
           for (const uint32_t i : draw) sum += values[i];
           return std::optional<double>(sum / double(draw.size()));
         })
      .value_or(Interval{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()});
}

namespace {

// Through two points in log-log, at log time x.
double along(const Curve& c, size_t i, double x) {
  const double x0 = std::log(c.time[i]), x1 = std::log(c.time[i + 1]);
  const double y0 = std::log(c.error[i]), y1 = std::log(c.error[i + 1]);
  return x1 > x0 ? y0 + (y1 - y0) * (x - x0) / (x1 - x0) : y1;
}

}  // namespace

std::optional<double> timeTo(const Curve& c, double target) {
  const size_t n = c.time.size();
  if (n < 2 || !(target > 0) || !(c.error.back() <= target)) return {};
  size_t i = n - 1;  // the last that is above
  while (i-- > 0)
    if (c.error[i] > target) break;
  const bool above = i != std::numeric_limits<size_t>::max();
  if (!above) i = 0;
  const double x0 = std::log(c.time[i]), x1 = std::log(c.time[i + 1]);
  const double y0 = std::log(c.error[i]), y1 = std::log(c.error[i + 1]);
  if (!(std::isfinite(y0) && std::isfinite(y1)) || !(y1 < y0)) return {};
  const double x = x0 + (std::log(target) - y0) * (x1 - x0) / (y1 - y0);
  if (!above && x < x0 - std::log(2.0)) return {};
  return std::exp(x);
}

std::optional<double> errorAt(const Curve& c, double time) {
  const size_t n = c.time.size();
  if (n < 2 || !(time >= c.time.front()) || time > 1.01 * c.time.back()) return {};
  const auto above = std::upper_bound(c.time.begin(), c.time.end(), time);
  const size_t i = std::clamp<size_t>(static_cast<size_t>(above - c.time.begin()), 1, n - 1) - 1;
  const double y = along(c, i, std::log(time));
  return std::isfinite(y) ? std::optional(std::exp(y)) : std::nullopt;
}

std::optional<double> slope(const Curve& c) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (size_t i = 0; i < c.time.size(); ++i) {
    if (!(c.error[i] > 0) || !(c.time[i] > 0)) continue;
    const double u = std::log(c.time[i]), v = std::log(c.error[i]);
    n += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  const double spread = n * xx - x * x;
  if (n < 3 || !(spread > 0)) return {};
  return (n * xy - x * y) / spread;
}

double pOfNormal(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

double pOfStudent(double t, double degreesOfFreedom) {
  if (std::isnan(t)) return 1;
  return 2 * boost::math::cdf(boost::math::students_t(degreesOfFreedom), -std::min(std::abs(t), 1e30));
}

double sidak(double alpha, size_t n) { return -std::expm1(std::log1p(-alpha) / double(std::max<size_t>(1, n))); }

double benjaminiHochberg(std::vector<double> p, double rate) {
  std::sort(p.begin(), p.end());
  for (size_t k = p.size(); k-- > 0;)
    if (p[k] <= rate * double(k + 1) / double(p.size())) return p[k];
  return -1;
}

double tOfDifferences(double sum, double squares, size_t n) {
  const double mean = sum / double(n), variance = (squares / double(n) - mean * mean) * double(n) / (double(n) - 1);
  if (!(variance > 0)) return mean == 0 ? 0 : std::copysign(1e30, mean);
  return mean / std::sqrt(variance / double(n));
}

}  // namespace wardmis
