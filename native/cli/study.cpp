// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/paths.h"
#include "cli/verbs.h"
#include "film/write_file.h"
#include "integrate/setup.h"
#include "math/error.h"
#include "study/gnuplot.h"
#include "study/paper.h"
#include "study/report.h"

namespace wardmis {

namespace {

struct Options {
  StudyInput input;
  std::string brdf = "ward", mode = "full", integrand = "split", samples = "1024", cost = "none", csv, plot;
  std::vector<std::string> techniques{"lobe", "cosine"}, names;
  int trials = 1000, threads = 0;
  uint64_t seed = 0;
  bool json = false, paper = false;
  const CLI::App* app = nullptr;  // that tells what was given

  bool given(const char* option) const { return app->count(option) > 0; }
};

// What was given and would change nothing is a mistake, of which the reader of the result would not know.
void refuseIdleOptions(const Options& o) {
  const auto refuse = [&](const char* option, const std::string& why, const char* hint) {
    if (o.given(option)) throw Error(ExitCode::kUsage, fmt::format("{} {}", option, why), hint);
  };
  if (o.paper) {
    for (const CLI::Option* each : o.app->get_options())
      if (each->count() > 0 && each->get_name() != "--paper" && each->get_name() != "--plot")
        throw Error(ExitCode::kUsage, each->get_name() + " changes nothing of --paper", "leave it out");
    return;
  }
  const char* roughness[] = {"--alpha", "--alpha-x", "--alpha-y", "--phi-o"};
  if (o.brdf == "lafortune-phong")
    for (const char* option : roughness) refuse(option, "is no parameter of lafortune-phong", "its exponent is --m");
  else
    refuse("--m", "is no parameter of " + o.brdf, "its roughness is --alpha");
  if (!o.given("--alpha-x"))
    refuse("--phi-o", "means nothing of an isotropic lobe", "leave it out, or give --alpha-x and --alpha-y");
  if (o.mode == "planar") refuse("--phi-o", "means nothing in the planar reduction", "leave it out, or --mode full");
}

// "N", or "N..M": from N by doubling to M.
std::vector<int> sampleCounts(const std::string& text) {
  int from = 0, to = 0;
  char rest = 0;
  const int fields = std::sscanf(text.c_str(), "%d..%d%c", &from, &to, &rest);
  const bool single = text.find("..") == std::string::npos && std::sscanf(text.c_str(), "%d%c", &from, &rest) == 1;
  if (single) to = from;
  constexpr int kMost = 1 << 24;
  if ((!single && fields != 2) || from < 2 || to < from || to > kMost)
    throw Error(ExitCode::kUsage, fmt::format("--samples '{}'", text),
                fmt::format("give a number from 2 to {}, or a range as in 16..65536", kMost));
  std::vector<int> counts;
  for (long n = from; n <= to; n *= 2) counts.push_back(static_cast<int>(n));
  return counts;
}

// "none", "measured", or one number a technique.
std::optional<Densities> costs(const std::string& text, const Densities& measured, int techniques) {
  if (text == "none") return std::nullopt;
  if (text == "measured") return measured;
  Densities cost{};
  size_t from = 0;
  for (int i = 0; i < techniques; ++i) {
    size_t used = 0;
    try {
      cost[static_cast<size_t>(i)] = std::stod(text.substr(from), &used);
    } catch (const std::exception&) {
      used = 0;
    }
    from += used + 1;
    const bool ends = from == text.size() + 1;
    if (used == 0 || !(cost[static_cast<size_t>(i)] > 0) || !std::isfinite(cost[static_cast<size_t>(i)]) ||
        ends != (i + 1 == techniques) || (!ends && text[from - 1] != ','))
      throw Error(ExitCode::kUsage, fmt::format("--cost '{}'", text),
                  fmt::format("give none, measured, or {} numbers above 0 with commas", techniques));
  }
  return cost;
}

std::vector<const Strategy*> chosen(const std::vector<std::string>& names, size_t techniques) {
  std::vector<const Strategy*> list;
  std::string known;
  for (const Strategy& s : strategies()) {
    const bool fits = s.allocation != Allocation::kSecondOrder || techniques == 2;
    if (names.empty() && fits) list.push_back(&s);
    known += (known.empty() ? "" : ", ") + std::string(s.name);
  }
  for (const std::string& name : names) {
    const Strategy* s = findStrategy(name);
    if (s == nullptr) throw Error(ExitCode::kUsage, fmt::format("there is no strategy '{}'", name), "known: " + known);
    if (s->allocation == Allocation::kSecondOrder && techniques != 2)
      throw Error(ExitCode::kUsage, fmt::format("'{}' shares samples between two techniques", name), "leave it out");
    if (std::find(list.begin(), list.end(), s) != list.end())
      throw Error(ExitCode::kUsage, fmt::format("'{}' is named twice", name), "name each strategy once");
    list.push_back(s);
  }
  return list;
}

// The paper's printed formulas and its ranking, held against quadrature.
int runPaper(const Options& o) {
  const std::vector<Erratum> wrong = errata();
  const std::vector<Verdict> ranking = verdicts();
  if (!o.plot.empty()) plotVerdicts(ranking, o.plot);
  fmt::print("Printed formulas\n\n{}\nN Var over that of equal counts, rho_s = 0.5, rho_d = 0.3\n\n{}",
             errataTable(wrong), verdictTable(ranking));
  return 0;
}

int run(Options& o) {
  refuseIdleOptions(o);
  checkDistinct({{"--csv", o.csv}, {"--plot", o.plot}});
  if (!o.plot.empty()) checkPlotName(o.plot);
  for (const std::string* path : {&o.csv, &o.plot})
    if (!path->empty()) checkWritable(*path);
  if (o.paper) return runPaper(o);
  const auto start = std::chrono::steady_clock::now();
  StudyInput& in = o.input;
  for (StudyBrdf b : {StudyBrdf::kLafortunePhong, StudyBrdf::kWard, StudyBrdf::kWardDur, StudyBrdf::kWardGmd})
    if (o.brdf == name(b)) in.brdf = b;
  in.mode = o.mode == "planar" ? StudyMode::kPlanar : StudyMode::kFull;
  if (in.mode == StudyMode::kPlanar && !in.ward() && !o.given("--theta-o")) in.thetaO = 0;  // the only one it has
  in.joint = o.integrand == "joint";
  in.techniques.clear();
  for (const std::string& t : o.techniques)
    for (StudyTechnique k : {StudyTechnique::kLobe, StudyTechnique::kCosine, StudyTechnique::kUniform})
      if (t == name(k)) in.techniques.push_back(k);
  const std::vector<const Strategy*> list = chosen(o.names, in.techniques.size());
  const std::vector<int> counts = sampleCounts(o.samples);
  if (!o.plot.empty() && o.trials < 2)
    throw Error(ExitCode::kUsage, "--plot shows measured variances", "give --trials of at least 2");

  Study study;
  const std::unique_ptr<Problem> problem = makeProblem(in);
  study.input = in;
  study.exact = solve(*problem);
  study.costNanoseconds = measureCost(*problem);
  const std::optional<Densities> cost = costs(o.cost, study.costNanoseconds, problem->techniques());
  withThreads(o.threads, [&] {
    const std::vector<Prediction> predictions = predictAll(list, study.exact, cost ? &*cost : nullptr);
    for (int n : counts) {
      study.settings.push_back({n, o.trials, o.seed, cost, study.costNanoseconds, o.threads});
      study.runs.push_back(runTrials(*problem, study.exact, list, study.settings.back(), &predictions));
    }
  });
  study.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!o.csv.empty()) writeFile(o.csv, studyCsv(study));
  if (!o.plot.empty()) plotStudy(study, o.plot);
  if (o.json)
    fmt::print("{}\n", studyJson(study).dump(2));
  else
    fmt::print("{}", studyTable(study));
  return 0;
}

}  // namespace

