// SPDX-License-Identifier: GPL-3.0-or-later
// Mean and variance of independent values, with the standard errors of both.
#pragma once

#include <algorithm>
#include <cmath>

namespace wardmis {

// Central moments by updates that do not cancel (Pebay 2008).
class Estimate {
 public:
  void add(double x) {
    const double before = n_;
    n_ += 1;
    const double d = x - mean_, dn = d / n_, dn2 = dn * dn, term = d * dn * before;
    mean_ += dn;
    m4_ += term * dn2 * (n_ * n_ - 3 * n_ + 3) + 6 * dn2 * m2_ - 4 * dn * m3_;
    m3_ += term * dn * (n_ - 2) - 3 * dn * m2_;
    m2_ += term;
  }
  double count() const { return n_; }
  double mean() const { return mean_; }
  double variance() const { return n_ > 1 ? m2_ / (n_ - 1) : 0; }
  double error() const { return std::sqrt(variance() / n_); }  // of the mean
  double varianceError() const {
    return n_ > 1 ? std::sqrt(std::max(0.0, m4_ / n_ - variance() * variance()) / n_) : 0;
  }

 private:
  double n_ = 0, mean_ = 0, m2_ = 0, m3_ = 0, m4_ = 0;
};

}  // namespace wardmis
