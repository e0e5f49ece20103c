// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/paths.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "math/error.h"

namespace wardmis {

namespace fs = std::filesystem;

void checkWritable(const std::string& path) {
  const fs::path folder = fs::absolute(path).parent_path();
  if (!fs::is_directory(folder))
    throw Error(ExitCode::kFile, fmt::format("{}: its folder does not exist", path),
                "make the folder, or choose another one");
  if (fs::is_directory(path)) throw Error(ExitCode::kFile, fmt::format("{}: is a folder", path), "name a file in it");
  if (fs::exists(path) && !fs::is_regular_file(path))  // /dev/null would be replaced
    throw Error(ExitCode::kFile, fmt::format("{}: is a device, not a file", path), "name a file");
  // By doing it: access() grants root what some file systems then refuse.
  const std::string probe = (folder / fmt::format(".wardmis-{}", getpid())).string();
  const int fd = open(probe.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0)
    throw Error(ExitCode::kFile, fmt::format("{}: its folder is not writable: {}", path, std::strerror(errno)),
                "check its permissions, or choose another one");
  close(fd);
  unlink(probe.c_str());
}

void checkNamedExr(const std::string& path) {
  std::string extension = fs::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension != ".exr")
    throw Error(ExitCode::kUsage, fmt::format("{}: the image is an OpenEXR", path), "give a name that ends in .exr");
}

void checkDistinct(std::initializer_list<NamedFile> files) {
  for (const NamedFile* a = files.begin(); a != files.end(); ++a)
    for (const NamedFile* b = a + 1; b != files.end(); ++b)
      if (!a->path.empty() && !b->path.empty() && fs::weakly_canonical(a->path) == fs::weakly_canonical(b->path))
        throw Error(ExitCode::kUsage, fmt::format("{}: is named by both {} and {}", b->path, a->option, b->option),
                    "give each a file of its own");
}

}  // namespace wardmis
