// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "integrate/pilot.h"
#include "math/error.h"
#include "math/memory.h"

namespace wardmis {
namespace {

// The passes as floats, and a little for encoding them.
constexpr uint64_t kWritten = 20 * sizeof(float);

}  // namespace

uint64_t bytesPerPixel(const RenderSettings& s) {
  const uint64_t written = sizeof(Pixel) + kWritten;
  if (s.allocation == Allocation::kAuto)  // its pilot is over before there is a film
    return std::max(written, (sizeof(Pixel) + sizeof(PilotPixel) + sizeof(CandidateSums) + sizeof(PixelFractions)) /
                                 (kCoarse * kCoarse));
  if (!needsMoments(s.allocation)) return written;
  return std::max<uint64_t>(written, sizeof(Pixel) + sizeof(PilotPixel) + sizeof(HitMoments) + sizeof(PixelFractions));
}

void requireMemory(int width, int height, const RenderSettings& s) {
  const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  const double needed = double(pixels) * double(bytesPerPixel(s)), available = double(availableMemory());
  if (needed <= available) return;
  throw Error(ExitCode::kMemory,
              fmt::format("{} x {} pixels with '{}' take {:.1f} GB of memory ({} bytes each), and {:.1f} GB are free",
                          width, height, name(s.allocation), needed / 1e9, bytesPerPixel(s), available / 1e9),
              "lower the resolution, render a part of the frame, or close other programs");
}

}  // namespace wardmis
