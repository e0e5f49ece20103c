// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/file.h"

#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <fmt/format.h>
#include <png.h>
#include <turbojpeg.h>

#include <algorithm>
#include <array>
#include <bit>
#include <csetjmp>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <string_view>

#include "image/codecs.h"
#include "image/oiio.h"

namespace wardmis {
namespace {

using Bytes = std::span<const std::byte>;

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

// A file of a few bytes may claim a size that no memory holds: refuse before allocating.
Image sized(Bytes file, int64_t width, int64_t height, int channels) {
  const int64_t side = 1 << 16;
  if (width < 1 || height < 1 || width > side || height > side)
    fail(fmt::format("has {} x {} pixels; 1 to {} a side can be used", width, height, side));
  // No format compresses better than this, so a larger claim is a lie (or a bomb).
  const int64_t values = width * height * channels;
  if (values > (int64_t{64} << 20) && values / 4096 > static_cast<int64_t>(file.size()))
    fail(fmt::format("claims {} x {} pixels in {} bytes", width, height, file.size()));
  Image image;
  image.width = static_cast<int>(width);
  image.height = static_cast<int>(height);
  image.channels = channels;
  return image;
}

// From rows that begin at the top to rows that begin at the bottom.
template <class T>
void turnOver(Texels<T>& values, const Image& image) {
  const size_t row = size_t(image.width) * image.channels;
  for (int y = 0; y < image.height / 2; ++y)
    std::swap_ranges(values.begin() + y * row, values.begin() + (y + 1) * row,
                     values.begin() + (image.height - 1 - y) * row);
}

size_t valueCount(const Image& image) { return size_t(image.width) * image.height * image.channels; }

// ---- PNG ------------------------------------------------------------------------------------------------------------

struct PngReader {
  Bytes file;
  size_t position = 0;
  std::array<char, 160> message{};
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

void pngError(png_structp png, png_const_charp what) {
  auto& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
  std::strncpy(reader.message.data(), what, reader.message.size() - 1);
  longjmp(png_jmpbuf(png), 1);  // NOLINT: libpng's way; no object with a destructor lives between here and setjmp
}

void pngRead(png_structp png, png_bytep to, size_t count) {
  auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
  if (count > reader.file.size() - reader.position) png_error(png, "the file ends too early");
  std::memcpy(to, reader.file.data() + reader.position, count);
  reader.position += count;
}

// libpng reports errors by longjmp: what these two functions need is owned by their caller.
bool pngReadHeader(PngReader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;  // NOLINT
  png_set_read_fn(reader.png, &reader, pngRead);
  png_set_user_limits(reader.png, 1 << 20, 1 << 20);
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);  // palettes, 1 to 4 bits and transparent colours become 8-bit channels
  if (std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}
bool pngReadRows(PngReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;  // NOLINT
  png_read_image(reader.png, rows);
  return true;
}

FileImage decodePng(Bytes file) {
  PngReader reader{file};
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, pngError, [](png_structp, png_const_charp) {});
  reader.info = reader.png ? png_create_info_struct(reader.png) : nullptr;
  if (!reader.info) throw std::bad_alloc();
  if (!pngReadHeader(reader)) fail(std::string("is a damaged PNG file: ") + reader.message.data());

  const png_structp png = reader.png;
  const png_infop info = reader.info;
  Image image =
      sized(file, png_get_image_width(png, info), png_get_image_height(png, info), png_get_channels(png, info));
  const bool deep = png_get_bit_depth(png, info) == 16;
  const size_t rowBytes = png_get_rowbytes(png, info);
  Texels<uint8_t> pixels(rowBytes * image.height);
  std::vector<png_bytep> rows(image.height);  // the file's first row is the image's top
  for (int y = 0; y < image.height; ++y) rows[y] = pixels.data() + rowBytes * (image.height - 1 - y);
  if (!pngReadRows(reader, rows.data())) fail(std::string("is a damaged PNG file: ") + reader.message.data());

  if (!deep) {
    image.bytes = std::move(pixels);
    return {std::move(image), true};
  }
  image.floats.resize(valueCount(image));
  for (size_t i = 0; i < image.floats.size(); ++i) {
    uint16_t value;
    std::memcpy(&value, pixels.data() + 2 * i, 2);
    image.floats[i] = value / 65535.0f;
  }
  return {std::move(image), true};
}

// ---- JPEG -----------------------------------------------------------------------------------------------------------

FileImage decodeJpeg(Bytes file) {
  const std::unique_ptr<void, int (*)(tjhandle)> jpeg(tjInitDecompress(), tjDestroy);
  if (!jpeg) throw std::bad_alloc();
  const auto damaged = [&] { fail(std::string("is a damaged JPEG file: ") + tjGetErrorStr2(jpeg.get())); };
  const auto* data = reinterpret_cast<const unsigned char*>(file.data());
  int width = 0, height = 0, subsampling = 0, space = 0;
  if (tjDecompressHeader3(jpeg.get(), data, file.size(), &width, &height, &subsampling, &space) != 0) damaged();
  if (space == TJCS_CMYK || space == TJCS_YCCK) fail("is a CMYK JPEG; RGB or grey is expected");

  const bool grey = space == TJCS_GRAY;
  Image image = sized(file, width, height, grey ? 1 : 3);
  image.bytes.resize(valueCount(image));
  if (tjDecompress2(jpeg.get(), data, file.size(), image.bytes.data(), width, 0, height, grey ? TJPF_GRAY : TJPF_RGB,
                    TJFLAG_BOTTOMUP) != 0)
    damaged();
  return {std::move(image), true};
}

// ---- OpenEXR --------------------------------------------------------------------------------------------------------

class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(Bytes file) : IStream("image"), file_(file) {}
  bool read(char to[], int count) override {
    if (count < 0 || uint64_t(count) > file_.size() - position_) throw Iex::BaseExc("the file ends too early");
    std::memcpy(to, file_.data() + position_, size_t(count));
    position_ += uint64_t(count);
    return position_ < file_.size();
  }
  uint64_t tellg() override { return position_; }
  void seekg(uint64_t position) override {
    if (position > file_.size()) throw Iex::BaseExc("an offset lies beyond the end of the file");
    position_ = position;
  }

