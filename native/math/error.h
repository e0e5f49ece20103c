// SPDX-License-Identifier: GPL-3.0-or-later
// The one exception type. Thrown where something is wrong, caught once, in the command's main().
#pragma once

#include <stdexcept>
#include <string>

namespace wardmis {

// The process's exit codes; docs/command.md.
enum class ExitCode : int {
  kDone = 0,
  kCheckFailed = 1,
  kUsage = 2,
  kScene = 3,  // the scene cannot be read
  kFile = 4,   // reading or writing a file failed
  kMemory = 5,
  kCancelled = 130,
};

// what(): what was found, where (file, node, object), what was expected; hint: what to do.
class Error : public std::runtime_error {
 public:
  Error(ExitCode exitCode, const std::string& what, std::string whatToDo = {})
      : std::runtime_error(what), code(exitCode), hint(std::move(whatToDo)) {}
  ExitCode code;
  std::string hint;
};

}  // namespace wardmis
