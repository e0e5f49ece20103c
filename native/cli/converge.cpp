// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/converge.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/paths.h"
#include "cli/session.h"
#include "cli/settings.h"
#include "cli/verbs.h"
#include "gltf/reader.h"
#include "integrate/setup.h"
#include "math/error.h"
#include "report/page.h"
#include "scene/defaults.h"

namespace wardmis {
namespace {

using nlohmann::json;

struct Options {
  std::string scene, folder, baseline, reference, title, resolution, progress = "auto";
  std::vector<std::string> specs{"equal", "variance", "second-moment", "auto"}, external;
  SettingOptions settings{PixelSamples::kEven};  // allocations are compared at equal samples
  size_t seeds = 16;
  uint64_t seed = 1;
  uint32_t maxSpp = 64;
  double budget = 0, referenceTime = 0, target = 0;
  int threads = 0;
  bool watchStdin = false, check = false, noDefaults = false;
};

// As a shell takes it.
std::string shellQuoted(const std::string& word) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=:,./+";
  if (!word.empty() && word.find_first_not_of(kPlain) == word.npos) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? "'\\''" : std::string(1, c);
  return out + "'";
}

// Of "ALLOCATION", or "NAME:key=value,key=value".
SettingOptions optionsOf(const std::string& spec, const SettingOptions& base) {
  const size_t colon = spec.find(':');
  return base.with(colon == spec.npos ? "allocation=" + spec : spec.substr(colon + 1));
}

Configuration configuration(const std::string& spec, const SettingOptions& base) {
  Configuration c;
  c.name = spec.substr(0, spec.find(':'));
  c.settings = optionsOf(spec, base).chosen();
  c.described = toJson(c.settings);
  try {
    json(c.name).dump();
  } catch (const json::exception&) {
    throw Error(ExitCode::kUsage, "--configuration: a name is no UTF-8", "use letters that your terminal shows");
  }
  if (c.name.empty())
    throw Error(ExitCode::kUsage, fmt::format("--configuration '{}' has no name", spec), "give NAME:key=value");
  return c;
}

int run(const Options& o, const std::string& command) {
  StudyPlan plan;
  plan.scenePath = o.scene, plan.folder = o.folder, plan.command = command;
  for (const std::string& spec : o.specs) plan.configurations.push_back(configuration(spec, o.settings));
  plan.baseline = o.baseline;
  plan.seeds = o.seeds, plan.firstSeed = o.seed, plan.maxSpp = o.maxSpp, plan.budgetSeconds = o.budget;
  plan.reference = o.reference, plan.referenceSeconds = o.referenceTime;
  if (o.target > 0) plan.target = o.target;
  plan.external = {o.external.begin(), o.external.end()};
  plan.threads = o.threads;
  plan.title = o.title.empty() ? std::filesystem::path(o.scene).stem().string() : o.title;

  const std::atomic<Stop>& stop = stopOnSignals(o.watchStdin);
  ::wardmis::Reporter reporter(o.progress);
  Scene scene = readGlb(o.scene, o.noDefaults);
  if (!o.resolution.empty()) useResolution(scene, o.resolution);
  if (!o.noDefaults) addDefaults(scene);
  const double start = wallSeconds();
  const BuiltScene built(scene, o.threads);
  if (o.check) {
    check(built, plan);
    return 0;
  }
  for (const std::string& note : scene.notes) reporter.warn(note);
  reporter.warnOfLacking(scene.lacking);
  for (size_t i = 0; i < o.specs.size(); ++i)
    if (const std::string why = optionsOf(o.specs[i], o.settings).yielding(); !why.empty())
      reporter.warn(fmt::format("configuration '{}': {}", plan.configurations[i].name, why));
  json names = json::array();
  for (const Configuration& c : plan.configurations) names.push_back(c.name);
  reporter.event({{"event", "start"},
                  {"version", WARDMIS_VERSION},
                  {"configurations", names},
                  {"seeds", o.seeds},
                  {"max_spp", o.budget > 0 ? json() : json(o.maxSpp)},
                  {"width", scene.film.x1 - scene.film.x0},
                  {"height", scene.film.y1 - scene.film.y0}});
  StudyObserver observer;
  observer.stop = &stop;
  observer.warn = [&](const std::string& message) { reporter.warn(message); };
  observer.progress = [&](const StudyProgress& p) {
    reporter.event({{"event", "progress"},
                    {"phase", p.phase},
                    {"configuration", p.configuration.empty() ? json() : json(p.configuration)},
                    {"seed", p.configuration.empty() ? json() : json(p.seed)},
                    {"done", p.done},
                    {"of", p.of},
                    {"fraction", p.fraction},
                    {"seconds", p.seconds},
                    {"left", p.left}});
    reporter.bar(p.fraction,
                 p.configuration.empty() ? fmt::format("{} {}/{}", p.phase, p.done, p.of)
                                         : fmt::format("{}, seed {} ({}/{})", p.configuration, p.seed, p.done, p.of),
                 p.seconds, p.left);
  };
  const Experiment e = measure(built, plan, observer);
  if (stop.load() == Stop::kDiscard)
    throw Error(ExitCode::kCancelled,
                "stopped; the parts of the reference and the runs that were finished are kept in " + o.folder,
                "the same command goes on from there");
  const auto phase = [&](double part) {
    observer.progress({"report", "", 0, 0, 1, 0.98 + 0.02 * part, wallSeconds() - start, 0});
  };
  phase(0);
  if (!e.complete && std::all_of(e.runs.begin(), e.runs.end(), [](const auto& runs) { return runs.empty(); }))
    throw Error(ExitCode::kCancelled, "stopped before the first run was finished; what was is kept in " + o.folder,
                "the same command goes on from there");
  const Analysis analysis = analyse(e, phase);
  writeReport(o.folder, analysis);
  reporter.clear();
  const std::string page = (std::filesystem::path(o.folder) / "report.html").string();
  if (!e.complete)
    throw Error(ExitCode::kCancelled, fmt::format("stopped; a report of what is done is in {}", page),
                "the same command goes on from there");
  reporter.event({{"event", "done"},
                  {"path", page},
                  {"report", (std::filesystem::path(o.folder) / "report.json").string()},
                  {"seconds", wallSeconds() - start}});
  if (!reporter.json()) {
    for (const json& sentence : analysis.report["finding"]) fmt::print("{}\n", sentence.get<std::string>());
    fmt::print("{}\n{}\n", page, analysis.report["verdict"]["text"].get<std::string>());
  }
  return 0;
}

}  // namespace

