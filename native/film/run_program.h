// SPDX-License-Identifier: GPL-3.0-or-later
// Other programs, run without a shell: no argument is ever interpreted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wardmis {

struct Finished {
  int code = 0;      // of the program's exit; 127: there is no such program; above 128: the number of a signal, and 128
  std::string said;  // on standard output and standard error
};

// Runs a program, looked up on the PATH, in `folder` (empty: here), with `input` as its standard input, and waits for
// it.
Finished runProgram(const std::vector<std::string>& arguments, const std::string& input = {},
                    const std::filesystem::path& folder = {});

}  // namespace wardmis
