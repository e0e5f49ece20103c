// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/paths.h"
#include "cli/verbs.h"
#include "math/error.h"
#include "study/gnuplot.h"
#include "study/stability_lobes.h"

namespace wardmis {

namespace {

struct Options {
  StabilitySettings settings;
  std::vector<std::string> variants{"ward", "ward-dur", "ward-gmd"};
  std::string plot;
  bool json = false;
};

int run(Options& o) {
  if (!o.plot.empty()) checkPlotName(o.plot), checkWritable(o.plot);
  o.settings.variants.clear();
  for (StudyBrdf b : {StudyBrdf::kWard, StudyBrdf::kWardDur, StudyBrdf::kWardGmd})
    if (std::find(o.variants.begin(), o.variants.end(), name(b)) != o.variants.end()) o.settings.variants.push_back(b);
  if (o.settings.variants.size() < o.variants.size())
    throw Error(ExitCode::kUsage, "--variants names one twice", "name each variant once");
  const StabilityReport report = runStability(stabilityGrid(o.settings), o.settings);
  const auto lobes = runLobeStability({o.settings.thorough, o.settings.seed, o.settings.threads});
  const bool pass = report.pass() && std::ranges::all_of(lobes, &LobeStability::pass);
  if (!o.plot.empty()) plotStability(report, o.plot);
  if (o.json) {
    nlohmann::json all = stabilityJson(report);
    all["lobes"] = lobeStabilityJson(lobes), all["pass"] = pass;
    fmt::print("{}\n", all.dump(2));
  } else {
    fmt::print("{}\n{}", stabilityTable(report), lobeStabilityTable(lobes));
  }
  return static_cast<int>(pass ? ExitCode::kDone : ExitCode::kCheckFailed);
}

}  // namespace

Verb addStability(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.footer("Exit code 1 where a check fails. docs/theory.md says what is checked, and against which thresholds.");
  app.add_option("--variants", o->variants, "of ward, ward-dur, ward-gmd, with commas")
      ->delimiter(',')
      ->check(CLI::IsMember({"ward", "ward-dur", "ward-gmd"}))
      ->default_str("ward,ward-dur,ward-gmd");
  app.add_flag("--thorough", o->settings.thorough, "ten times the work: a finer grid, more trials");
  app.add_option("--seed", o->settings.seed, "another seed, other samples")
      ->check(wholeNumber())
      ->capture_default_str();
  app.add_option("--threads", o->settings.threads, "0: all; the numbers do not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_flag("--json", o->json, "everything that was measured, as one object");
  app.add_option("--plot", o->plot, "draw heat maps over alpha and theta_o, as .svg or .png (needs gnuplot)");
  return [o] { return run(*o); };
}

}  // namespace wardmis
