// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/filter.h"

#include <cmath>

#include "math/number.h"

namespace wardmis {

namespace {

// Not normalised.
double shape(FilterType type, double v, double w) {
  if (type == FilterType::kGaussian) return std::exp(-8 * v * v / (w * w));
  const double q = 2 * kPi<double> * (v / (2 * w) + 0.5);
  return std::max(0.0, 0.35875 - 0.48829 * std::cos(q) + 0.14128 * std::cos(2 * q) - 0.01168 * std::cos(3 * q));
}

}  // namespace

PixelFilter::PixelFilter(FilterType type, float width) : type_(type), width_(width) {
  if (type == FilterType::kBox) {
    inverse_ = {-0.5f, 0.5f};
    return;
  }
  const double radius = type == FilterType::kGaussian ? 1.5 * double(width) : double(width);
  radius_ = static_cast<float>(radius);
  const auto density = [&](double v) { return shape(type, v, double(width)); };
  // cumulated by the trapezoidal rule on a fine grid, then inverted at equal steps of probability; steps so small
  // because the first and the last one reach over the whole tail (with 2^10 the Gaussian's variance is 2 % too large)
  constexpr size_t kGrid = 1 << 14, kQuantiles = 1 << 14;
  std::vector<double> cumulated(kGrid + 1, 0);
  const double step = 2 * radius / kGrid;
  for (size_t i = 0; i < kGrid; ++i) {
    const double v = -radius + step * static_cast<double>(i);
    cumulated[i + 1] = cumulated[i] + 0.5 * (density(v) + density(v + step)) * step;
  }
  norm_ = static_cast<float>(cumulated[kGrid]);
  inverse_.resize(kQuantiles + 1);
  size_t i = 0;
  for (size_t k = 0; k <= kQuantiles; ++k) {
    const double target = cumulated[kGrid] * static_cast<double>(k) / kQuantiles;
    while (i + 1 < kGrid && cumulated[i + 1] < target) ++i;
    const double span = cumulated[i + 1] - cumulated[i];
    const double f = span > 0 ? (target - cumulated[i]) / span : 0;
    inverse_[k] = static_cast<float>(-radius + step * (static_cast<double>(i) + std::clamp(f, 0.0, 1.0)));
  }
}

float PixelFilter::density(float v) const {
  if (!(std::abs(v) <= radius_)) return 0;
  return type_ == FilterType::kBox ? 1 : static_cast<float>(shape(type_, double(v), double(width_))) / norm_;
}

}  // namespace wardmis
