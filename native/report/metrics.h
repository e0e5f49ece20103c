// SPDX-License-Identifier: GPL-3.0-or-later
// The error of an image against a reference. x: a channel of the image, r: of the reference; means over pixels and
// channels.
#pragma once

#include <span>
#include <string>

#include "math/rel_mse.h"
#include "report/image.h"

namespace wardmis {

inline constexpr double kMapeEpsilon = 0.01;

struct Metrics {
  double mse = 0;            // mean (x - r)^2
  double relMse = 0;         // mean (x - r)^2 / (r^2 + 0.01)
  double relMseTrimmed = 0;  // the same without the pixels of the largest 0.1 %
  double mape = 0;           // mean |x - r| / (|r| + 0.01)
  double smape = 0;          // mean 2 |x - r| / (|x| + |r| + 0.01)
};

struct MetricInfo {
  const char *name, *label, *formula;
  double epsilon;  // 0: none
  double Metrics::*value;
  bool floorSubtracted;  // where the reference's own variance is known: E (x - r)^2 = Var x + Var r
};
std::span<const MetricInfo> allMetrics();

struct ImageError : Metrics {
  std::vector<float> relMsePixels;  // per pixel, mean over channels
};

// Throws Error(kUsage) if the sizes differ.
ImageError compareImages(const RgbImage& image, const RgbImage& reference);

}  // namespace wardmis