Verb addStudy(CLI::App& app) {
  auto o = std::make_shared<Options>();
  o->app = &app;
  app.footer(
      "The paper's sections 3 and 4: L_o = integral of f_r L_i cos under the sky L_i = R cos(theta), exactly and by "
      "trials.");
  app.add_option("--brdf", o->brdf, "the reflectance")
      ->check(CLI::IsMember({"lafortune-phong", "ward", "ward-dur", "ward-gmd"}))
      ->capture_default_str();
  auto* alpha = app.add_option_function<double>(
      "--alpha", [o](double a) { o->input.alphaX = o->input.alphaY = a; }, "Ward's roughness (default 0.1)");
  auto* x = app.add_option("--alpha-x", o->input.alphaX, "anisotropic: along x")->excludes(alpha);
  auto* y = app.add_option("--alpha-y", o->input.alphaY, "anisotropic: along y")->excludes(alpha);
  x->needs(y), y->needs(x);
  app.add_option("--phi-o", o->input.phiO, "azimuth of the outgoing direction, degrees")->capture_default_str();
  app.add_option("--m", o->input.m, "exponent of Lafortune and Phong's lobe")->capture_default_str();
  app.add_option("--theta-o", o->input.thetaO, "angle of the outgoing direction, degrees (planar lafortune-phong: 0)")
      ->capture_default_str();
  app.add_option("--rho-d", o->input.rhoD, "diffuse albedo")->capture_default_str();
  app.add_option("--rho-s", o->input.rhoS, "specular factor")->capture_default_str();
  app.add_option("--R", o->input.R, "scale of the sky")->capture_default_str();
  app.add_option("--mode", o->mode, "full: over the hemisphere; planar: the paper's 1-D reduction, no radiance")
      ->check(CLI::IsMember({"full", "planar"}))
      ->capture_default_str();
  app.add_option("--integrand", o->integrand, "split: the diffuse part apart, exactly; joint: inside the integrand")
      ->check(CLI::IsMember({"split", "joint"}))
      ->capture_default_str();
  app.add_option("--techniques", o->techniques, "two or three of lobe, cosine, uniform")
      ->delimiter(',')
      ->check(CLI::IsMember({"lobe", "cosine", "uniform"}))
      ->default_str("lobe,cosine");
  app.add_option("--samples", o->samples, "N of one estimate, all techniques together, or a range N..M by doubling")
      ->capture_default_str();
  app.add_option("--trials", o->trials, "estimates of each strategy; 0: the exact part alone")
      ->check(CLI::Range(0, 100000000))
      ->capture_default_str();
  app.add_option("--strategies", o->names, "names, with commas (default: all)")->delimiter(',');
  app.add_option("--cost", o->cost, "of a sample of each technique: none (equal), measured, or numbers as in 1,2.5")
      ->capture_default_str();
  app.add_option("--seed", o->seed, "another seed, other trials")->check(wholeNumber())->capture_default_str();
  app.add_option("--threads", o->threads, "0: all; the numbers do not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_flag("--json", o->json, "one object with the keys input, expect (as in tests/golden) and measured");
  app.add_option("--csv", o->csv, "write a line for each strategy and number of samples");
  app.add_option("--plot", o->plot,
                 "draw variance against samples and error against time, as .svg or .png (needs gnuplot)");
  app.add_flag(
      "--paper", o->paper,
      "instead: how far the paper's printed formulas are off, and when its ranking of the allocations is true; with "
      "--plot as a figure");
  return [o] { return run(*o); };
}

}  // namespace wardmis
