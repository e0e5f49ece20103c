// SPDX-License-Identifier: GPL-3.0-or-later
// A long run and whoever started it: what it tells them, and how they stop it.
#pragma once

#include <atomic>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "integrate/render.h"

namespace wardmis {

// From now on SIGINT asks to stop and keep what there is, a second SIGINT or SIGTERM (or, with watchStdin, the end of
// standard input: whoever started us has gone) to stop at once. A closed pipe and a limit on the size of files become
// errors of write().
std::atomic<Stop>& stopOnSignals(bool watchStdin);

// Writes a line to standard error. Whoever read it may have gone (a closed pipe, a full disk): that ends nothing, since
// a render must not be lost for want of a listener.
void tell(const std::string& text);

// Of standard output, after flushing it: the errno of the first failure so far, or 0.
int outputError();

// Progress: a bar on a terminal for people, JSON lines on standard output for a program.
class Reporter {
 public:
  explicit Reporter(const std::string& kind);  // auto, bar, json or none

  bool json() const { return json_; }
  void event(const nlohmann::json& e);    // for programs alone
  void warn(const std::string& message);  // for both
  void info(const std::string& message);  // for people who watch the bar
  // Of what a file holds and the image lacks (Scene::lacking), for people: programs have it in their events. The first
  // few, since wardmis info has them all.
  void warnOfLacking(const std::vector<std::string>& lacking);
  void bar(double fraction, const std::string& doing, double seconds, std::optional<double> left);
  void clear();  // the bar

 private:
  bool json_, bar_, drawn_ = false;
  std::mutex mutex_;
};

}  // namespace wardmis
