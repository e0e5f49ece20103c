// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/line_filter.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <vector>

#include "math/error.h"

namespace wardmis {

namespace {

// False when the listener has gone.
bool writeAll(int out, fmt::memory_buffer& buffer) {
  for (size_t done = 0; done < buffer.size();) {
    const ssize_t n = write(out, buffer.data() + done, buffer.size() - done);
    if (n < 0 && errno == EPIPE) return false;
    if (n < 0 && errno != EINTR)
      throw Error(ExitCode::kFile, fmt::format("the output cannot be written: {}", std::strerror(errno)),
                  "give it a place with free space");
    if (n > 0) done += static_cast<size_t>(n);
  }
  buffer.clear();
  return true;
}

}  // namespace

void filterLines(int in, int out, const LineFunction& function) {
  for (int s : {SIGPIPE, SIGXFSZ}) std::signal(s, SIG_IGN);  // write() tells
  std::vector<char> input(1 << 16);
  fmt::memory_buffer output;
  size_t held = 0;  // bytes of a line that is not complete
  uint64_t number = 0;
  const auto line = [&](std::string_view text) {
    ++number;
    try {
      if (text.size() > kMaxLine)
        throw Error(ExitCode::kUsage, fmt::format("line {}: longer than {} characters", number, kMaxLine));
      function(text, number, output);
    } catch (...) {
      writeAll(out, output);
      throw;
    }
  };
  while (true) {
    if (!writeAll(out, output)) return;
    const ssize_t n = read(in, input.data() + held, input.size() - held);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0)
      throw Error(ExitCode::kFile, fmt::format("the input cannot be read: {}", std::strerror(errno)),
                  "give a file with a line for each pair of directions");
    if (n == 0) break;
    std::string_view rest(input.data(), held + static_cast<size_t>(n));
    for (size_t end; (end = rest.find('\n')) != std::string_view::npos; rest.remove_prefix(end + 1))
      line(rest.substr(0, end));
    if (rest.size() > kMaxLine) line(rest);  // refused
    held = rest.size();
    std::memmove(input.data(), rest.data(), held);
  }
  if (held > 0) line({input.data(), held});
  writeAll(out, output);
}

}  // namespace wardmis
