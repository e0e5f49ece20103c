// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/file.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <turbojpeg.h>

#include <sstream>
#include <stdexcept>

namespace wardmis {
namespace {

using File = std::vector<std::byte>;

File bytesOf(std::string_view text) {
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  return {begin, begin + text.size()};
}

// 2 x 3 pixels, rows from the top: value 10 * row + 3 * column + channel.
constexpr int kWidth = 2, kHeight = 3;
int valueAt(int rowFromTop, int x, int c) { return 10 * rowFromTop + 3 * x + c; }

File pngFile(int format) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = kWidth;
  png.height = kHeight;
  png.format = png_uint_32(format);
  const int channels = PNG_IMAGE_SAMPLE_CHANNELS(png.format);
  std::vector<uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < channels; ++c) pixels.push_back(uint8_t(valueAt(y, x, c)));
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&png, nullptr, &size, 0, pixels.data(), 0, nullptr);
  File file(size);
  png_image_write_to_memory(&png, file.data(), &size, 0, pixels.data(), 0, nullptr);
  return file;
}

TEST(ImageFile, PngKeepsItsBytesAndRowsStartAtTheBottom) {
  for (const auto& [format, channels] : {std::pair{PNG_FORMAT_GRAY, 1}, {PNG_FORMAT_RGB, 3}, {PNG_FORMAT_RGBA, 4}}) {
    const Image image = readImageFile(pngFile(format)).image;
    ASSERT_EQ(image.channels, channels);
    ASSERT_EQ(image.bytes.size(), size_t(kWidth * kHeight * channels));
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < channels; ++c)
          EXPECT_EQ(image.bytes[((kHeight - 1 - y) * kWidth + x) * channels + c], valueAt(y, x, c));
  }
}

TEST(ImageFile, SixteenBitPngBecomesFloats) {
  // one grey pixel of 0x8000, with libpng's writer of rows
  File file;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &file,
      [](png_structp p, png_bytep data, size_t count) {
        auto* begin = reinterpret_cast<std::byte*>(data);
        auto& to = *static_cast<File*>(png_get_io_ptr(p));
        to.insert(to.end(), begin, begin + count);
      },
      nullptr);
  png_set_IHDR(png, info, 1, 1, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info(png, info);
  uint8_t pixel[2] = {0x80, 0x00};
  png_write_row(png, pixel);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);

  const FileImage read = readImageFile(file);
  EXPECT_TRUE(read.integers);
  EXPECT_NEAR(read.image.floats.at(0), 0.5f, 1e-4f);
}

TEST(ImageFile, JpegColoursAndOrientation) {
  // 16 x 16: upper half red, lower half blue
  std::vector<uint8_t> pixels;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      for (const int v : {y < 8 ? 255 : 0, 0, y < 8 ? 0 : 255}) pixels.push_back(uint8_t(v));
  tjhandle jpeg = tjInitCompress();
  unsigned char* data = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(jpeg, pixels.data(), 16, 0, 16, TJPF_RGB, &data, &size, TJSAMP_444, 95, 0), 0);
  const File file(reinterpret_cast<std::byte*>(data), reinterpret_cast<std::byte*>(data) + size);
  tjFree(data);
  tjDestroy(jpeg);

  const Image image = readImageFile(file).image;
  ASSERT_EQ(image.channels, 3);
  EXPECT_NEAR(image.bytes[2], 255, 3);                       // bottom left: blue
  EXPECT_NEAR(image.bytes[image.bytes.size() - 3], 255, 3);  // top right: red
  const File cut(file.begin(), file.begin() + long(file.size() / 2));
  EXPECT_THROW(readImageFile(cut), std::runtime_error);
}

class Memory : public Imf::OStream {
 public:
  Memory() : OStream("memory") {}
  void write(const char c[], int n) override { stream_.write(c, n); }
  uint64_t tellp() override { return uint64_t(stream_.tellp()); }
  void seekp(uint64_t position) override { stream_.seekp(std::streamoff(position)); }
  File file() const { return bytesOf(stream_.str()); }

 private:
  std::stringstream stream_;
};

File exrFile(std::initializer_list<const char*> channels) {
  const Imath::Box2i window({5, 7}, {5 + kWidth - 1, 7 + kHeight - 1});  // a data window that is not at the origin
  Imf::Header header(window, window);
  std::vector<float> pixels;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < int(channels.size()); ++c) pixels.push_back(100000.0f * float(valueAt(y, x, c)));
  Imf::FrameBuffer frame;
  size_t c = 0;
  for (const char* name : channels) {
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, pixels.data() + c++, window, sizeof(float) * channels.size(),
                                        sizeof(float) * channels.size() * kWidth));
  }
  Memory memory;
  {
    Imf::OutputFile out(memory, header);
    out.setFrameBuffer(frame);
    out.writePixels(kHeight);
  }
  return memory.file();
}

