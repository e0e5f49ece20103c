// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/gnuplot.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {

void checkPlotName(const std::string& path) {
  if (!path.ends_with(".svg") && !path.ends_with(".png"))
    throw Error(ExitCode::kUsage, path + ": a figure is SVG or PNG", "give a name that ends in .svg or .png");
}

std::string gnuplotText(const std::string& text) {
  std::string quoted = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += c;
  }
  return quoted + '"';
}

void drawWithGnuplot(const std::string& path, int width, int height, const std::string& script) {
  checkPlotName(path);
  // gnuplot's own output is a temporary file: what it draws of a failed script must not stay
  std::string temporary = (std::filesystem::temp_directory_path() / "wardmis-plot-XXXXXX").string();
  const int fd = mkstemp(temporary.data());
  if (fd < 0) throw Error(ExitCode::kFile, temporary + ": cannot be created", "check TMPDIR and the free space");
  close(fd);
  const std::string messages = temporary + ".log";
  const struct Cleaner {
    const std::string &a, &b;
    ~Cleaner() { std::remove(a.c_str()), std::remove(b.c_str()); }
  } cleaner{temporary, messages};
  const std::string terminal = path.ends_with(".svg") ? fmt::format("svg size {},{} background 'white'", width, height)
                                                      : fmt::format("pngcairo size {},{}", width, height);
  std::signal(SIGPIPE, SIG_IGN);  // a gnuplot that ends early is told by its exit code
  FILE* pipe = popen(fmt::format("gnuplot - >'{}' 2>&1", messages).c_str(), "w");
  if (pipe == nullptr) throw Error(ExitCode::kFile, "no process for gnuplot", "close other programs");
  const std::string commands =
      fmt::format("set terminal {}\nset output '{}'\n{}\nunset output\n", terminal, temporary, script);
  std::fwrite(commands.data(), 1, commands.size(), pipe);  // one that is not there does not read them: told below
  const int status = pclose(pipe);
  const auto read = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string said = read(messages), image = read(temporary);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
    throw Error(ExitCode::kFile, path + ": figures need the program gnuplot, which is not found",
                "install it (gnuplot-nox on Debian and Ubuntu), or leave --plot out");
  if (status != 0 || image.empty())
    throw Error(ExitCode::kFile, fmt::format("{}: gnuplot failed: {}", path, said.substr(0, 300)), "");
  writeFile(path, image);
}

}  // namespace wardmis
