// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/texel_memory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/magic.h>
#include <sys/mman.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <mutex>
#include <thread>

#include "math/error.h"
#include "math/memory.h"

namespace wardmis {
namespace {

constexpr size_t kDefaultLimit = 1'000'000'000;
constexpr auto kWatchInterval = std::chrono::milliseconds(2);  // a thread may look at 50 MB of other pages in it

size_t limitOfEnvironment() {
  const char* const text = std::getenv("WARDMIS_TEXTURE_MEMORY");
  if (text == nullptr || *text == '\0') return kDefaultLimit;
  char* end = nullptr;
  const double megabytes = std::strtod(text, &end);
  if (*end != '\0' || !(megabytes >= 0) || !(megabytes < 1e12))
    throw Error(ExitCode::kUsage, fmt::format("WARDMIS_TEXTURE_MEMORY is '{}', not a number of MB", text),
                "give the memory that textures may take, 1000 for 1 GB, or do not set it");
  return static_cast<size_t>(megabytes * 1e6);
}

// A file without a name in a folder of a disk; -1: errno says why not.
int unnamedFile(const std::string& folder) {
  const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (file >= 0) return file;
  std::string name = folder + "/wardmis-XXXXXX";  // some file systems have no such files
  const int named = mkostemp(name.data(), O_CLOEXEC);
  if (named >= 0) unlink(name.c_str());
  return named;
}

// Files in memory, as /tmp often is, are no help.
bool isMemory(const std::string& folder) {
  struct statfs s {};
  return statfs(folder.c_str(), &s) == 0 && (s.f_type == TMPFS_MAGIC || s.f_type == RAMFS_MAGIC);
}

// Resident pages of files that are mapped, in bytes: texels', the scene's own, the program's.
size_t residentOfFiles() {
  static const int statm = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  char text[128] = {};
  if (statm < 0 || pread(statm, text, sizeof text - 1, 0) <= 0) return 0;
  unsigned long size = 0, resident = 0, files = 0;
  if (std::sscanf(text, "%lu %lu %lu", &size, &resident, &files) != 3) return 0;
  return files * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

class Store {
 public:
  void* take(size_t bytes) {
    {
      const std::lock_guard lock(mutex_);
      if (limit_ == 0) limit_ = limitOfEnvironment();
      if (memory_ + bytes <= limit_ - limit_ / kShareOfFiles) {
        memory_ += bytes;
        try {
          return takePages(bytes);
        } catch (...) {
          memory_ -= bytes;
          throw;
        }
      }
    }
    std::string problem;
    if (void* const mapped = map(bytes, problem)) return mapped;
    // beyond the limit, then, if there is room at all
    if (bytes > availableMemory())
      throw Error(
          ExitCode::kMemory,
          fmt::format("textures need {:.1f} GB more than the {:.1f} GB that they may take of the memory, and {}",
                      static_cast<double>(bytes) * 1e-9, static_cast<double>(limit_) * 1e-9, problem),
          "free some space there, or set TMPDIR to a folder with more, or give smaller images");
    void* const pages = takePages(bytes);
    const std::lock_guard lock(mutex_);
    memory_ += bytes;
    return pages;
  }

  void giveBack(void* memory, size_t bytes) {
    {
      const std::lock_guard lock(mutex_);
      if (mapped_.erase(memory) > 0) {
        files_ -= bytes;
        munmap(memory, bytes);
        return;
      }
      memory_ -= bytes;
    }
    givePagesBack(memory, bytes);
  }

  void setLimit(size_t bytes) {
    const std::lock_guard lock(mutex_);
    limit_ = bytes;
  }

  TexelUse use() {
    const std::lock_guard lock(mutex_);
    return {memory_, files_, folder_};
  }

 private:
  static constexpr size_t kShareOfFiles = 4;  // a fourth of the limit is for the files' pages

  // Null: problem says why not.
  void* map(size_t bytes, std::string& problem) {
    const char* const wanted = std::getenv("TMPDIR");
    for (const std::string& folder :
         {std::string(wanted != nullptr ? wanted : ""), std::string("/var/tmp"), std::string("/tmp")}) {
      if (folder.empty() || isMemory(folder)) continue;
      const int file = unnamedFile(folder);
      if (file < 0) continue;
      // at once, so that a full disk is no fault when a page is written
      const bool fits = posix_fallocate(file, 0, static_cast<off_t>(bytes)) == 0;
      void* const memory = fits ? mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0) : MAP_FAILED;
      close(file);
      if (memory == MAP_FAILED) {
        problem += (problem.empty() ? "there is no room for files of that size in " : ", nor in ") + folder;
        continue;
      }
      const std::lock_guard lock(mutex_);
      folder_ = folder;
      files_ += bytes;
      if (mapped_.empty()) others_ = residentOfFiles();
      mapped_[memory] = bytes;
      if (!watch_.joinable()) watch_ = std::jthread([this](const std::stop_token& stop) { watch(stop); });
      changed_.notify_all();
      trim();
      return memory;
    }
    if (problem.empty()) problem = "there is no folder for files on a disk";
    return nullptr;
  }

  // The system drops pages of files when it needs memory. That they do not count as the process's own all the same,
  // they are dropped from its map when they are many: those that are still in memory come back at a small cost.
  void watch(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (!stop.stop_requested()) {
      if (mapped_.empty())
        changed_.wait(lock, stop, [this] { return !mapped_.empty(); });
      else
        changed_.wait_for(lock, stop, kWatchInterval, [] { return false; });
      trim();
    }
  }
  void trim() {
    const size_t share = limit_ / kShareOfFiles, before = residentOfFiles();
    if (before <= others_ + share) return;
    for (const auto& [memory, bytes] : mapped_) madvise(memory, bytes, MADV_DONTNEED);
    // what is left are other files' pages, and what has been looked at since
    const size_t after = residentOfFiles();
    if (after < others_ || before < after + share / 2) others_ = after;
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  size_t limit_ = 0, memory_ = 0, files_ = 0;
  std::string folder_;
  std::map<void*, size_t> mapped_;
  size_t others_ = 0;   // resident pages of other files
  std::jthread watch_;  // last: it ends first
};

Store& store() {
  static Store theStore;
  return theStore;
}

}  // namespace

void* takeTexels(size_t bytes) { return store().take(bytes); }
void giveTexelsBack(void* memory, size_t bytes) { store().giveBack(memory, bytes); }
void setTexelLimit(size_t bytes) { store().setLimit(bytes); }
TexelUse texelUse() { return store().use(); }

std::string describe(const TexelUse& use) {
  const auto size = [](size_t bytes) {
    const double b = static_cast<double>(bytes);
    return bytes < 1'000'000'000 ? fmt::format("{:.0f} MB", b * 1e-6) : fmt::format("{:.1f} GB", b * 1e-9);
  };
  if (use.memory + use.files == 0) return {};
  std::string text = size(use.memory + use.files);
  if (use.files > 0) text += fmt::format(", {} of it in files in {}", size(use.files), use.folder);
  return text;
}

}  // namespace wardmis
