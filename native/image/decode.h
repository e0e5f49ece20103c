// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes image files that are in memory.
#pragma once

#include <atomic>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>

#include "image/image.h"

namespace wardmis {

// How the numbers of an image stand for light. kAuto: sRGB for integers, linear for floats.
enum class ColorSpace : uint8_t { kAuto, kSrgb, kLinear };

// What becomes of alpha: it is an output of its own, the colours are multiplied by it as they are in the file, or it
// is 1.
enum class Alpha : uint8_t { kKept, kMultiplies, kIgnored };

// How an image's numbers are to be taken.
struct Encoding {
  ColorSpace space = ColorSpace::kAuto;
  bool filterEncoded = false;  // Image::filterEncoded
  Alpha alpha = Alpha::kKept;
  int halvings = 0, limit = 0;  // shrink()
  // clang-tidy 14 takes what the compiler makes of <=> for a 0 that should be nullptr
  auto operator<=>(const Encoding&) const = default;  // NOLINT(modernize-use-nullptr)
};

struct DecodedImage {
  Image image;
  uint64_t mended = 0;  // values that were not finite, and were set to 0
  std::string damage;   // why it is not what the file should hold, but lostImage()
};

constexpr int kLargestImageSide = 1 << 16;

// Says what is wrong with an image; the caller knows its name and place.
struct UnreadableImage : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Bytes that the decoded images of a scene may take together. No format packs better than about 1 : 1000, so that what
// asks for more is a lie or a bomb.
class ImageBudget {
 public:
  explicit ImageBudget(uint64_t fileBytes) : left_((uint64_t(1) << 28) + 4096 * fileBytes) {}
  bool take(uint64_t bytes) {
    uint64_t left = left_;
    while (bytes <= left)
      if (left_.compare_exchange_weak(left, left - bytes)) return true;
    return false;
  }

 private:
  std::atomic<uint64_t> left_;  // images are decoded in parallel
};

// One magenta texel, Blender's sign for a lost image.
DecodedImage lostImage(std::string damage);

// An image file, told by its first bytes; see image_file.h. What cannot be read is no reason not to render the rest.
DecodedImage decodeImage(std::span<const std::byte> file, Encoding encoding, ImageBudget& budget);

// Raw pixels of 8 bits or 32-bit floats, rows from the bottom: exactly width * height * channels values.
struct RawLayout {
  int width, height, channels;
  bool floats;
};
DecodedImage rawImage(std::span<const std::byte> data, RawLayout layout, Encoding encoding, ImageBudget& budget);

}  // namespace wardmis
