// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/session.h"
#include "cli/verbs.h"
#include "math/error.h"
#include "world/accel.h"

namespace {

// Standard error for people; with --progress json also an event for the program that started us.
int fail(bool json, wardmis::ExitCode code, const std::string& what, const std::string& hint) {
  const std::string message = hint.empty() ? what : what + "; " + hint;
  wardmis::tell("wardmis: error: " + message);
  if (json)
    std::puts(nlohmann::json{{"event", "error"}, {"code", static_cast<int>(code)}, {"message", message}}
                  .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
                  .c_str());
  std::fflush(stdout);
  return static_cast<int>(code);
}

// What the parser found wrong, where its own words do not say it.
std::string complaint(const CLI::App& app, const CLI::ParseError& e, int argc, char** argv) {
  if (app.get_subcommands().empty()) {  // whatever else may be wrong
    std::string verbs;
    for (const CLI::App* verb : app.get_subcommands(nullptr)) verbs += (verbs.empty() ? "" : ", ") + verb->get_name();
    const bool tried = argc > 1 && argv[1][0] != '-';
    return fmt::format("{}; there are: {}", tried ? fmt::format("there is no verb '{}'", argv[1]) : "a verb is missing",
                       verbs);
  }
  const std::string what = e.what(), option = what.substr(0, what.find(':'));
  return what.find("At Most 1 required") == what.npos ? what : option + " is given more than once";
}

}  // namespace

int main(int argc, char** argv) {
  using wardmis::ExitCode;
  CLI::App app{
      "WardMIS: the Ward BRDF under multiple importance sampling, with the samples shared between techniques in "
      "several ways.",
      "wardmis"};
  app.set_version_flag("--version", fmt::format("wardmis {} ({})", WARDMIS_VERSION, wardmis::Accel::libraryVersion()));
  app.require_subcommand(1);
  app.failure_message(CLI::FailureMessage::help);

  const auto add = [&](const char* name, const char* what, wardmis::Verb (*options)(CLI::App&)) {
    CLI::App* sub = app.add_subcommand(name, what);
    wardmis::Verb run = options(*sub);
    for (CLI::Option* option : sub->get_options())  // CLI11 reads nothing as the number 0
      if (option->get_items_expected_max() > 0) option->check(wardmis::notEmpty());
    return std::pair{sub, run};
  };
  const std::pair<CLI::App*, wardmis::Verb> verbs[] = {
      add("render", "render a scene to a multi-layer EXR", wardmis::addRender),
      add("info", "what a scene holds, needs, and leaves out", wardmis::addInfo),
      add("compare", "the error of an image against a reference", wardmis::addCompare),
      add("merge", "add the samples of parts of an image, rendered apart", wardmis::addMerge),
      add("converge", "error against run time of several configurations: a report", wardmis::addConverge),
      add("study", "the paper's estimators at one shading point: exactly, and by trials", wardmis::addStudy),
      add("stability", "stiff and extreme cases of the numbers, each judged by stated thresholds",
          wardmis::addStability),
      add("eval", "f, pdf, log pdf and sampling weight of a BRDF, a line each", wardmis::addEval),
  };

  bool json = false;
  for (int i = 1; i + 1 < argc; ++i)
    json |= std::string_view(argv[i]) == "--progress" && std::string_view(argv[i + 1]) == "json";
  try {
    app.parse(argc, argv);
    for (const auto& [sub, run] : verbs)
      if (sub->parsed()) {
        const int code = run();
        const int lost = wardmis::outputError();
        if (lost != 0 && lost != EPIPE)  // a reader that has gone wants no more
          throw wardmis::Error(ExitCode::kFile, fmt::format("standard output: {}", std::strerror(lost)),
                               "what was printed is not whole");
        return code;
      }
    return static_cast<int>(ExitCode::kUsage);
  } catch (const CLI::Success& e) {  // --help, --version
    return app.exit(e);
  } catch (const CLI::ParseError& e) {
    const auto subs = app.get_subcommands();
    return fail(json, ExitCode::kUsage, complaint(app, e, argc, argv),
                fmt::format("see 'wardmis {}--help'", subs.empty() ? "" : subs.front()->get_name() + " "));
  } catch (const wardmis::Error& e) {
    return fail(json, e.code, e.what(), e.hint);
  } catch (const std::bad_alloc&) {
    return fail(json, ExitCode::kMemory, "out of memory",
                "close other programs, or ask for less: a lower resolution, a simpler scene, fewer samples");
  } catch (const std::exception& e) {
    return fail(json, ExitCode::kFile, e.what(), "");
  }
}