 private:
  Bytes file_;
  uint64_t position_ = 0;
};

FileImage decodeExr(Bytes file) try {
  MemoryStream stream(file);
  Imf::InputFile exr(stream, 0);
  const Imf::ChannelList& channels = exr.header().channels();
  std::vector<std::string> wanted;
  for (const char* channel : {"R", "G", "B", "A"})
    if (channels.findChannel(channel)) wanted.emplace_back(channel);
  if (wanted.empty() && channels.findChannel("Y")) wanted = {"Y"};
  if (wanted.empty()) fail("is an OpenEXR file without channels R, G, B or Y");

  const Imath::Box2i window = exr.header().dataWindow();
  Image image = sized(file, int64_t(window.max.x) - window.min.x + 1, int64_t(window.max.y) - window.min.y + 1,
                      int(wanted.size()));
  image.floats.resize(valueCount(image));
  Imf::FrameBuffer frame;
  for (size_t c = 0; c < wanted.size(); ++c)
    frame.insert(wanted[c],
                 Imf::Slice::Make(Imf::FLOAT, image.floats.data() + c, window, sizeof(float) * image.channels,
                                  sizeof(float) * image.channels * image.width));
  exr.setFrameBuffer(frame);
  exr.readPixels(window.min.y, window.max.y);
  turnOver(image.floats, image);
  return {std::move(image), false};
} catch (const Iex::BaseExc& e) {
  fail(std::string("is a damaged OpenEXR file: ") + e.what());
}

// ---- WebP -----------------------------------------------------------------------------------------------------------

FileImage decodeWebp(Bytes file) {
  const auto check = [](const char* wrong) {
    if (wrong) fail(std::string("is a WebP file that cannot be read: ") + wrong);
  };
  int width = 0, height = 0, channels = 0;
  check(codecs().webpOpen(file.data(), file.size(), &width, &height, &channels));
  Image image = sized(file, width, height, channels);
  image.bytes.resize(valueCount(image));
  check(codecs().webpRead(file.data(), file.size(), width, height, channels, image.bytes.data()));
  turnOver(image.bytes, image);
  return {std::move(image), true};
}

// ---- everything else ------------------------------------------------------------------------------------------------

FileImage decodeThroughOiio(Bytes file) {
  const std::string foreign = "is neither PNG, JPEG nor OpenEXR, and ";
  const OiioInterface& module = [&]() -> const OiioInterface& {
    try {
      return oiio();
    } catch (const std::runtime_error& e) {
      fail(foreign + e.what());
    }
  }();
  const auto check = [&](const char* wrong) {
    if (wrong) fail(foreign + "cannot be read otherwise: " + wrong);
  };
  OiioReader* opened = nullptr;
  OiioFormat format{};
  check(module.open(file.data(), file.size(), &opened, &format));
  const std::unique_ptr<OiioReader, void (*)(OiioReader*)> reader(opened, module.close);
  Image image = sized(file, format.width, format.height, format.channels);
  if (format.floats) {
    image.floats.resize(valueCount(image));
    check(module.read(opened, image.floats.data()));
  } else {
    image.bytes.resize(valueCount(image));
    check(module.read(opened, image.bytes.data()));
  }
  return {std::move(image), format.integers};
}

bool startsWith(Bytes file, std::string_view magic) {
  return file.size() >= magic.size() && std::memcmp(file.data(), magic.data(), magic.size()) == 0;
}

}  // namespace

FileImage readImageFile(Bytes file) {
  using namespace std::string_view_literals;
  if (startsWith(file, "\x89PNG\r\n\x1A\n"sv)) return decodePng(file);
  if (startsWith(file, "\xFF\xD8\xFF"sv)) return decodeJpeg(file);
  if (startsWith(file, "\x76\x2F\x31\x01"sv)) return decodeExr(file);
  if (startsWith(file, "RIFF"sv) && file.size() > 12 && startsWith(file.subspan(8), "WEBP"sv) && codecs().webpOpen)
    return decodeWebp(file);
  if (startsWith(file, "\xABKTX 20\xBB\r\n\x1A\n"sv) || startsWith(file, "sB"sv))
    fail("is a KTX2 or Basis file (KHR_texture_basisu), which is not read; give it as PNG, JPEG or WebP");
  if (file.empty()) fail("is empty");
  return decodeThroughOiio(file);
}

}  // namespace wardmis
