// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/way_images.h"

#include <algorithm>

namespace wardmis {

WayImages::WayImages(size_t pixels, int depth)
    : pixels_(pixels),
      surfaces_(std::min(depth, kMostSurfaces)),
      now_(pixels * count(surfaces_)),
      sum_(now_.size()),
      alone_(now_.size()),
      squares_(now_.size()),
      tried_(now_.size()) {}

void WayImages::endSample() {
  ++samples_;
  for (size_t i = 0; i < now_.size(); ++i) {
    const double v = double(luminance(now_[i]));
    squares_[i] += v * v;
    sum_[i] += now_[i];
    now_[i] = {0, 0, 0};
  }
}

std::vector<Rgb> WayImages::mean(const std::vector<Rgb>& sums, size_t way) const {
  const auto begin = sums.begin() + static_cast<std::ptrdiff_t>(way * pixels_);
  std::vector<Rgb> image(begin, begin + static_cast<std::ptrdiff_t>(pixels_));
  for (Rgb& value : image) value = value / static_cast<float>(std::max(samples_, 1u));
  return image;
}

std::vector<double> WayImages::variance(size_t way) const {
  std::vector<double> v(pixels_);
  const double n = samples_;
  for (size_t i = 0; i < pixels_ && n > 1; ++i) {
    const double mean = double(luminance(sum_[way * pixels_ + i])) / n;
    v[i] = std::max(0.0, squares_[way * pixels_ + i] / n - mean * mean) * n / (n - 1);
  }
  return v;
}

double WayImages::tried(size_t way) const {
  double sum = 0;
  for (size_t i = 0; i < pixels_; ++i) sum += double(tried_[way * pixels_ + i]);
  return sum / (double(pixels_) * std::max(samples_, 1u));
}

}  // namespace wardmis
