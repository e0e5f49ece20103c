// SPDX-License-Identifier: GPL-3.0-or-later
// Pixel filters, importance-sampled: x and y independent, every sample of weight 1 in its own pixel (as Cycles).
#pragma once

#include <vector>

#include "math/vec.h"

namespace wardmis {

enum class FilterType : uint8_t { kBox, kGaussian, kBlackmanHarris };

class PixelFilter {
 public:
  // width in pixels. Box: 1 pixel, whatever the width. Gaussian: exp(-8 v^2/w^2), |v| <= 1.5 w.
  // Blackman-Harris: four terms over |v| <= w.
  PixelFilter(FilterType type, float width);

  // Offset from the pixel's centre, in pixels.
  Vec2f sample(Vec2f u) const { return {offset(u.x), offset(u.y)}; }
  // Its density there, per square pixel; beyond the radius along either axis it is 0.
  float density(Vec2f offset) const { return density(offset.x) * density(offset.y); }
  float radius() const { return radius_; }

 private:
  float offset(float u) const {
    const float x = u * static_cast<float>(inverse_.size() - 1);
    const auto i = static_cast<size_t>(x);
    const float f = x - static_cast<float>(i);
    return inverse_[i] + f * (inverse_[std::min(i + 1, inverse_.size() - 1)] - inverse_[i]);
  }
  float density(float v) const;

  FilterType type_;
  float width_, radius_ = 0.5f;
  float norm_ = 1;              // what its shape's integral is to be divided by
  std::vector<float> inverse_;  // quantiles
};

}  // namespace wardmis
