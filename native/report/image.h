// SPDX-License-Identifier: GPL-3.0-or-later
// Images to be compared, read from files.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wardmis {

struct RgbImage {
  int width = 0, height = 0;
  std::vector<float> rgb;  // 3 per pixel, row 0 is the top row

  size_t pixels() const { return rgb.size() / 3; }
};

// The Combined pass of a multi-layer EXR (of the named layer, or of the first one that has it), else its R, G, B. Other
// image files too: integers are sRGB and become linear, grey stands for all three, alpha is left out.
// Throws Error(kFile), also for values that are not finite: they are counted and the first is named.
RgbImage readRgb(const std::filesystem::path& path, const std::string& layer = {});

}  // namespace wardmis
