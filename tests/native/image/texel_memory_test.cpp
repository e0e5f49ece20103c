// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/texel_memory.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "image/texture.h"
#include "math/error.h"

namespace wardmis {
namespace {

constexpr int kSide = 2048;
constexpr size_t kBytes = size_t{3} * kSide * kSide;  // of an image: 12.6 MB

Image noise(uint32_t seed) {
  Image image{"", kSide, kSide, 3, true, {}, {}};
  image.bytes.resize(kBytes);
  for (uint8_t& v : image.bytes) v = static_cast<uint8_t>((seed = seed * 1664525 + 1013904223) >> 24);
  return image;
}

struct Limit {
  explicit Limit(size_t bytes) { setTexelLimit(bytes); }
  ~Limit() { setTexelLimit(0); }
};

size_t resident() {
  std::ifstream in("/proc/self/statm");
  size_t size = 0, pages = 0;
  in >> size >> pages;
  return pages * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

TEST(TexelMemory, IsBoundedAndTheValuesAreTheSame) {
  constexpr size_t kImages = 24, kLimit = 4 * kBytes;
  const size_t before = resident();
  {
    const Limit limit(kLimit);
    std::vector<Image> images;
    for (uint32_t i = 0; i < kImages; ++i) {
      images.push_back(noise(i));
      EXPECT_LT(resident() - before, kLimit + 4 * kBytes) << i;  // and what is being written
    }
    const TexelUse use = texelUse();
    EXPECT_EQ(use.memory, 3 * kBytes);
    EXPECT_EQ(use.files, (kImages - 3) * kBytes);
    EXPECT_EQ(describe(use).substr(0, 26), "302 MB, 264 MB of it in fi");
    const Texture texture{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear};
    size_t most = 0;
    for (uint32_t i = 0; i < kImages; ++i) {
      setTexelLimit(2 * kImages * kBytes);
      const Image whole = noise(i);
      setTexelLimit(kLimit);
      EXPECT_EQ(images[i].bytes, whole.bytes) << i;
      float u = 0.1f, v = 0.2f;
      for (int k = 0; k < 20000; ++k) {
        u = u * 1.37f + 0.123f, v = v * 1.11f + 0.377f;
        u -= std::floor(u), v -= std::floor(v);
        const Rgb a = lookUpRgb(images[i], texture, {u, v}), b = lookUpRgb(whole, texture, {u, v});
        ASSERT_TRUE(a.x == b.x && a.y == b.y && a.z == b.z) << i << " " << u << " " << v;
      }
      most = std::max(most, resident() - before);
    }
    EXPECT_LT(most, kLimit + 6 * kBytes);  // the whole one, and what is read between two looks at the memory
  }
  EXPECT_EQ(texelUse().memory + texelUse().files, 0u);
}

TEST(TexelMemory, BelowTheLimitThereAreNoFiles) {
  const Limit limit(8 * kBytes);
  const Image image = noise(1);
  EXPECT_EQ(texelUse().files, 0u);
  EXPECT_EQ(texelUse().memory, kBytes);
  EXPECT_EQ(describe(texelUse()), "13 MB");
}

// Without a disk with room it takes memory beyond the limit, if there is any.
TEST(TexelMemory, RefusesWhatFitsNowhere) {
  const Limit limit(kBytes);
  const size_t tooMuch = size_t{1} << 46;
  try {
    takeTexels(tooMuch);
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, ExitCode::kMemory);
    EXPECT_NE(std::string(e.what()).find("textures need 70368.7 GB more than the 0.0 GB"), std::string::npos)
        << e.what();
    EXPECT_NE(std::string(e.what()).find("/var/tmp"), std::string::npos) << e.what();
    EXPECT_NE(e.hint.find("TMPDIR"), std::string::npos);
  }
  EXPECT_EQ(texelUse().memory + texelUse().files, 0u);
}

TEST(TexelMemory, TheLimitOfTheEnvironmentMustBeANumber) {
  const Limit limit(0);
  setenv("WARDMIS_TEXTURE_MEMORY", "12 MB", 1);
  EXPECT_THROW(takeTexels(kBytes), Error);
  setenv("WARDMIS_TEXTURE_MEMORY", "5", 1);
  const Image image = noise(2);
  unsetenv("WARDMIS_TEXTURE_MEMORY");
  EXPECT_EQ(texelUse().files, kBytes);
}

}  // namespace
}  // namespace wardmis
