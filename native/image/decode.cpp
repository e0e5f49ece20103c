// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/decode.h"

#include <fmt/format.h>

#include <cfloat>
#include <cmath>
#include <cstring>

#include "image/file.h"
#include "image/shrink.h"
#include "image/texture.h"
#include "math/error.h"

namespace wardmis {
namespace {

// What alpha multiplies, in the space that the numbers are in.
void multiplyByAlpha(Image& im) {
  const size_t step = im.channels;
  for (size_t i = 0; i < im.bytes.size(); i += step)
    for (size_t c = 0; c + 1 < step; c++)
      im.bytes[i + c] = static_cast<uint8_t>(im.bytes[i + c] * im.bytes[i + step - 1] / 255);
  for (size_t i = 0; i < im.floats.size(); i += step)
    for (size_t c = 0; c + 1 < step; c++) im.floats[i + c] *= im.floats[i + step - 1];
}

void ignoreAlpha(Image& im) {
  const size_t step = im.channels;
  for (size_t i = step - 1; i < im.bytes.size(); i += step) im.bytes[i] = UINT8_MAX;
  for (size_t i = step - 1; i < im.floats.size(); i += step) im.floats[i] = 1;
}

// What no renderer can use becomes 0; colours of float images become linear, unless they are filtered before that.
DecodedImage finished(Image image, Encoding encoding) {
  DecodedImage out{std::move(image), 0, {}};
  Image& im = out.image;
  for (float& v : im.floats) {
    const bool right = std::fabs(v) <= FLT_MAX;
    out.mended += !right;
    v = right ? v : 0;
  }
  if (im.channels % 2 == 0) {
    if (encoding.alpha == Alpha::kMultiplies) multiplyByAlpha(im);
    if (encoding.alpha == Alpha::kIgnored) ignoreAlpha(im);
  }
  const bool srgb = encoding.space != ColorSpace::kLinear;
  im.filterEncoded = srgb && encoding.filterEncoded;
  im.srgb = srgb && (im.floats.empty() || im.filterEncoded);
  if (srgb && !im.filterEncoded)
    for (size_t i = 0; i < im.floats.size(); i++)
      if (!isAlpha(im, static_cast<int>(i % im.channels))) im.floats[i] = srgbToLinear(im.floats[i]);
  shrink(im, encoding.halvings, encoding.limit);
  return out;
}

}  // namespace

DecodedImage lostImage(std::string damage) {
  return {Image{"", 1, 1, 3, true, {255, 0, 255}, {}, false}, 0, std::move(damage)};
}

DecodedImage decodeImage(std::span<const std::byte> file, Encoding encoding, ImageBudget& budget) {
  FileImage read;
  try {
    read = readImageFile(file);
  } catch (const Error&) {  // no memory
    throw;
  } catch (const std::runtime_error& e) {
    return lostImage(e.what());
  }
  if (!budget.take(read.image.bytes.size() + read.image.floats.size() * sizeof(float)))
    throw UnreadableImage("is one of too many images with the same data");
  if (encoding.space == ColorSpace::kAuto) encoding.space = read.integers ? ColorSpace::kSrgb : ColorSpace::kLinear;
  return finished(std::move(read.image), encoding);
}

DecodedImage rawImage(std::span<const std::byte> data, RawLayout layout, Encoding encoding, ImageBudget& budget) {
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
  if (encoding.space == ColorSpace::kAuto) encoding.space = layout.floats ? ColorSpace::kLinear : ColorSpace::kSrgb;
  return finished(std::move(image), encoding);
}

}  // namespace wardmis
