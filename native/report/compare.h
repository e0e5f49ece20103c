// SPDX-License-Identifier: GPL-3.0-or-later
// The error of an image against a reference. x: a channel of the image, r: of the reference; means over pixels and
// channels.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wardmis {

inline constexpr double kRelMseEpsilon = 0.01, kMapeEpsilon = 0.01;

struct RgbImage {
  int width = 0, height = 0;
  std::vector<float> rgb;  // 3 per pixel, row 0 is the top row
};

// The Combined pass of a multi-layer EXR (of the named layer, or of the first one that has it), else its R, G, B. Other
// image files too: integers are sRGB and become linear, grey stands for all three, alpha is left out.
// Throws Error(kFile), also for values that are not finite: they are counted and the first is named.
RgbImage readRgb(const std::filesystem::path& path, const std::string& layer = {});

struct ImageError {
  double mse = 0;                   // mean (x - r)^2
  double relMse = 0;                // mean (x - r)^2 / (r^2 + 0.01)
  double relMseTrimmed = 0;         // the same without the pixels of the largest 0.1 %
  double mape = 0;                  // mean |x - r| / (|r| + 0.01)
  std::vector<float> relMsePixels;  // per pixel, mean over channels
};

// Throws Error(kUsage) if the sizes differ.
ImageError compareImages(const RgbImage& image, const RgbImage& reference);

// The error as a picture: per-pixel relative error |x - r| / (|r| + 0.01) (mean over channels). EXR, by the name: the
// values as they are. Any other format that OpenImageIO writes: from 0 (black) to `scale` (pale yellow) through a map
// of even lightness, with a bar beneath that says what the colours mean. Returns what is to be noted, if anything.
std::string writeDifference(const std::filesystem::path& path, const RgbImage& image, const RgbImage& reference,
                            double scale);

}  // namespace wardmis
