// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/difference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "film/exr.h"
#include "film/write_file.h"
#include "image/oiio.h"
#include "math/error.h"
#include "report/metrics.h"

namespace wardmis {
namespace {

constexpr const char* kNameAnExr = "name an .exr for the errors as they are";

// What a function of the module says is wrong.
void check(const std::filesystem::path& path, const char* wrong) {
  if (wrong) throw Error(ExitCode::kFile, fmt::format("{}: cannot be drawn: {}", path.string(), wrong), kNameAnExr);
}

}  // namespace

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
