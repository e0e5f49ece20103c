// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <thread>

#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {
namespace {

// Encoded in memory, so that every error of the disk shows in our own write() and close(), none in a destructor.
std::string encode(const ExrImage& image, bool compress) {
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  Imf::Header header(image.width, image.height);
  header.compression() = compress ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
  Imf::FrameBuffer frame;
  for (const ExrChannel& c : image.channels) {
    header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    // OpenEXR's slices are not const, its writer only reads them
    auto* base = reinterpret_cast<char*>(const_cast<float*>(c.values.data()));
    frame.insert(c.name, Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * static_cast<size_t>(image.width)));
  }
  for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
  Imf::StdOSStream stream;
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return stream.str();
}

}  // namespace

void writeExr(const std::filesystem::path& path, const ExrImage& image, bool compress) {
  std::string bytes;
  try {
    bytes = encode(image, compress);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ExitCode::kFile, fmt::format("{}: cannot be encoded as OpenEXR: {}", path.string(), e.what()));
  }
  writeFile(path, bytes);
}

}  // namespace wardmis
