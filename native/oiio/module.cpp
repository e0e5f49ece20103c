// SPDX-License-Identifier: GPL-3.0-or-later
// The module wardmis_oiio: the one place that knows OpenImageIO.
#include <OpenImageIO/color.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include "image/oiio_interface.h"

namespace {

[[noreturn]] void fail(const std::string& what) { throw std::runtime_error(what); }

// A file in memory that has a path: OpenImageIO tells and reads and writes every format by path, few without one.
class MemoryFile {
 public:
  MemoryFile() : file_(memfd_create("image", MFD_CLOEXEC)) {
    if (file_ < 0) fail("there is no room for a file in memory");
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { ::close(file_); }

  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }
  void write(const char* bytes, size_t size) const {
    for (ssize_t n = 0; size > 0; bytes += n, size -= size_t(n))
      if ((n = ::write(file_, bytes, size)) <= 0) fail("there is no room for a file in memory");
  }
  std::string content() const {
    std::string bytes(size_t(lseek(file_, 0, SEEK_END)), '\0');
    if (pread(file_, bytes.data(), bytes.size(), 0) != ssize_t(bytes.size())) fail("a file in memory cannot be read");
    return bytes;
  }

 private:
  int file_;
};

// What `f` throws, as a text.
template <class F>
const char* told(F f) noexcept {
  thread_local std::string text;
  try {
    f();
    return nullptr;
  } catch (const std::exception& e) {
    static const std::regex path("\"?/proc/self/fd/[0-9]+\"?");  // means nothing to the user
    text = std::regex_replace(e.what(), path, "the image");
    while (text.ends_with('\n')) text.pop_back();
    return text.c_str();
  }
}

OIIO::ImageSpec rgbSpec(int width, int height) { return {width, height, 3, OIIO::TypeUInt8}; }

}  // namespace

extern "C" {

struct OiioReader {
  MemoryFile file;
  std::unique_ptr<OIIO::ImageInput> input;
  OiioFormat format{};
};

static const char* oiioOpen(const void* file, size_t size, OiioReader** reader, OiioFormat* format) {
  return told([&] {
    auto opened = std::make_unique<OiioReader>();
    opened->file.write(static_cast<const char*>(file), size);
    OIIO::ImageSpec straightAlpha;
    straightAlpha["oiio:UnassociatedAlpha"] = 1;
    opened->input = OIIO::ImageInput::open(opened->file.path(), &straightAlpha);
    if (!opened->input) fail(OIIO::geterror());
    const OIIO::ImageSpec& spec = opened->input->spec();
    if (spec.deep || spec.depth > 1) fail("is a deep image or a volume");
    opened->format = {spec.width, spec.height, std::min(spec.nchannels, 4), spec.format != OIIO::TypeUInt8,
                      !spec.format.is_floating_point()};
    *format = opened->format;
    *reader = opened.release();
  });
}

static const char* oiioRead(OiioReader* reader, void* pixels) {
  return told([&] {
    const OiioFormat& f = reader->format;
    const auto row = OIIO::stride_t(f.width) * f.channels * OIIO::stride_t(f.floats ? sizeof(float) : 1);
    char* top = static_cast<char*>(pixels) + row * (f.height - 1);
    if (!reader->input->read_image(0, 0, 0, f.channels, f.floats ? OIIO::TypeFloat : OIIO::TypeUInt8, top,
                                   OIIO::AutoStride, -row) ||
        reader->input->has_error())  // some readers go on after one
      fail(reader->input->geterror());
  });
}

static void oiioClose(OiioReader* reader) { delete reader; }

static const char* oiioColourMap(const char* name, const float* values, int count, uint8_t* rgb) {
  return told([&] {
    // OpenImageIO's buffers are not const, its algorithms only read their source
    const OIIO::ImageBuf from(OIIO::ImageSpec(count, 1, 1, OIIO::TypeFloat), const_cast<float*>(values));
    OIIO::ImageBuf linear;
    if (!OIIO::ImageBufAlgo::color_map(linear, from, 0, name)) fail(linear.geterror());
    std::vector<float> colours(size_t(count) * 3);
    if (!linear.get_pixels(linear.roi(), OIIO::TypeFloat, colours.data())) fail(linear.geterror());
    for (const float v : colours) *rgb++ = uint8_t(std::lround(255 * OIIO::linear_to_sRGB(std::clamp(v, 0.0f, 1.0f))));
  });
}

static const char* oiioDrawText(uint8_t* rgb, int width, int height, int x, int y, bool endsAtX, int size,
                                const char* text, float grey) {
  using namespace OIIO::ImageBufAlgo;
  return told([&] {
    OIIO::ImageBuf picture(rgbSpec(width, height), rgb);
    const float colour[] = {grey, grey, grey};
    if (!render_text(picture, x, y, text, size, "DejaVuSans", colour, endsAtX ? TextAlignX::Right : TextAlignX::Left,
                     TextAlignY::Center))
      fail(picture.geterror());
  });
}

static const char* oiioEncode(const char* name, const uint8_t* rgb, int width, int height, const void** bytes,
                              size_t* size) {
  return told([&] {
    const auto output = OIIO::ImageOutput::create(name);
    if (!output) fail(OIIO::geterror());
    const MemoryFile file;
    if (!output->open(file.path(), rgbSpec(width, height)) || !output->write_image(OIIO::TypeUInt8, rgb) ||
        !output->close())
      fail(output->geterror());
    thread_local std::string content;
    content = file.content();
    if (content.empty()) fail("nothing was written");  // some writers do not tell
    *bytes = content.data();
    *size = content.size();
  });
}

[[gnu::visibility("default")]] const OiioInterface* wardmisOiio() {
  static const OiioInterface interface = {kOiioVersion,  oiioOpen,     oiioRead,  oiioClose,
                                          oiioColourMap, oiioDrawText, oiioEncode};
  OIIO::attribute("threads", 1);  // whoever calls has threads of their own
  return &interface;
}
}
