// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/image.h"

#include <IexBaseExc.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>
#include <ImfVersion.h>
#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "gltf/file.h"
#include "image/file.h"
#include "image/texture.h"
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

}  // namespace wardmis
