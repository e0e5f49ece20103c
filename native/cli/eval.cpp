// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/eval.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <map>
#include <memory>

#include "cli/options.h"
#include "cli/verbs.h"
#include "math/error.h"

namespace wardmis {

Verb addEval(CLI::App& app) {
  static const std::map<std::string, StudyBrdf> kBrdfs{{"lafortune-phong", StudyBrdf::kLafortunePhong},
                                                       {"ward", StudyBrdf::kWard},
                                                       {"ward-dur", StudyBrdf::kWardDur},
                                                       {"ward-gmd", StudyBrdf::kWardGmd}};
  static const std::map<std::string, Precision> kPrecisions{
      {"float", Precision::kFloat}, {"double", Precision::kDouble}, {"longdouble", Precision::kLongDouble}};
  struct Options {
    std::string file, brdf = "ward", precision = "double";
    EvalSettings settings;
  };
  auto o = std::make_shared<Options>();
  StudyInput& s = o->settings.surface;
  app.add_option("FILE", o->file, "what to read instead of standard input");
  app.add_option("--brdf", o->brdf, "the model")->check(CLI::IsMember(kBrdfs))->capture_default_str();
  const CLI::Validator alphas = between(1e-7, 100.0);
  auto* x = app.add_option("--alpha-x", s.alphaX, "Ward's roughness, x")->check(alphas)->capture_default_str();
  auto* y = app.add_option("--alpha-y", s.alphaY, "Ward's roughness, y")->check(alphas)->capture_default_str();
  auto* alpha =
      app.add_option_function<double>(
             "--alpha", [o](double a) { o->settings.surface.alphaX = o->settings.surface.alphaY = a; }, "both of them")
          ->check(alphas)
          ->excludes(x, y);
  x->needs(y), y->needs(x);
  auto* m =
      app.add_option("--m", s.m, "Lafortune and Phong's exponent")->check(between(0.0, 1e7))->capture_default_str();
  app.add_option("--rho-s", s.rhoS, "specular albedo factor")->check(between(0.0, 1e6))->capture_default_str();
  app.add_option("--rho-d", s.rhoD, "diffuse albedo")->check(between(0.0, 1e6))->capture_default_str();
  app.add_option("--precision", o->precision, "what the numbers are computed in")
      ->check(CLI::IsMember(kPrecisions))
      ->capture_default_str();
  app.add_flag("--sample", o->settings.sample, "lines are u1 u2 wo.x wo.y wo.z; the sampled wi comes first");
  app.add_flag("--json", o->settings.json, "a JSON object a line");
  app.footer("Reads lines 'wi.x wi.y wi.z wo.x wo.y wo.z', and prints 'f pdf log-pdf weight' for each.");

  return [=] {
    EvalSettings& e = o->settings;
    e.surface.brdf = kBrdfs.at(o->brdf);
    e.precision = kPrecisions.at(o->precision);
    if (e.surface.ward() ? m->count() > 0 : alpha->count() + x->count() > 0)
      throw Error(ExitCode::kUsage, fmt::format("{} has no {}", o->brdf, e.surface.ward() ? "--m" : "--alpha"),
                  "Ward takes --alpha, or --alpha-x and --alpha-y; lafortune-phong takes --m");
    const int in = o->file.empty() ? STDIN_FILENO : open(o->file.c_str(), O_RDONLY | O_CLOEXEC);
    if (in < 0)
      throw Error(ExitCode::kFile, fmt::format("{}: {}", o->file, std::strerror(errno)), "give a file of lines");
    evalLines(e, in, STDOUT_FILENO);
    return 0;
  };
}

}  // namespace wardmis
