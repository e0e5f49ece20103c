// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <png.h>
#include <sys/wait.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "film/exr.h"
#include "gltf/file.h"
#include "image/file.h"
#include "math/error.h"
#include "report/difference.h"
#include "report/metrics.h"

namespace wardmis {
namespace {

namespace fs = std::filesystem;

class Folder : public testing::Test {
 protected:
  Folder() { fs::create_directories(folder_); }
  ~Folder() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name) const { return folder_ / name; }

 private:
  fs::path folder_ = fs::path(testing::TempDir()) / ("wardmis_compare_" + std::to_string(getpid()));
};
using Compare = Folder;

RgbImage grey(int width, int height, float value) {
  return {width, height, std::vector<float>(size_t(width) * height * 3, value)};
}

std::string messageOf(const std::function<void()>& f) {
  try {
    f();
  } catch (const Error& e) {
    return std::string(e.what()) + "; " + e.hint;
  }
  return "nothing was thrown";
}

TEST_F(Compare, KnownErrors) {
  RgbImage reference = grey(2, 1, 1), image = reference;
  reference.rgb[5] = 0;
  image.rgb = {1.5f, 1, 1, 1, 1, 0.2f};  // off by 0.5 of 1, and by 0.2 of 0
  const ImageError e = compareImages(image, reference);
  EXPECT_NEAR(e.mse, (0.25 + 0.04) / 6, 1e-7);
  EXPECT_NEAR(e.relMse, (0.25 / 1.01 + 0.04 / 0.01) / 6, 1e-6);
  EXPECT_NEAR(e.relMseTrimmed, 0.25 / 1.01 / 3, 1e-6);  // of two pixels the worst 0.1 % is one
  EXPECT_NEAR(e.mape, (0.5 / 1.01 + 0.2 / 0.01) / 6, 1e-6);
  EXPECT_NEAR(e.relMsePixels.at(0), 0.25 / 1.01 / 3, 1e-6);
  EXPECT_EQ(compareImages(reference, reference).relMse, 0);
}

TEST_F(Compare, TrimmedIsWithoutTheWorstThousandth) {
  const RgbImage reference = grey(100, 20, 1);  // 2000 pixels: two are left out
  RgbImage image = grey(100, 20, 1.1f);
  for (const size_t firefly : {700, 1500})
    for (size_t c = 0; c < 3; ++c) image.rgb[3 * firefly + c] = 1000;
  const ImageError e = compareImages(image, reference);
  EXPECT_NEAR(e.relMseTrimmed, 0.01 / 1.01, 1e-6);
  EXPECT_NEAR(e.relMse, (1998 * 0.01 + 2 * 999.0 * 999.0) / 1.01 / 2000, 1e-2);
}

TEST_F(Compare, SizesAndValuesAreChecked) {
  EXPECT_NE(messageOf([] { compareImages(grey(2, 1, 0), grey(1, 2, 0)); }).find("2 x 1 and 1 x 2"), std::string::npos);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  writeExr(file("a.exr"), {2, 2, {{"R", {0, 0, 0, nan}}, {"G", {0, 0, 0, 0}}, {"B", {0, 0, infinity, 0}}}, {}}, false);
  const std::string said = messageOf([&] { readRgb(file("a.exr")); });
  EXPECT_NE(said.find("2 values are not finite, the first at pixel (0, 1)"), std::string::npos) << said;
  EXPECT_NE(messageOf([&] { readRgb(file("none.png")); }).find("none.png: cannot be opened"), std::string::npos);
}

TEST_F(Compare, LayersOfAnExr) {
  writeExr(file("layers.exr"),
           {1,
            1,
            {{"A.Combined.R", {1}},
             {"A.Combined.G", {2}},
             {"A.Combined.B", {3}},
             {"B.Combined.R", {4}},
             {"B.Combined.G", {5}},
             {"B.Combined.B", {6}}},
            {}},
           false);
  EXPECT_EQ(readRgb(file("layers.exr")).rgb, (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(readRgb(file("layers.exr"), "B").rgb, (std::vector<float>{4, 5, 6}));
  EXPECT_NE(messageOf([&] { readRgb(file("layers.exr"), "C"); }).find("no C.Combined.R, G, B"), std::string::npos);
}

// Bytes of sRGB become linear, rows stay in order.
TEST_F(Compare, PngIsLinearised) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = 1;
  png.height = 2;
  png.format = PNG_FORMAT_RGB;
  const uint8_t pixels[] = {255, 128, 0, 10, 0, 255};
  ASSERT_TRUE(png_image_write_to_file(&png, file("a.png").c_str(), 0, pixels, 0, nullptr));
  const RgbImage image = readRgb(file("a.png"));
  ASSERT_EQ(image.height, 2);
  const float expected[] = {1, 0.21586f, 0, 10 / 255.0f / 12.92f, 0, 1};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(image.rgb[i], expected[i], 1e-5f) << i;
}

TEST_F(Compare, DifferenceAsExrHoldsTheErrors) {
  RgbImage image = grey(2, 2, 1);
  image.rgb[0] = 2;  // at the top left one channel of three is off by 1 of 1
  EXPECT_EQ(writeDifference(file("d.exr"), image, grey(2, 2, 1), 1), "");
  const Image written = readImageFile(mapFile(file("d.exr")).data).image;  // rows from the bottom
  ASSERT_EQ(written.floats.size(), 4u);
  EXPECT_NEAR(written.floats[2], 1 / 1.01 / 3, 1e-6);
  EXPECT_EQ(written.floats[0] + written.floats[1] + written.floats[3], 0);
}

struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
  std::vector<int> at(int x, int y) const {
    const auto i = rgb.begin() + (y * width + x) * 3;
    return {i, i + 3};
  }
};
Picture readPng(const fs::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&png, path.c_str())) return {};
  png.format = PNG_FORMAT_RGB;
  Picture picture{int(png.width), int(png.height), std::vector<uint8_t>(PNG_IMAGE_SIZE(png))};
  png_image_finish_read(&png, nullptr, picture.rgb.data(), 0, nullptr);
  return picture;
}

