// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "math/error.h"

namespace wardmis {

std::span<const MetricInfo> allMetrics() {
  static constexpr std::array all{
      MetricInfo{"mse", "MSE", "mean (x − r)²", 0, &Metrics::mse, true},
      MetricInfo{"relmse", "relMSE", "mean (x − r)² / (r² + ε)", kRelMseEpsilon, &Metrics::relMse, true},
      MetricInfo{"relmse_trimmed", "relMSE without the largest 0.1 %",
                 "mean (x − r)² / (r² + ε) without the pixels of the largest 0.1 %, at least one", kRelMseEpsilon,
                 &Metrics::relMseTrimmed, true},
      MetricInfo{"mape", "MAPE", "mean |x − r| / (|r| + ε)", kMapeEpsilon, &Metrics::mape, false},
      MetricInfo{"smape", "SMAPE", "mean 2 |x − r| / (|x| + |r| + ε)", kMapeEpsilon, &Metrics::smape, false},
  };
  return all;
}

ImageError compareImages(const RgbImage& image, const RgbImage& reference) {
  if (image.width != reference.width || image.height != reference.height)
    throw Error(ExitCode::kUsage,
                fmt::format("the images differ in size: {} x {} and {} x {}", image.width, image.height,
                            reference.width, reference.height),
                "compare renders of the same resolution and border");
  const size_t pixels = image.rgb.size() / 3;
  ImageError e;
  e.relMsePixels.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    double relative = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double x = double(image.rgb[3 * i + c]), r = double(reference.rgb[3 * i + c]), d = x - r;
      e.mse += d * d;
      relative += d * d / (r * r + kRelMseEpsilon);
      e.mape += std::abs(d) / (std::abs(r) + kMapeEpsilon);
      e.smape += 2 * std::abs(d) / (std::abs(x) + std::abs(r) + kMapeEpsilon);
    }
    e.relMsePixels[i] = static_cast<float>(relative / 3);
    e.relMse += relative;
  }
  const double n = 3.0 * static_cast<double>(std::max<size_t>(1, pixels));
  e.mse /= n, e.relMse /= n, e.mape /= n, e.smape /= n;
  std::vector<float> sorted = e.relMsePixels;
  const size_t keep = keptOfTrimmed(pixels);
  std::nth_element(sorted.begin(),
                   sorted.begin() + static_cast<std::ptrdiff_t>(std::min(keep, std::max<size_t>(1, pixels) - 1)),
                   sorted.end());
  double kept = 0;
  for (size_t i = 0; i < keep; ++i) kept += double(sorted[i]);
  e.relMseTrimmed = kept / static_cast<double>(std::max<size_t>(1, keep));
  return e;
}

}  // namespace wardmis