TEST(ImageFile, ExrIsReadInFullRange) {
  const Image image = readImageFile(exrFile({"R", "G", "B"})).image;
  ASSERT_EQ(image.channels, 3);
  EXPECT_EQ(image.width, kWidth);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(image.floats[((kHeight - 1 - y) * kWidth + x) * 3 + c], 100000.0f * float(valueAt(y, x, c)));
  EXPECT_EQ(readImageFile(exrFile({"Y"})).image.channels, 1);
  EXPECT_THROW(readImageFile(exrFile({"depth.Z"})), std::runtime_error);
  File cut = exrFile({"Y"});
  cut.pop_back();
  try {
    readImageFile(cut);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const std::runtime_error& e) {
    EXPECT_TRUE(std::string_view(e.what()).starts_with("is a damaged OpenEXR file: ")) << e.what();
  }
}

// Through OpenImageIO. 2 pixels of Radiance's flat rows: (128, 64, 32) * 2^(130 - 136).
TEST(ImageFile, Radiance) {
  if (!WARDMIS_WITH_OIIO) GTEST_SKIP() << "built without OpenImageIO";
  using namespace std::string_literals;
  const FileImage read = readImageFile(bytesOf(
      "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n\x80\x40\x20\x82\0\0\0\0\x01\x02\x03\x88\x80\x80\x80\x81"s));
  EXPECT_FALSE(read.integers);
  EXPECT_EQ(read.image.channels, 3);
  EXPECT_EQ(read.image.floats, (Texels<float>{1, 2, 3, 1, 1, 1, 2, 1, 0.5f, 0, 0, 0}));
}

// One strip without compression: kWidth x kHeight pixels of valueAt, `bits` each.
File tiffFile(uint16_t channels, uint16_t bits) {
  File file = bytesOf(std::string_view("II*\0\x08\0\0\0", 8));
  const auto put = [&](uint32_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) file.push_back(std::byte(value >> 8 * i & 0xFF));
  };
  const uint32_t size = kWidth * kHeight * channels * bits / 8, entries = channels == 4 ? 10 : 9;
  const uint32_t bitsAt = 8 + 2 + 12 * entries + 4, pixelsAt = bitsAt + 2 * channels;
  put(entries, 2);
  const auto entry = [&](uint32_t tag, uint32_t type, uint32_t count, uint32_t value) {
    put(tag, 2), put(type, 2), put(count, 4), put(value, 4);
  };
  constexpr uint32_t kShort = 3, kLong = 4;
  entry(256, kShort, 1, kWidth);
  entry(257, kShort, 1, kHeight);
  entry(258, kShort, channels, bitsAt);
  entry(259, kShort, 1, 1);  // no compression
  entry(262, kShort, 1, 2);  // RGB
  entry(273, kLong, 1, pixelsAt);
  entry(277, kShort, 1, channels);
  entry(278, kShort, 1, kHeight);
  entry(279, kLong, 1, size);
  if (channels == 4) entry(338, kShort, 1, 2);  // straight alpha
  put(0, 4);
  for (int c = 0; c < channels; ++c) put(bits, 2);
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      for (int c = 0; c < channels; ++c) put(uint32_t(valueAt(y, x, c)) * (bits == 16 ? 257 : 1), bits / 8);
  return file;
}

TEST(ImageFile, TiffKeepsItsBytesAndRowsStartAtTheBottom) {
  if (!WARDMIS_WITH_OIIO) GTEST_SKIP() << "built without OpenImageIO";
  for (const uint16_t channels : {3, 4}) {
    const FileImage bytes = readImageFile(tiffFile(channels, 8)), words = readImageFile(tiffFile(channels, 16));
    EXPECT_TRUE(bytes.integers && words.integers);
    ASSERT_EQ(bytes.image.channels, channels);
    ASSERT_EQ(bytes.image.bytes.size(), size_t(kWidth * kHeight * channels));
    ASSERT_EQ(words.image.floats.size(), bytes.image.bytes.size());
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < channels; ++c) {
          const size_t i = size_t(((kHeight - 1 - y) * kWidth + x) * channels + c);
          EXPECT_EQ(bytes.image.bytes[i], valueAt(y, x, c));
          EXPECT_NEAR(words.image.floats[i], float(valueAt(y, x, c)) / 255, 1e-6f);
        }
  }
}

TEST(ImageFile, DamageIsAnError) {
  using namespace std::string_literals;
  std::vector<std::pair<std::string, File>> files = {
      {"empty", {}},
      {"text", bytesOf("hello")},
      {"hugePng", bytesOf("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\x0f\0\0\0\x0f\0\0\x08\x06\0\0\0\0\0\0\0"s)},
      {"hugeHdr", bytesOf("#?RADIANCE\n\n-Y 999999 +X 999999\n")},
      {"emptyHdr", bytesOf("#?RADIANCE\n\n-Y 0 +X 0\n")},
      {"cutHdr", bytesOf("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 8\n\x02\x02\0\x08\x88"s)},
  };
  for (const File& whole : {pngFile(PNG_FORMAT_RGB), exrFile({"R", "G", "B"})})
    for (size_t size = 4; size + 13 < whole.size(); size += 7)
      files.emplace_back("cut at " + std::to_string(size), File(whole.begin(), whole.begin() + long(size)));
  for (const auto& [name, file] : files) {
    EXPECT_THROW(readImageFile(file), std::runtime_error) << name;
  }
}

}  // namespace
}  // namespace wardmis
