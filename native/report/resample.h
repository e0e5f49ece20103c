// SPDX-License-Identifier: GPL-3.0-or-later
// Intervals and tests over independent repetitions (seeds).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

namespace wardmis {

struct Interval {
  double value = 0;          // of the statistic on the sample itself
  double low = 0, high = 0;  // 95 %

  bool contains(double x) const { return low <= x && x <= high; }
};

// A bootstrap over n repetitions: a statistic is a function of the indices of those drawn. The same draws serve every
// statistic, so that those of several configurations on the same seeds are paired. Percentile intervals, with the
// percentiles expanded for small n: Phi(-sqrt(n/(n-1)) t_{.025, n-1}) instead of .025 (Hesterberg 2015, "What teachers
// should know about the bootstrap", section 5.3), since plain ones cover too little. Fewer than kFewestDrawn
// repetitions have too few different draws for that: there intervals are Student's t with the jackknife's standard
// error (Efron and Tibshirani 1993, chapter 11), of the logarithm where the statistic is positive.
inline constexpr size_t kFewestDrawn = 8;

class Bootstrap {
 public:
  explicit Bootstrap(size_t n, uint64_t seed = 1, size_t resamples = 2000);

  using Statistic = std::function<std::optional<double>(std::span<const uint32_t>)>;  // none: not defined on this draw

  // None where the statistic is not defined on the sample itself, or on more than 2 % of the draws (any of the
  // jackknife's).
  std::optional<Interval> interval(const Statistic& statistic) const;
  Interval mean(std::span<const double> values) const;  // of n values

 private:
  std::optional<Interval> jackknife(double own, const Statistic& statistic) const;

  size_t n_;
  double tail_;                  // the lower percentile, as a fraction
  std::vector<uint32_t> draws_;  // n a row; row 0 is the sample itself
};

// A curve's error at times that increase, both positive.
struct Curve {
  std::vector<double> time, error;
};

// The time from which on the error stays at or below `target`: between checkpoints by a straight line in log error
// against log time; where the first checkpoint is already there, along the line through the first two, for at most a
// factor of two. None if the last checkpoint is above it, or the first too far below.
std::optional<double> timeTo(const Curve& curve, double target);

// The error at `time` by the same lines; none outside the curve (beyond its last point by more than a hundredth).
std::optional<double> errorAt(const Curve& curve, double time);

// Slope of log error against log time by least squares. None with fewer than three points that are not zero.
std::optional<double> slope(const Curve& curve);

// Two-sided p-values.
double pOfNormal(double z);
double pOfStudent(double t, double degreesOfFreedom);

// The p-value below which one of n independent tests at level alpha in all fails (Sidak 1967).
double sidak(double alpha, size_t n);

// The largest p-value that is rejected if false discoveries are to be at most the share `rate` (Benjamini and Hochberg
// 1995); -1 if none is.
double benjaminiHochberg(std::vector<double> p, double rate);

// Mean and squared error of the mean of paired differences, as a t statistic; 0 where all differences are equal to 0.
double tOfDifferences(double sum, double squares, size_t n);

}  // namespace wardmis
