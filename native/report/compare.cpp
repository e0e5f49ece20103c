// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/compare.h"

#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "film/exr.h"
#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {
namespace {

// What stands before "R", "G" and "B" in the names of the channels of `layer`; "-" if they are not there.
std::string prefixOfRgb(const Imf::ChannelList& channels, const std::string& layer) {
  std::vector<std::string> prefixes;
  if (!layer.empty()) {
    prefixes = {layer + ".Combined."};
  } else {
    for (auto c = channels.begin(); c != channels.end(); ++c)
      if (const std::string name = c.name(); name.ends_with(".Combined.R"))
        prefixes.push_back(name.substr(0, name.size() - 1));
    prefixes.insert(prefixes.end(), {"Combined.", ""});
  }
  for (const std::string& p : prefixes)
    if (channels.findChannel(p + "R") && channels.findChannel(p + "G") && channels.findChannel(p + "B")) return p;
  return "-";
}

RgbImage readPart(Imf::MultiPartInputFile& file, int part, const std::string& prefix) {
  Imf::InputPart in(file, part);
  const Imath::Box2i window = in.header().dataWindow();
  RgbImage image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}};
  image.rgb.resize(static_cast<size_t>(image.width) * static_cast<size_t>(image.height) * 3);
  Imf::FrameBuffer frame;
  for (size_t c = 0; c < 3; ++c)
    frame.insert(prefix + "RGB"[c], Imf::Slice::Make(Imf::FLOAT, image.rgb.data() + c, window, 3 * sizeof(float),
                                                     3 * sizeof(float) * static_cast<size_t>(image.width)));
  in.setFrameBuffer(frame);
  in.readPixels(window.min.y, window.max.y);
  return image;
}

RgbImage readExrRgb(const std::filesystem::path& path, const std::string& layer) try {
  Imf::MultiPartInputFile file(path.c_str());
  for (int part = 0; part < file.parts(); ++part) {  // layers may be parts
    const Imf::Header& header = file.header(part);
    if (header.hasType() && Imf::isDeepData(header.type())) continue;
    const std::string prefix = prefixOfRgb(header.channels(), layer);
    if (prefix != "-") return readPart(file, part, prefix);
  }
  throw Error(ExitCode::kFile,
              fmt::format("{}: no {}R, G, B channels", path.string(), layer.empty() ? "" : layer + ".Combined."),
              "name another layer, or another file");
} catch (const Iex::BaseExc& e) {
  throw Error(ExitCode::kFile, fmt::format("{}: cannot be read as OpenEXR: {}", path.string(), e.what()),
              "give an OpenEXR file, for example one that 'wardmis render' wrote");
}

// ---- pictures -------------------------------------------------------------------------------------------------------

using Colour = std::array<uint8_t, 3>;

// "inferno" of matplotlib at equal steps, t in 0..1.
Colour falseColour(double t) {
  static constexpr double steps[9][3] = {{0, 0, 4},     {31, 12, 72},   {85, 15, 109},  {136, 34, 106}, {186, 54, 85},
                                         {227, 89, 51}, {249, 140, 10}, {249, 201, 50}, {252, 255, 164}};
  const double at = std::clamp(t, 0.0, 1.0) * 8;
  const auto i = std::min<size_t>(7, static_cast<size_t>(at));
  Colour out{};
  for (size_t c = 0; c < 3; ++c)
    out[c] = static_cast<uint8_t>(std::lround(steps[i][c] + (steps[i + 1][c] - steps[i][c]) * (at - double(i))));
  return out;
}

struct Picture {
  int width, height;
  std::vector<uint8_t> rgb = std::vector<uint8_t>(static_cast<size_t>(width) * static_cast<size_t>(height) * 3);

  void set(int x, int y, const Colour& colour) {
    if (x < 0 || x >= width || y < 0 || y >= height) return;
    std::copy(colour.begin(), colour.end(), rgb.begin() + (std::ptrdiff_t{y} * width + x) * 3);
  }
};