Verb addConverge(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("SCENE", o->scene, "a .glb or .gltf file")->required();
  app.add_option("-o,--output", o->folder, "the folder of the study: a new one, or one to go on with")->required();
  app.add_option("-c,--configuration", o->specs,
                 "an allocation, or NAME:key=value,key=value with the options below without dashes; repeat it for each")
      ->take_all()
      ->capture_default_str();
  app.add_option("--baseline", o->baseline, "the configuration that ratios refer to (default: the first)");
  app.add_option("--seeds", o->seeds, "independent repetitions of each")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  app.add_option("--seed", o->seed, "the first of them")->check(wholeNumber())->capture_default_str();
  auto* spp =
      app.add_option("--max-spp", o->maxSpp, "camera samples per pixel of each run; errors are taken at 1, 2, 4 ...")
          ->check(CLI::Range(2u, 1u << 24))
          ->capture_default_str();
  app.add_option("--budget-seconds", o->budget, "for the whole study instead, the reference included")
      ->check(between(0.1, 1e8))
      ->excludes(spp);
  auto* reference =
      app.add_option("--reference", o->reference,
                     "an image to hold the runs against (default: one is rendered, 16 times a run's samples)");
  app.add_option("--reference-time", o->referenceTime, "seconds for the reference")
      ->check(between(0.01, 1e8))
      ->excludes(reference);
  app.add_option("--target", o->target, "relMSE of which the time is compared (default: one that all reach)")
      ->check(between(1e-30, 1e30));
  app.add_option("--external", o->external, "manifest of renders by another program (docs/report-format.md)");
  app.add_option("--title", o->title, "of the report (default: the scene's name)");
  o->settings.add(app);
  app.add_option("--threads", o->threads, "0: all")->check(CLI::Range(0, 1024))->capture_default_str();
  app.add_option("--resolution", o->resolution, "WIDTHxHEIGHT instead of the scene's");
  app.add_flag("--no-defaults", o->noDefaults, "as for render");
  app.add_option("--progress", o->progress, "bar, json or none")
      ->check(CLI::IsMember({"auto", "bar", "json", "none"}))
      ->capture_default_str();
  app.add_flag("--check", o->check, "only look for mistakes in all of these, and end");
  app.add_flag("--watch-stdin", o->watchStdin, "stop when standard input is closed");
  return [o, &app] {
    std::string command = "wardmis converge " + shellQuoted(o->scene);
    for (const CLI::Option* option : app.get_options([](const CLI::Option* x) { return x->count() > 0; }))
      if (!option->get_lnames().empty() && option->get_lnames()[0] != "progress" &&
          option->get_lnames()[0] != "watch-stdin")
        for (const std::string& value : option->results())
          command += fmt::format(" --{}{}", option->get_lnames()[0],
                                 option->get_items_expected_max() > 0 ? " " + shellQuoted(value) : "");
    return run(*o, command);
  };
}

}  // namespace wardmis
