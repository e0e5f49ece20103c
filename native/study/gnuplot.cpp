// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/gnuplot.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "film/run_program.h"
#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {

void checkPlotName(const std::string& path) {
  if (!path.ends_with(".svg") && !path.ends_with(".png"))
    throw Error(ExitCode::kUsage, path + ": a figure is SVG or PNG", "give a name that ends in .svg or .png");
}

std::string gnuplotText(const std::string& text) {
  // within single quotes gnuplot reads all as it is; within double ones it would run what stands in backquotes
  std::string quoted = "'";
  for (char c : text) {
    if (c == '\'') quoted += c;
    quoted += c;
  }
  return quoted + "'";
}

void drawWithGnuplot(const std::string& path, int width, int height, const std::string& script) {
  checkPlotName(path);
  // gnuplot's own output is a temporary file: what it draws of a failed script must not stay
  std::string temporary = (std::filesystem::temp_directory_path() / "wardmis-plot-XXXXXX").string();
  const int fd = mkstemp(temporary.data());
  if (fd < 0) throw Error(ExitCode::kFile, temporary + ": cannot be created", "check TMPDIR and the free space");
  close(fd);
  const struct Cleaner {
    const std::string& path;
    ~Cleaner() { std::remove(path.c_str()); }
  } cleaner{temporary};
  const std::string terminal = path.ends_with(".svg") ? fmt::format("svg size {},{} background 'white'", width, height)
                                                      : fmt::format("pngcairo size {},{}", width, height);
  const Finished gnuplot = runProgram(
      {"gnuplot", "-"},
      fmt::format("set terminal {}\nset output {}\n{}\nunset output\n", terminal, gnuplotText(temporary), script));
  std::ifstream in(temporary, std::ios::binary);
  const std::string image(std::istreambuf_iterator<char>(in), {});
  if (gnuplot.code == 127)
    throw Error(ExitCode::kFile, path + ": figures need the program gnuplot, which is not found",
                "install it (gnuplot-nox on Debian and Ubuntu), or leave --plot out");
  if (gnuplot.code != 0 || image.empty())
    throw Error(ExitCode::kFile, fmt::format("{}: gnuplot failed: {}", path, gnuplot.said.substr(0, 300)), "");
  writeFile(path, image);
}

}  // namespace wardmis
