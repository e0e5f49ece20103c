// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>

#include "math/error.h"

namespace wardmis {
namespace {

constexpr uint64_t kUnknown = uint64_t{1} << 63;

// The number behind `key` in a file of lines "key number"; the file's first number for an empty key.
uint64_t numberIn(const char* path, const std::string& key, uint64_t fallback) {
  std::ifstream in(path);
  std::string word;
  uint64_t number = 0;
  while (!key.empty() && in >> word && word != key) {
  }
  return in >> number ? number : fallback;
}

uint64_t without(uint64_t limit, uint64_t used) { return limit > used ? limit - used : 0; }

// Of the process's control group (version 2) and of all that it lies in.
uint64_t freeInGroup() {
  std::ifstream in("/proc/self/cgroup");
  uint64_t least = kUnknown;
  const auto lowerTo = [&](const std::string& folder) {
    const uint64_t limit = numberIn((folder + "/memory.max").c_str(), "", kUnknown);  // "max": none
    if (limit < kUnknown)
      least = std::min(least, without(limit, numberIn((folder + "/memory.stat").c_str(), "anon", 0)));
  };
  lowerTo("/sys/fs/cgroup");  // of a container, which sees its own as the root
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with("0::/")) continue;
    for (std::string group = line.substr(3); group.size() > 1; group.resize(group.rfind('/')))
      lowerTo("/sys/fs/cgroup" + group);
  }
  return least;
}

}  // namespace

uint64_t availableMemory() {
  constexpr uint64_t kKiB = 1024, kNone = kUnknown / kKiB;
  uint64_t bytes = kKiB * std::min(kNone, numberIn("/proc/meminfo", "MemAvailable:", kNone));
  bytes = std::min(bytes, freeInGroup());
  if (rlimit limit{}; getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    bytes = std::min<uint64_t>(bytes, without(limit.rlim_cur, kKiB * numberIn("/proc/self/status", "VmSize:", 0)));
  return bytes;
}

void requireMemory(uint64_t bytes, const std::string& what, const std::string& hint) {
  const uint64_t there = availableMemory();
  if (bytes > there)
    throw Error(
        ExitCode::kMemory,
        fmt::format("{} would need {:.1f} GB of memory, and {:.1f} GB are free", what, bytes * 1e-9, there * 1e-9),
        hint);
}

}  // namespace wardmis
