// SPDX-License-Identifier: GPL-3.0-or-later
// What the tests of the reader share: scenes read from memory, the errors that they end in, folders of their own.
#pragma once

#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>

#include "glb_builder.h"
#include "gltf/reader.h"
#include "math/error.h"

namespace wardmis::test {

namespace fs = std::filesystem;

inline Scene read(const Bytes& bytes, const fs::path& folder = {}) { return readGlb(bytes, folder, "scene.glb"); }
inline Scene read(const GlbBuilder& b) { return read(b.bytes()); }

// The message of the Error that reading must end in, with what the hint adds.
inline std::string errorOf(const std::function<void()>& f, ExitCode code = ExitCode::kScene) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, code) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}
inline std::string errorOf(const GlbBuilder& b) {
  return errorOf([&] { read(b); });
}
inline void expectHas(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << text << "' lacks '" << part << "'";
}
inline bool listHas(const std::vector<std::string>& list, const std::string& part) {
  return std::any_of(list.begin(), list.end(), [&](const auto& s) { return s.find(part) != s.npos; });
}
inline void expectNear(Vec3f a, Vec3f b, float tolerance = 1e-6f) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

struct TemporaryFolder {
  fs::path path = fs::temp_directory_path() / ("wardmis_glb_test_" + std::to_string(getpid()));
  TemporaryFolder() { fs::create_directories(path); }
  ~TemporaryFolder() { fs::remove_all(path); }
  fs::path write(const fs::path& name, const Bytes& bytes) const {
    fs::create_directories((path / name).parent_path());
    std::ofstream(path / name, std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return path / name;
  }
};

inline Bytes png2x1(std::vector<uint8_t> rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 2;
  image.height = 1;
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  png_image_write_to_memory(&image, nullptr, &size, 0, rgb.data(), 0, nullptr);
  Bytes out(size);
  png_image_write_to_memory(&image, out.data(), &size, 0, rgb.data(), 0, nullptr);
  out.resize(size);
  return out;
}

}  // namespace wardmis::test
