// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/run_program.h"

#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX asks for it

namespace wardmis {
namespace {

constexpr int kNotFound = 127, kSignal = 128;

// posix_spawn's list of what the child does before it is the program.
struct Actions {
  posix_spawn_file_actions_t list{};
  Actions() { posix_spawn_file_actions_init(&list); }
  ~Actions() { posix_spawn_file_actions_destroy(&list); }
  Actions(const Actions&) = delete;
  Actions& operator=(const Actions&) = delete;
};

// A file that nobody else sees, with `text` in it, to be read from its start.
std::unique_ptr<FILE, int (*)(FILE*)> fileOf(const std::string& text) {
  std::unique_ptr<FILE, int (*)(FILE*)> file(std::tmpfile(), std::fclose);
  if (file && std::fwrite(text.data(), 1, text.size(), file.get()) == text.size() && std::fflush(file.get()) == 0)
    std::rewind(file.get());
  return file;
}

}  // namespace

Finished runProgram(const std::vector<std::string>& arguments, const std::string& input,
                    const std::filesystem::path& folder) {
  const auto in = fileOf(input);
  std::array<int, 2> out{};
  if (!in || pipe(out.data()) != 0) return {kNotFound, "no file or pipe can be opened for it"};
  Actions actions;
  posix_spawn_file_actions_adddup2(&actions.list, fileno(in.get()), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions.list, out[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions.list, out[1], STDERR_FILENO);
  posix_spawn_file_actions_addclose(&actions.list, out[0]);
  posix_spawn_file_actions_addclose(&actions.list, out[1]);
  if (!folder.empty()) posix_spawn_file_actions_addchdir_np(&actions.list, folder.c_str());

  std::vector<char*> words;
  words.reserve(arguments.size() + 1);
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));  // NOLINT
  words.push_back(nullptr);
  pid_t child = 0;
  const bool started = posix_spawnp(&child, words[0], &actions.list, nullptr, words.data(), environ) == 0;
  close(out[1]);
  Finished finished;
  std::array<char, 4096> buffer{};
  for (ssize_t n; started && ((n = read(out[0], buffer.data(), buffer.size())) > 0 || (n < 0 && errno == EINTR));)
    if (n > 0) finished.said.append(buffer.data(), static_cast<size_t>(n));
  close(out[0]);
  if (!started) return {kNotFound, {}};
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  finished.code = WIFEXITED(status) ? WEXITSTATUS(status) : kSignal + WTERMSIG(status);
  return finished;
}

}  // namespace wardmis
