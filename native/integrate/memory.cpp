// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "film/error_estimate.h"
#include "film/film.h"
#include "film/pixel_shares.h"
#include "integrate/light_paths.h"
#include "integrate/pilot.h"
#include "math/error.h"
#include "math/memory.h"

namespace wardmis {
namespace {

// The passes as floats, and a little for encoding them.
template <size_t K>
constexpr uint64_t kWritten = (17 + K) * sizeof(float);

constexpr uint64_t kDataWritten = 14 * sizeof(float), kLightWritten = 27 * sizeof(float);

template <size_t K>
uint64_t bytesPerPixelWith(const RenderSettings& s, bool catchers) {
  constexpr uint64_t kFilm = sizeof(Pixel) + K * sizeof(uint32_t);
  const uint64_t kept =
      kFilm + (catchers ? sizeof(CatcherPixel) : 0) + (s.targetError > 0 ? ErrorEstimate::kBytesPerPixel : 0);
  const uint64_t sums = kept + (s.bidirectional() ? sizeof(Rgb) : 0) + (s.data ? sizeof(DataPixel) : 0) +
                        (s.light ? sizeof(LightPixel) : 0);
  const uint64_t written = sums + kWritten<K> + (s.data ? kDataWritten : 0) + (s.light ? kLightWritten : 0) +
                           (s.part ? sums : 0);  // a part has its sums in the file, too
  const uint64_t most = std::max(written, s.sharesPixels() ? sums + PixelSurvey::kBytesPerPixel : 0);
  if (s.allocation == Allocation::kAuto)  // its pilot is over before there is a film
    return std::max(most, (kFilm + sizeof(PilotPixel) + sizeof(CandidateSums<K>) + sizeof(PixelFractions<K>)) /
                              (kCoarse * kCoarse));
  if (!needsMoments(s.allocation)) return most;
  return std::max<uint64_t>(most, kept + sizeof(PilotPixel) + sizeof(HitMoments<K>) + sizeof(PixelFractions<K>));
}

// Of the paths from the lights whose vertices are kept, whatever the image.
uint64_t bytesOfLightPaths(const RenderSettings& s) {
  constexpr int kUsual = 8;  // vertices of a path are seldom more, in mean
  if (!s.bidirectional()) return 0;
  return 2 * uint64_t{kMostKeptPaths} * static_cast<uint64_t>(std::min(s.maxDepth, kUsual)) *
         (sizeof(LightVertex) + sizeof(LightSketch));
}

}  // namespace

uint64_t bytesPerPixel(const RenderSettings& s, size_t lobes, bool catchers) {
  return withTechniques(lobes, [&](auto k) { return bytesPerPixelWith<k()>(s, catchers); });
}

void requireMemory(int width, int height, const RenderSettings& s, size_t lobes, bool catchers) {
  const uint64_t each = bytesPerPixel(s, lobes, catchers);
  const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  const double needed = double(pixels) * double(each) + double(bytesOfLightPaths(s)),
               available = double(availableMemory());
  if (needed <= available) return;
  throw Error(ExitCode::kMemory,
              fmt::format("{} x {} pixels with '{}' take {:.1f} GB of memory ({} bytes each), and {:.1f} GB are free",
                          width, height, name(s.allocation), needed / 1e9, each, available / 1e9),
              "lower the resolution, render a part of the frame, or close other programs");
}

}  // namespace wardmis
