// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/session.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

namespace wardmis {
namespace {

constexpr size_t kMostLacking = 12;  // that a render warns of

std::atomic<Stop> stopRequest{Stop::kNo};
static_assert(std::atomic<Stop>::is_always_lock_free, "set from a signal handler");

std::atomic<int> lost{0};  // errno of the first write to standard output that failed

// fmt::print throws where this does not.
void write(std::FILE* file, const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size() && std::fflush(file) == 0;
  if (int none = 0; !written && file == stdout) lost.compare_exchange_strong(none, errno);
}

void onSignal(int signal) {
  // the second Ctrl-C no longer waits for the pass to end
  const bool keep = signal == SIGINT && stopRequest.load() == Stop::kNo;
  stopRequest.store(keep ? Stop::kKeep : Stop::kDiscard);
}

}  // namespace

std::atomic<Stop>& stopOnSignals(bool watchStdin) {
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  if (watchStdin)
    std::thread([] {
      char c;
      while (true) {
        const ssize_t n = read(STDIN_FILENO, &c, 1);
        if (n == 0 || (n < 0 && errno != EINTR)) break;
      }
      stopRequest.store(Stop::kDiscard);
    }).detach();
  return stopRequest;
}

void tell(const std::string& text) { write(stderr, text + '\n'); }

int outputError() {
  write(stdout, "");
  return lost;
}

Reporter::Reporter(const std::string& kind)
    : json_(kind == "json"), bar_(kind == "bar" || (kind == "auto" && isatty(STDERR_FILENO) != 0)) {}

void Reporter::event(const nlohmann::json& e) {
  if (!json_) return;
  const std::lock_guard lock(mutex_);
  write(stdout, e.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n');
}

void Reporter::warn(const std::string& message) {
  if (json_) return event({{"event", "warning"}, {"message", message}});
  clear();
  tell("wardmis: warning: " + message);
}

void Reporter::warnOfLacking(const std::vector<std::string>& lacking) {
  if (json_) return;
  const size_t told = lacking.size() <= kMostLacking ? lacking.size() : kMostLacking - 1;
  for (size_t i = 0; i < told; ++i) warn("left out: " + lacking[i]);
  if (told < lacking.size()) warn(fmt::format("left out: {} more, which wardmis info lists", lacking.size() - told));
}

void Reporter::info(const std::string& message) {
  if (json_ || !bar_) return;
  clear();
  tell(message);
}

void Reporter::bar(double fraction, const std::string& doing, double seconds, std::optional<double> left) {
  if (!bar_) return;
  constexpr int kWidth = 30;
  const int full = static_cast<int>(fraction * kWidth);
  write(stderr, fmt::format("\r[{:#<{}}{:.<{}}] {:3.0f} %  {}  {:.1f} s{}\x1b[K", "", full, "", kWidth - full,
                            100 * fraction, doing, seconds, left ? fmt::format(", {:.1f} s left", *left) : ""));
  drawn_ = true;
}

void Reporter::clear() {
  if (drawn_) write(stderr, "\r\x1b[K");
  drawn_ = false;
}

}  // namespace wardmis