// Figures, in characters of 3 x 5 dots (15 bits, the first row's left dot highest) that are twice as large on the picture.
void write(Picture& picture, int x, int y, std::string_view text, const Colour& colour) {
  static constexpr std::string_view characters = "0123456789.e+-";
  static constexpr uint16_t dots[] = {0x7b6f, 0x2c97, 0x73e7, 0x73cf, 0x5bc9, 0x79cf, 0x79ef,
                                      0x7249, 0x7bef, 0x7bcf, 0x0002, 0x0fe7, 0x05d0, 0x01c0};
  for (const char c : text) {
    const size_t at = characters.find(c);
    for (int dot = 0; at != std::string_view::npos && dot < 4 * 15; ++dot)
      if (dots[at] >> (14 - dot / 4) & 1)
        picture.set(x + dot / 4 % 3 * 2 + dot % 2, y + dot / 4 / 3 * 2 + dot / 2 % 2, colour);
    x += 8;
  }
}

std::string encodePng(const Picture& picture) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(picture.width);
  png.height = static_cast<png_uint_32>(picture.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png);
  std::string bytes(size, '\0');
  if (!png_image_write_to_memory(&png, bytes.data(), &size, 0, picture.rgb.data(), 0, nullptr))
    throw Error(ExitCode::kFile, fmt::format("a picture cannot be encoded as PNG: {}", png.message));
  bytes.resize(size);
  return bytes;
}

}  // namespace

RgbImage readRgb(const std::filesystem::path& path, const std::string& layer) {
  RgbImage image = readExrRgb(path, layer);
  size_t bad = 0, first = 0;
  for (size_t i = 0; i < image.rgb.size(); ++i)
    if (!std::isfinite(image.rgb[i]) && bad++ == 0) first = i / 3;
  const auto width = static_cast<size_t>(image.width);
  if (bad > 0)
    throw Error(ExitCode::kFile, fmt::format("{}: {} values are not finite, the first at pixel ({}, {})", path.string(),
                                             bad, first % width, first / width),
                "errors of such an image mean nothing");
  return image;
}

ImageError compareImages(const RgbImage& image, const RgbImage& reference) {
  if (image.width != reference.width || image.height != reference.height)
    throw Error(ExitCode::kUsage, fmt::format("the images differ in size: {} x {} and {} x {}", image.width, image.height, reference.width, reference.height),
                "compare renders of the same resolution and border");
  const size_t pixels = image.rgb.size() / 3;
  ImageError e;
  e.relMsePixels.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    double relative = 0;
    for (size_t c = 0; c < 3; ++c) {
      const double x = double(image.rgb[3 * i + c]), r = double(reference.rgb[3 * i + c]), d = x - r;
      e.mse += d * d;
      relative += d * d / (r * r + kRelMseEpsilon);
      e.mape += std::abs(d) / (std::abs(r) + kMapeEpsilon);
    }
    e.relMsePixels[i] = static_cast<float>(relative / 3);
    e.relMse += relative;
  }
  const double n = 3.0 * static_cast<double>(std::max<size_t>(1, pixels));
  e.mse /= n, e.relMse /= n, e.mape /= n;
  std::vector<float> sorted = e.relMsePixels;
  const size_t keep = pixels - pixels / 1000;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(keep == pixels ? pixels - 1 : keep), sorted.end());
  double kept = 0;
  for (size_t i = 0; i < keep; ++i) kept += double(sorted[i]);
  e.relMseTrimmed = kept / static_cast<double>(std::max<size_t>(1, keep));
  return e;
}

void writeDifference(const std::filesystem::path& path, const RgbImage& image, const RgbImage& reference, double scale) {
  const int w = image.width, h = image.height;
  std::vector<float> error(static_cast<size_t>(w) * static_cast<size_t>(h));
  for (size_t i = 0; i < error.size(); ++i) {
    double sum = 0;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c)
      sum += std::abs(double(image.rgb[c]) - double(reference.rgb[c])) / (std::abs(double(reference.rgb[c])) + kMapeEpsilon);
    error[i] = static_cast<float>(sum / 3);
  }
  if (path.extension() == ".exr") return writeExr(path, {w, h, {{"Y", std::move(error)}}, {}}, true);

  Picture picture{w, h + 24};
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x)
      picture.set(x, y, falseColour(double(error[static_cast<size_t>(y) * static_cast<size_t>(w) + static_cast<size_t>(x)]) / scale));
  for (int y = h + 8; y < h + 24; ++y)
    for (int x = 0; x < w; ++x) picture.set(x, y, falseColour((x + 0.5) / w));
  const std::string top = fmt::format("{:.3g}", scale);
  write(picture, 4, h + 11, "0", {255, 255, 255});
  write(picture, w - 4 - 8 * static_cast<int>(top.size()), h + 11, top, {0, 0, 0});
  writeFile(path, encodePng(picture));
}

}  // namespace wardmis
