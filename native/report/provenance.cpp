// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "gltf/file.h"
#include "math/clones.h"
#include "math/hash.h"

namespace wardmis {
namespace {

std::string cpuName() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string systemName() {
  std::string distribution;
  std::ifstream in("/etc/os-release");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("PRETTY_NAME=")) distribution = line.substr(13, line.size() - 14);
  utsname name{};
  uname(&name);
  return fmt::format("{}{}{} {} {}", distribution, distribution.empty() ? "" : ", ", name.sysname, name.release,
                     name.machine);
}

}  // namespace

nlohmann::json machineJson() {
  return {{"version", WARDMIS_VERSION},
#ifdef __clang__
          {"compiler", "Clang " __clang_version__},
#else
          {"compiler", "GCC " __VERSION__},
#endif
          {"flags", WARDMIS_FLAGS},
          {"cpu", cpuName()},
          {"isa", clonedFor()},
          {"cores", std::thread::hardware_concurrency()},
          {"system", systemName()}};
}

std::string timestamp() { return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))); }

double loadAverage() {
  double load[1] = {0};
  return getloadavg(load, 1) == 1 ? load[0] : 0;
}

double calibrate() {
  const auto start = std::chrono::steady_clock::now();
  volatile uint64_t sink = 0;
  uint64_t x = 1;
  for (int i = 0; i < 4'000'000; ++i) x = x * 6364136223846793005ULL + 1442695040888963407ULL;
  sink = x;
  (void)sink;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string hashOf(std::span<const std::filesystem::path> files) {
  Fnv1a hash;
  for (size_t i = 0; i < files.size(); ++i) {
    std::error_code error;
    if (i > 0 && !std::filesystem::is_regular_file(files[i], error)) {
      hash.add(1);
      continue;
    }
    const Bytes bytes = mapFile(files[i]);
    for (int k = 0; i > 0 && k < 8; ++k) hash.add(bytes.size() >> (8 * k) & 0xFF);
    for (const auto byte : bytes.data) hash.add(static_cast<uint8_t>(byte));
  }
  return fmt::format("{:016x}", hash.value());
}

}  // namespace wardmis
