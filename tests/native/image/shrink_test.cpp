// SPDX-License-Identifier: GPL-3.0-or-later
// Images made smaller as Cycles makes them.
#include "image/shrink.h"

#include <gtest/gtest.h>

#include <vector>

namespace wardmis {
namespace {

Image bytes(int width, int height, const std::vector<uint8_t>& values, int channels = 1) {
  Image image;
  image.width = width, image.height = height, image.channels = channels;
  image.bytes.assign(values.begin(), values.end());
  return image;
}
std::vector<uint8_t> values(const Image& image) { return {image.bytes.begin(), image.bytes.end()}; }

TEST(Shrink, ATexelIsTheRoundedMeanOfWhatItCovers) {
  Image image = bytes(4, 2, {0, 1, 10, 20, 0, 1, 30, 41});  // means .5, 25.25
  shrink(image, 1, 0);
  EXPECT_EQ(image.width, 2);
  EXPECT_EQ(image.height, 1);
  EXPECT_EQ(values(image), (std::vector<uint8_t>{1, 25}));
}

TEST(Shrink, ChannelsAreApart) {
  Image image = bytes(2, 1, {10, 200, 30, 100}, 2);
  shrink(image, 1, 0);
  EXPECT_EQ(values(image), (std::vector<uint8_t>{20, 150}));
}

TEST(Shrink, WhatIsLeftOverIsLost) {
  Image image = bytes(5, 3, {1, 1, 3, 3, 99, 1, 1, 3, 3, 99, 99, 99, 99, 99, 99});
  shrink(image, 1, 0);
  EXPECT_EQ(values(image), (std::vector<uint8_t>{1, 3}));
}

TEST(Shrink, ASideIsOneTexelAtLeast) {
  Image image = bytes(1, 4, {2, 4, 6, 8});
  shrink(image, 3, 0);
  EXPECT_EQ(image.width * image.height, 1);
  EXPECT_EQ(values(image), (std::vector<uint8_t>{5}));
}

TEST(Shrink, UntilNoSideIsLongerThanTheLimit) {
  const auto longest = [](int width, int halvings, int limit) {
    Image image = bytes(width, 1, std::vector<uint8_t>(width, 7));
    shrink(image, halvings, limit);
    EXPECT_EQ(values(image), std::vector<uint8_t>(image.width, 7));
    return image.width;
  };
  EXPECT_EQ(longest(128, 0, 128), 128);
  EXPECT_EQ(longest(129, 0, 128), 64);
  EXPECT_EQ(longest(1000, 0, 128), 125);
  EXPECT_EQ(longest(1000, 4, 128), 62);
  EXPECT_EQ(longest(1000, 1, 128), 125);
  EXPECT_EQ(longest(1000, 0, 0), 1000);
}

TEST(Shrink, FloatsToo) {
  Image image = bytes(2, 1, {});
  image.bytes.clear();
  image.floats.assign({-1.0f, 4.0f});
  shrink(image, 1, 0);
  ASSERT_EQ(image.floats.size(), 1);
  EXPECT_EQ(image.floats[0], 1.5f);
}

}  // namespace
}  // namespace wardmis