// Errors of 0, half of the scale, the scale and above it, in the colours of matplotlib's inferno.
TEST_F(Compare, DifferenceAsPictureHasKnownColours) {
  if (!WARDMIS_WITH_OIIO) GTEST_SKIP() << "built without OpenImageIO";
  const RgbImage reference = grey(200, 100, 0.99f);  // |r| + 0.01 = 1
  RgbImage image = reference;
  const float errors[] = {0, 0.125f, 0.25f, 7};
  for (size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] += errors[i / 3 % 200 / 50];
  const std::string note = writeDifference(file("d.png"), image, reference, 0.25);

  const Picture picture = readPng(file("d.png"));
  ASSERT_EQ(picture.width, 200);
  ASSERT_EQ(picture.height, 124);
  const std::vector<int> lowest{0, 0, 4}, middle{188, 55, 84}, highest{252, 255, 164};
  const auto expectColour = [&](int x, int y, const std::vector<int>& colour) {
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(picture.at(x, y)[c], colour[c], 3) << x << ", " << y << ", " << c;
  };
  for (const int y : {0, 99}) {
    expectColour(0, y, lowest);
    expectColour(75, y, middle);
    expectColour(125, y, highest);
    expectColour(199, y, highest);
  }
  expectColour(100, 104, lowest);  // the gap
  expectColour(0, 116, lowest);    // the bar
  expectColour(100, 116, middle);
  expectColour(199, 116, highest);
  // Figures: white at the left, black at the right, unless the machine has no font, which is said.
  int white = 0, black = 0;
  for (int y = 108; y < 124; ++y)
    for (int x = 0; x < 200; ++x) {
      white += x < 20 && picture.at(x, y)[1] > 200;
      black += x > 160 && picture.at(x, y)[0] < 60;
    }
  EXPECT_EQ(note.empty(), white > 8) << note;
  EXPECT_EQ(note.empty(), black > 20) << note;
}

TEST_F(Compare, UnknownFormatsAreNamed) {
  if (!WARDMIS_WITH_OIIO) GTEST_SKIP() << "built without OpenImageIO";
  const std::string said = messageOf([&] { writeDifference(file("d.xyz"), grey(8, 8, 0), grey(8, 8, 0), 1); });
  EXPECT_NE(said.find("d.xyz"), std::string::npos) << said;
  EXPECT_NE(said.find("name an .exr"), std::string::npos) << said;
  EXPECT_FALSE(fs::exists(file("d.xyz")));
}

// The packaged command has no module: what needs none works, all else says what to do.
TEST_F(Compare, CommandWithoutTheModule) {
  fs::copy_file(WARDMIS_COMMAND, file("wardmis"));
  writeExr(file("a.exr"), {1, 1, {{"R", {1}}, {"G", {1}}, {"B", {1}}}, {}}, false);
  std::ofstream(file("a.hdr")) << "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x40\x20\x82";
  const auto run = [&](const std::string& arguments) {
    const std::string command = "cd " + file("").string() + " && ./wardmis compare " + arguments + " >said 2>&1";
    const int status = std::system(command.c_str());
    std::ostringstream text;
    text << WEXITSTATUS(status) << ": " << std::ifstream(file("said")).rdbuf();
    return text.str();
  };
  EXPECT_EQ(run("a.exr a.exr --difference d.exr").substr(0, 2), "0:");
  EXPECT_EQ(run("a.exr a.hdr"),
            "4: wardmis: error: a.hdr: is neither PNG, JPEG nor OpenEXR, and this command comes without OpenImageIO: "
            "wardmis_oiio.so does not lie beside it; save it again as PNG, JPEG or OpenEXR\n");
  EXPECT_EQ(run("a.exr a.exr --difference d.png"),
            "4: wardmis: error: d.png: no picture can be drawn: this command comes without OpenImageIO: "
            "wardmis_oiio.so does not lie beside it; name an .exr for the errors as they are\n");
}

}  // namespace
}  // namespace wardmis
