// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/compare.h"

#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "film/exr.h"
#include "film/write_file.h"
#include "image/oiio.h"
#include "math/error.h"
#include "scene/glb_file.h"
#include "scene/image_file.h"
#include "scene/texture.h"

namespace wardmis {
namespace {

constexpr const char* kNameAnExr = "name an .exr for the errors as they are";

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

RgbImage readOtherRgb(const std::filesystem::path& path, const Bytes& bytes) try {
  FileImage file = readImageFile(bytes.data);
  Image& from = file.image;
  from.srgb = file.integers;
  RgbImage image{from.width, from.height, {}};
  image.rgb.reserve(static_cast<size_t>(from.width) * static_cast<size_t>(from.height) * 3);
  for (int y = from.height - 1; y >= 0; --y)
    for (int x = 0; x < from.width; ++x) {
      const Rgb texel =
          texelRgb(from, static_cast<size_t>(y) * static_cast<size_t>(from.width) + static_cast<size_t>(x));
      for (const float v : {texel.x, texel.y, texel.z})
        image.rgb.push_back(file.integers && !from.floats.empty() ? srgbToLinear(v) : v);
    }
  return image;
} catch (const Error&) {
  throw;
} catch (const std::runtime_error& e) {
  throw Error(ExitCode::kFile, fmt::format("{}: {}", path.string(), e.what()), "save it again as PNG, JPEG or OpenEXR");
}

// What a function of the module says is wrong.
void check(const std::filesystem::path& path, const char* wrong) {
  if (wrong) throw Error(ExitCode::kFile, fmt::format("{}: cannot be drawn: {}", path.string(), wrong), kNameAnExr);
}

}  // namespace

RgbImage readRgb(const std::filesystem::path& path, const std::string& layer) {
  const Bytes bytes = mapFile(path);  // which wants a regular file: OpenEXR would wait for whoever feeds a FIFO
  const bool isExr = bytes.size() >= 4 && Imf::isImfMagic(reinterpret_cast<const char*>(bytes.data.data()));
  RgbImage image = isExr ? readExrRgb(path, layer) : readOtherRgb(path, bytes);
  size_t bad = 0, first = 0;
  for (size_t i = 0; i < image.rgb.size(); ++i)
    if (!std::isfinite(image.rgb[i]) && bad++ == 0) first = i / 3;
  const auto width = static_cast<size_t>(image.width);
  if (bad > 0)
    throw Error(ExitCode::kFile,
                fmt::format("{}: {} values are not finite, the first at pixel ({}, {})", path.string(), bad,
                            first % width, first / width),
                "errors of such an image mean nothing");
  return image;
}

ImageError compareImages(const RgbImage& image, const RgbImage& reference) {
  if (image.width != reference.width || image.height != reference.height)
    throw Error(ExitCode::kUsage,
                fmt::format("the images differ in size: {} x {} and {} x {}", image.width, image.height,
                            reference.width, reference.height),
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
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(keep == pixels ? pixels - 1 : keep),
                   sorted.end());
  double kept = 0;
  for (size_t i = 0; i < keep; ++i) kept += double(sorted[i]);
  e.relMseTrimmed = kept / static_cast<double>(std::max<size_t>(1, keep));
  return e;
}

std::string writeDifference(const std::filesystem::path& path, const RgbImage& image, const RgbImage& reference,
                            double scale) {
  const int w = image.width, h = image.height;
  std::vector<float> error(static_cast<size_t>(w) * static_cast<size_t>(h));
  for (size_t i = 0; i < error.size(); ++i) {
    double sum = 0;
    for (size_t c = 3 * i; c < 3 * i + 3; ++c)
      sum += std::abs(double(image.rgb[c]) - double(reference.rgb[c])) /
             (std::abs(double(reference.rgb[c])) + kMapeEpsilon);
    error[i] = static_cast<float>(sum / 3);
  }
  if (path.extension() == ".exr") {
    writeExr(path, {w, h, {{"Y", std::move(error)}}, {}}, true);
    return {};
  }

  // The errors, a black gap, and a bar from 0 to `scale`.
  constexpr int kGap = 8, kBar = 16, kFigures = 13;
  for (float& e : error) e = static_cast<float>(std::min(double(e) / scale, 1.0));
  error.resize(static_cast<size_t>(w) * static_cast<size_t>(h + kGap));
  for (int i = 0; i < w * kBar; ++i) error.push_back((static_cast<float>(i % w) + 0.5f) / static_cast<float>(w));
  const OiioInterface& module = [&]() -> const OiioInterface& {
    try {
      return oiio();
    } catch (const std::runtime_error& e) {
      throw Error(ExitCode::kFile, fmt::format("{}: no picture can be drawn: {}", path.string(), e.what()), kNameAnExr);
    }
  }();
  const int height = h + kGap + kBar, middle = h + kGap + kBar / 2;
  std::vector<uint8_t> rgb(error.size() * 3);
  check(path, module.colourMap("inferno", error.data(), static_cast<int>(error.size()), rgb.data()));
  std::string note;
  const auto figure = [&](const std::string& text, int x, bool endsAtX, float grey) {
    if (const char* wrong = module.drawText(rgb.data(), w, height, x, middle, endsAtX, kFigures, text.c_str(), grey))
      note = fmt::format("{}: the bar of colours, which ends at {}, has no figures: {}", path.string(), scale, wrong);
  };
  figure("0", 4, false, 1);
  figure(fmt::format("{:.3g}", scale), w - 4, true, 0);
  const void* bytes = nullptr;
  size_t size = 0;
  check(path, module.encode(path.c_str(), rgb.data(), w, height, &bytes, &size));
  writeFile(path, {static_cast<const char*>(bytes), size});
  return note;
}

}  // namespace wardmis
