// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#include <limits>
#include <string>

#include "integrate/pilot.h"
#include "math/error.h"

namespace wardmis {
namespace {

constexpr uint64_t kUnlimited = std::numeric_limits<uint64_t>::max();

// The passes as floats, and a little for encoding them.
constexpr uint64_t kWritten = 20 * sizeof(float);

// The number in a file of one, "max" being no limit.
uint64_t numberIn(const std::string& path) {
  std::ifstream in(path);
  uint64_t value = 0;
  return in >> value ? value : kUnlimited;
}

uint64_t freeInMachine() {
  std::ifstream in("/proc/meminfo");
  for (std::string key, rest; in >> key; std::getline(in, rest)) {
    uint64_t kilobytes = 0;
    if (key == "MemAvailable:" && in >> kilobytes) return kilobytes * 1024;
  }
  return kUnlimited;
}

uint64_t freeInGroup() {
  std::ifstream in("/proc/self/cgroup");
  uint64_t least = kUnlimited;
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::string group = line.substr(3); group.size() > 1; group.resize(group.rfind('/'))) {
      const std::string folder = "/sys/fs/cgroup" + group;
      const uint64_t most = numberIn(folder + "/memory.max"), used = numberIn(folder + "/memory.current");
      if (most != kUnlimited && used != kUnlimited) least = std::min(least, most - std::min(most, used));
    }
  }
  return least;
}

uint64_t freeInProcess() {
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kUnlimited;
  const uint64_t pages = numberIn("/proc/self/statm");
  const uint64_t used = pages == kUnlimited ? 0 : pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return limit.rlim_cur - std::min<uint64_t>(limit.rlim_cur, used);
}

}  // namespace

uint64_t bytesPerPixel(const RenderSettings& s) {
  const uint64_t written = sizeof(Pixel) + kWritten;
  if (s.allocation == Allocation::kAuto)  // its pilot is over before there is a film
    return std::max(written, (sizeof(Pixel) + sizeof(PilotPixel) + sizeof(CandidateSums) + sizeof(PixelFractions)) /
                                 (kCoarse * kCoarse));
  if (!needsMoments(s.allocation)) return written;
  return std::max<uint64_t>(written, sizeof(Pixel) + sizeof(PilotPixel) + sizeof(HitMoments) + sizeof(PixelFractions));
}

uint64_t freeMemory() { return std::min({freeInMachine(), freeInGroup(), freeInProcess()}); }

void requireMemory(int width, int height, const RenderSettings& s) {
  const uint64_t pixels = static_cast<uint64_t>(width) * static_cast<uint64_t>(height);
  const double needed = double(pixels) * double(bytesPerPixel(s)), available = double(freeMemory());
  if (needed <= available) return;
  throw Error(ExitCode::kMemory,
              fmt::format("{} x {} pixels with '{}' take {:.1f} GB of memory ({} bytes each), and {:.1f} GB are free",
                          width, height, name(s.allocation), needed / 1e9, bytesPerPixel(s), available / 1e9),
              "lower the resolution, render a part of the frame, or close other programs");
}

}  // namespace wardmis
