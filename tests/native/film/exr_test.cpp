// SPDX-License-Identifier: GPL-3.0-or-later
// Files as another program reads them (OpenEXR's own reader), and what is left when writing fails.
#include "film/exr.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <csignal>
#include <cstdint>
#include <fstream>
#include <limits>

#include "film/write_file.h"
#include "math/error.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;
namespace fs = std::filesystem;

class ExrFiles : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("wardmis film " + std::to_string(getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::vector<std::string> files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
    std::sort(names.begin(), names.end());
    return names;
  }
  fs::path folder_;
};

ExrImage image(int width, int height) {
  Random random(3);
  ExrImage e{width,
             height,
             {},
             {{"wardmis:seed", "18446744073709551615"}, {"wardmis:scene", "line\nbreak, \"quotes\" and \xc3\xa9"}}};
  for (const char* name : {"View Layer.Combined.R", "View Layer.Combined.A", "View Layer.Depth.Z",
                           "R\xc3\xa4ume. 2.Allocation Lobe.X", "R"}) {
    ExrChannel c{name, {}};
    for (int i = 0; i < width * height; ++i)
      c.values.push_back(std::bit_cast<float>(static_cast<uint32_t>(random.uniform() * 0x1p32)));
    e.channels.push_back(std::move(c));
  }
  std::vector<float>& v = e.channels[0].values;
  const float special[] = {0.0f,
                           -0.0f,
                           1e-45f,
                           std::numeric_limits<float>::infinity(),
                           -std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN(),
                           std::numeric_limits<float>::max()};
  std::copy_n(special, std::min(v.size(), std::size(special)), v.begin());
  return e;
}

void expectSame(const fs::path& path, const ExrImage& e) {
  Imf::InputFile file(path.c_str());
  const Imf::Header& header = file.header();
  EXPECT_EQ(header.dataWindow().min, Imath::V2i(0, 0));
  EXPECT_EQ(header.dataWindow().max, Imath::V2i(e.width - 1, e.height - 1));
  EXPECT_EQ(header.displayWindow(), header.dataWindow());
  size_t channels = 0;
  for (auto c = header.channels().begin(); c != header.channels().end(); ++c) ++channels;
  EXPECT_EQ(channels, e.channels.size());
  for (const auto& [name, value] : e.attributes) {
    const auto* attribute = header.findTypedAttribute<Imf::StringAttribute>(name);
    ASSERT_NE(attribute, nullptr) << name;
    EXPECT_EQ(attribute->value(), value);
  }
  for (const ExrChannel& c : e.channels) {
    ASSERT_NE(header.channels().findChannel(c.name), nullptr) << c.name;
    EXPECT_EQ(header.channels().findChannel(c.name)->type, Imf::FLOAT);
    std::vector<float> read(c.values.size());
    Imf::FrameBuffer frame;
    frame.insert(c.name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(read.data()), sizeof(float),
                                    sizeof(float) * static_cast<size_t>(e.width)));
    file.setFrameBuffer(frame);
    file.readPixels(0, e.height - 1);
    for (size_t i = 0; i < read.size(); ++i)
      ASSERT_EQ(std::bit_cast<uint32_t>(read[i]), std::bit_cast<uint32_t>(c.values[i]))
          << c.name << " " << i;  // NaN too
  }
}

TEST_F(ExrFiles, RoundTrip) {
  for (bool compress : {true, false})
    for (auto [width, height] : {std::pair(1, 1), std::pair(37, 19), std::pair(64, 33)}) {
      const ExrImage e = image(width, height);
      writeExr(folder_ / "image.exr", e, compress);
      expectSame(folder_ / "image.exr", e);
    }
  EXPECT_EQ(files(), std::vector<std::string>{"image.exr"});  // and nothing temporary
}

// Row 0 is the top one, as in the file.
TEST_F(ExrFiles, RowsAndCompression) {
  ExrImage e{2, 2, {{"Y", {1, 2, 3, 4}}}, {}};
  writeExr(folder_ / "a.exr", e, true);
  Imf::InputFile file((folder_ / "a.exr").c_str());
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  float row[2];
  Imf::FrameBuffer frame;
  frame.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(row), sizeof(float), 0));
  file.setFrameBuffer(frame);
  file.readPixels(0);
  EXPECT_EQ(row[0], 1);
  EXPECT_EQ(row[1], 2);
  writeExr(folder_ / "a.exr", e, false);
  EXPECT_EQ(Imf::InputFile((folder_ / "a.exr").c_str()).header().compression(), Imf::NO_COMPRESSION);
}

// The message names the file and the reason.
void expectFails(const fs::path& path, const ExrImage& e, const char* reason) {
  try {
    writeExr(path, e, false);
    ADD_FAILURE() << path << " was written";
  } catch (const Error& error) {
    EXPECT_EQ(error.code, ExitCode::kFile);
    EXPECT_NE(std::string(error.what()).find(path.string()), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
}

TEST_F(ExrFiles, FoldersThatCannotBeWritten) {
  expectFails(folder_ / "none" / "a.exr", image(2, 2), "No such file or directory");
  std::ofstream(folder_ / "file") << "x";
  expectFails(folder_ / "file" / "a.exr", image(2, 2), "Not a directory");
  if (fs::exists("/proc/self")) expectFails("/proc/self/a.exr", image(2, 2), "cannot be created");
  EXPECT_EQ(files(), std::vector<std::string>{"file"});
}

// The last step fails: no temporary file stays behind.
TEST_F(ExrFiles, TargetIsAFolder) {
  fs::create_directories(folder_ / "a.exr" / "full");
  expectFails(folder_ / "a.exr", image(2, 2), "cannot be renamed into place");
  EXPECT_EQ(files(), std::vector<std::string>{"a.exr"});
  EXPECT_TRUE(fs::is_directory(folder_ / "a.exr"));
}

// A disk that fills up, by the process's own limit on file sizes: nothing new is left, and what was there stays whole.
TEST_F(ExrFiles, DiskFull) {
  const ExrImage before = image(4, 4), after = image(128, 128);
  writeExr(folder_ / "old.exr", before, false);
  rlimit whole{};
  getrlimit(RLIMIT_FSIZE, &whole);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);  // write() then fails with EFBIG
  const rlimit small{10000, whole.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  expectFails(folder_ / "old.exr", after, "cannot be written: File too large");
  expectFails(folder_ / "new.exr", after, "cannot be written: File too large");
  setrlimit(RLIMIT_FSIZE, &whole);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(files(), std::vector<std::string>{"old.exr"});
  expectSame(folder_ / "old.exr", before);
  writeExr(folder_ / "old.exr", after, false);  // and it is replaced as soon as it can be
  expectSame(folder_ / "old.exr", after);
}

TEST_F(ExrFiles, WhatCannotBeEncoded) {
  expectFails(folder_ / "a.exr", {0, 0, {{"R", {}}}, {}}, "cannot be encoded as OpenEXR");
  // an attribute that has a meaning and a type of its own
  expectFails(folder_ / "a.exr", {1, 1, {{"R", {1}}}, {{"dataWindow", "x"}}}, "cannot be encoded as OpenEXR");
  EXPECT_TRUE(files().empty());
}

TEST_F(ExrFiles, WriteFileKeepsBytes) {
  const std::string bytes("a\0b\n\xff", 5);
  for (const std::string& content : {bytes, std::string(), std::string(1 << 20, 'x')}) {
    writeFile(folder_ / "data", content);
    std::ifstream in(folder_ / "data", std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), content);
  }
  EXPECT_EQ(files(), std::vector<std::string>{"data"});
}

}  // namespace
}  // namespace wardmis
