// SPDX-License-Identifier: GPL-3.0-or-later
// Images as PNG files in base64 that a browser decodes to the exact values (docs/report-format.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "report/image.h"

namespace wardmis {

struct Picture {
  nlohmann::json description;  // the entry of "images"
  std::string base64;          // a PNG
};

inline constexpr int kLargestPicture = 960;  // pixels across; larger images are embedded as means of n x n pixels

// What every kind has in common. `label` for people, `group`: image, error, allocation, ways or map.
struct PictureInfo {
  std::string key, label, group, configuration, text;
};

Picture radiancePicture(const PictureInfo& info, const RgbImage& image);

// NaN: no value. log: the scale is that of the logarithm; values that are not positive have none then.
Picture scalarPicture(const PictureInfo& info, const std::vector<float>& values, int width, int height, double low,
                      double high, bool log);

// Shares in [0, 1], three a pixel.
Picture sharesPicture(const PictureInfo& info, const std::vector<float>& rgb, int width, int height);

// An index into `classes` (names and colours) a pixel; 255: none. Reduced by taking every n-th.
Picture classesPicture(const PictureInfo& info, const std::vector<uint8_t>& classes, int width, int height,
                       const std::vector<std::pair<std::string, std::string>>& names);

std::string base64(const std::string& bytes);

}  // namespace wardmis
