// SPDX-License-Identifier: GPL-3.0-or-later
// Multi-layer OpenEXR files: written complete or not at all.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace wardmis {

struct ExrChannel {
  std::string name;           // "<layer>.<pass>.<channel>"
  std::vector<float> values;  // width * height, row 0 is the top row
};

// A channel of whole numbers.
struct ExrWords {
  std::string name;
  std::vector<uint32_t> values;  // as above
};

struct ExrImage {
  int width = 0, height = 0;
  std::vector<ExrChannel> channels;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<ExrWords> words = {};

  // nullptr if there is no such channel.
  const std::vector<float>* channel(const std::string& name) const {
    for (const ExrChannel& c : channels)
      if (c.name == name) return &c.values;
    return nullptr;
  }
};

// Writes under a temporary name beside `path`, then renames. compress: lossless ZIP, else none.
// Throws Error(kFile); then no file of either name is left.
void writeExr(const std::filesystem::path& path, const ExrImage& image, bool compress);

// All channels of the first part, as floats; those whose name begins so, where it is given, as whole numbers. Throws
// Error(kFile).
ExrImage readExr(const std::filesystem::path& path, const std::string& wholeNumbers = "");

// The text attributes of its header alone. Throws Error(kFile).
std::vector<std::pair<std::string, std::string>> readExrAttributes(const std::filesystem::path& path);

}  // namespace wardmis
