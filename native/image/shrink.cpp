// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/shrink.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace wardmis {
namespace {

uint8_t mean(uint64_t sum, uint64_t count) { return static_cast<uint8_t>((2 * sum + count) / (2 * count)); }
float mean(float sum, uint64_t count) { return sum * (1.0f / static_cast<float>(count)); }

template <class Sum, class T>
Texels<T> blockMeans(const Texels<T>& from, const Image& image, int width, int height, int block) {
  const size_t channels = image.channels;
  Texels<T> to(size_t(width) * height * channels);
  for (int y = 0; y < height; y++)
    for (int x = 0; x < width; x++) {
      const int x0 = x * block, y0 = y * block;
      const int x1 = std::min(x0 + block, image.width), y1 = std::min(y0 + block, image.height);
      const uint64_t count = uint64_t(x1 - x0) * (y1 - y0);
      for (size_t c = 0; c < channels; c++) {
        Sum sum = 0;
        for (int v = y0; v < y1; v++)
          for (int u = x0; u < x1; u++) sum += from[(size_t(v) * image.width + u) * channels + c];
        to[(size_t(y) * width + x) * channels + c] = mean(sum, count);
      }
    }
  return to;
}

}  // namespace

void shrink(Image& image, int halvings, int limit) {
  const int longest = std::max(image.width, image.height);
  while (limit > 0 && longest > int64_t(limit) << halvings) ++halvings;
  if (halvings == 0) return;
  const int width = std::max(image.width >> halvings, 1), height = std::max(image.height >> halvings, 1);
  const int block = 1 << halvings;
  if (image.floats.empty())
    image.bytes = blockMeans<uint64_t>(image.bytes, image, width, height, block);
  else
    image.floats = blockMeans<float>(image.floats, image, width, height, block);
  image.width = width, image.height = height;
}

}  // namespace wardmis
