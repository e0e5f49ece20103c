// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/exr.h"

#include <IexBaseExc.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {
namespace {

// A file in memory. The library's own, of a std::ostringstream, grows by copying and is copied at the end.
class MemoryStream : public Imf::OStream {
 public:
  explicit MemoryStream(size_t expected) : Imf::OStream("memory") { bytes_.reserve(expected); }

  void write(const char c[], int n) override {
    const auto count = static_cast<size_t>(n);
    const size_t over = std::min(count, bytes_.size() - at_);
    std::copy_n(c, over, bytes_.begin() + static_cast<ptrdiff_t>(at_));
    bytes_.append(c + over, count - over);
    at_ += count;
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t to) override {
    if (to > bytes_.size()) bytes_.resize(to);
    at_ = to;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
  size_t at_ = 0;
};

// Encoded in memory, so that every error of the disk shows in our own write() and close(), none in a destructor.
std::string encode(const ExrImage& image, bool compress) {
  Imf::setGlobalThreadCount(static_cast<int>(std::thread::hardware_concurrency()));
  Imf::Header header(image.width, image.height);
  header.compression() = compress ? Imf::ZIP_COMPRESSION : Imf::NO_COMPRESSION;
  Imf::FrameBuffer frame;
  const auto insert = [&](const auto& channels, Imf::PixelType type) {
    for (const auto& c : channels) {
      header.channels().insert(c.name, Imf::Channel(type));
      constexpr size_t kSize = sizeof(c.values[0]);
      // OpenEXR's slices are not const, its writer only reads them
      auto* base = const_cast<char*>(reinterpret_cast<const char*>(c.values.data()));
      frame.insert(c.name, Imf::Slice(type, base, kSize, kSize * static_cast<size_t>(image.width)));
    }
  };
  insert(image.channels, Imf::FLOAT), insert(image.words, Imf::UINT);
  for (const auto& [name, value] : image.attributes) header.insert(name, Imf::StringAttribute(value));
  constexpr size_t kHeader = 1 << 16;
  MemoryStream stream(kHeader + sizeof(float) * static_cast<size_t>(image.width) * static_cast<size_t>(image.height) *
                                    (image.channels.size() + image.words.size()));
  {
    Imf::OutputFile file(stream, header);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
  }
  return stream.take();
}

std::vector<std::pair<std::string, std::string>> textsOf(const Imf::Header& header) {
  std::vector<std::pair<std::string, std::string>> texts;
  for (auto a = header.begin(); a != header.end(); ++a)
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a.attribute()))
      texts.emplace_back(a.name(), text->value());
  return texts;
}

Error unreadable(const std::filesystem::path& path, const Iex::BaseExc& e) {
  return {ExitCode::kFile, fmt::format("{}: cannot be read as OpenEXR: {}", path.string(), e.what()),
          "the file may be damaged; delete it, or give another"};
}

}  // namespace

ExrImage readExr(const std::filesystem::path& path, const std::string& wholeNumbers) try {
  Imf::InputFile file(path.c_str());
  const Imath::Box2i window = file.header().dataWindow();
  ExrImage image{window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, {}, {}};
  const size_t width = static_cast<size_t>(image.width), count = width * static_cast<size_t>(image.height);
  const Imf::ChannelList& channels = file.header().channels();
  for (auto c = channels.begin(); c != channels.end(); ++c)
    if (!wholeNumbers.empty() && std::string_view(c.name()).substr(0, wholeNumbers.size()) == wholeNumbers)
      image.words.push_back({c.name(), std::vector<uint32_t>(count)});
    else
      image.channels.push_back({c.name(), std::vector<float>(count)});
  Imf::FrameBuffer frame;
  for (ExrChannel& c : image.channels)
    frame.insert(c.name, Imf::Slice::Make(Imf::FLOAT, c.values.data(), window, sizeof(float), sizeof(float) * width));
  for (ExrWords& c : image.words)
    frame.insert(c.name,
                 Imf::Slice::Make(Imf::UINT, c.values.data(), window, sizeof(uint32_t), sizeof(uint32_t) * width));
  file.setFrameBuffer(frame);
  file.readPixels(window.min.y, window.max.y);
  image.attributes = textsOf(file.header());
  return image;
} catch (const Iex::BaseExc& e) {
  throw unreadable(path, e);
}

std::vector<std::pair<std::string, std::string>> readExrAttributes(const std::filesystem::path& path) try {
  return textsOf(Imf::InputFile(path.c_str()).header());
} catch (const Iex::BaseExc& e) {
  throw unreadable(path, e);
}

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
