// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/flip.h"

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <regex>

#include "film/exr.h"
#include "film/run_program.h"

namespace wardmis {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const RgbImage& image) {
  ExrImage exr{image.width, image.height, {}, {}};
  for (size_t c = 0; c < 3; ++c) {
    exr.channels.push_back({std::string(1, "RGB"[c]), std::vector<float>(image.pixels())});
    for (size_t i = 0; i < image.pixels(); ++i) exr.channels.back().values[i] = image.rgb[3 * i + c];
  }
  writeExr(path, exr, false);
}

}  // namespace

bool flipInstalled() {
  static const bool installed = runProgram({"flip", "--help"}).said.find("--reference") != std::string::npos;
  return installed;
}

std::optional<double> flipError(const RgbImage& image, const RgbImage& reference) {
  if (!flipInstalled()) return {};
  std::string folder = (fs::temp_directory_path() / "wardmis-flip-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) return {};
  const struct Cleaner {
    const fs::path path;
    ~Cleaner() {
      std::error_code ignored;
      fs::remove_all(path, ignored);
    }
  } cleaner{folder};
  write(cleaner.path / "r.exr", reference);
  write(cleaner.path / "t.exr", image);
  const std::string said =
      runProgram({"flip", "-r", "r.exr", "-t", "t.exr", "-v", "1", "-nexm", "-nerm"}, {}, cleaner.path).said;
  std::smatch mean;
  if (!std::regex_search(said, mean, std::regex("Mean: *([0-9.eE+-]+)"))) return {};
  return std::atof(mean[1].str().c_str());
}

}  // namespace wardmis
