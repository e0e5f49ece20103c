// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/image.h"

#include <fmt/format.h>

#include <cfloat>
#include <cstring>

#include "scene/image_file.h"
#include "scene/texture.h"

namespace wardmis {
namespace {

// Of float images: colours become linear, and what no renderer can use becomes 0.
DecodedImage finished(Image image, ColorSpace space) {
  DecodedImage out{std::move(image), 0, {}};
  Image& im = out.image;
  if (im.floats.empty()) {
    im.srgb = space != ColorSpace::kLinear;
    return out;
  }
  for (float& v : im.floats) {
    const bool right = (v >= 0) & (v <= FLT_MAX);
    out.mended += !right;
    v = right ? v : 0;
  }
  if (space == ColorSpace::kSrgb)
    for (size_t i = 0; i < im.floats.size(); i++)
      if (!isAlpha(im, static_cast<int>(i % im.channels))) im.floats[i] = srgbToLinear(im.floats[i]);
  return out;
}

}  // namespace

DecodedImage decodeImage(std::span<const std::byte> file, ColorSpace space, ImageBudget& budget) {
  FileImage read;
  try {
    read = readImageFile(file);
  } catch (const std::runtime_error& e) {
    return {Image{"", 1, 1, 3, true, {255, 0, 255}, {}}, 0, e.what()};
  }
  if (!budget.take(read.image.bytes.size() + read.image.floats.size() * sizeof(float)))
    throw UnreadableImage("is one of too many images with the same data");
  if (space == ColorSpace::kAuto) space = read.integers ? ColorSpace::kSrgb : ColorSpace::kLinear;
  return finished(std::move(read.image), space);
}

DecodedImage rawImage(std::span<const std::byte> data, RawLayout layout, ColorSpace space, ImageBudget& budget) {
  const size_t values = size_t(layout.width) * layout.height * layout.channels;
  const size_t size = values * (layout.floats ? sizeof(float) : 1);
  if (data.size() != size)
    throw UnreadableImage(fmt::format("{} x {} pixels of {} channels need {} bytes, found {}", layout.width,
                                      layout.height, layout.channels, size, data.size()));
  if (!budget.take(size)) throw UnreadableImage("is one of too many images with the same data");
  Image image;
  image.width = layout.width;
  image.height = layout.height;
  image.channels = layout.channels;
  if (layout.floats) {
    image.floats.resize(values);
    std::memcpy(image.floats.data(), data.data(), size);
  } else {
    image.bytes.resize(values);
    std::memcpy(image.bytes.data(), data.data(), size);
  }
  if (space == ColorSpace::kAuto) space = layout.floats ? ColorSpace::kLinear : ColorSpace::kSrgb;
  return finished(std::move(image), space);
}

}  // namespace wardmis
