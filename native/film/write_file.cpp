// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/write_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "math/error.h"

namespace wardmis {

namespace {

// Where a chain of symbolic links ends, also where nothing is there yet.
std::filesystem::path target(std::filesystem::path path) {
  constexpr int kMostLinks = 40;  // as Linux has it
  std::error_code none;
  for (int k = 0; k < kMostLinks && std::filesystem::is_symlink(path, none); ++k)
    path = path.parent_path() / std::filesystem::read_symlink(path, none);  // one that is absolute replaces all
  return path;
}

}  // namespace

void writeFile(const std::filesystem::path& name, std::string_view bytes) {
  const std::filesystem::path path = target(name);  // the rename would replace the link
  std::filesystem::path temporary = path;
  temporary += fmt::format(".tmp{}", getpid());
  const auto fail = [&](const char* doing) {
    const int error = errno;
    unlink(temporary.c_str());
    throw Error(ExitCode::kFile, fmt::format("{}: cannot be {}: {}", path.string(), doing, std::strerror(error)),
                "check the folder, its permissions and the free space");
  };
  const int fd = open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (fd < 0) fail("created");
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int error = errno;
      close(fd);
      errno = error;
      fail("written");
    }
    done += static_cast<size_t>(n);
  }
  if (close(fd) != 0) fail("written");
  if (rename(temporary.c_str(), path.c_str()) != 0) fail("renamed into place");
}

}  // namespace wardmis
