// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/render.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/options.h"
#include "cli/part.h"
#include "cli/paths.h"
#include "cli/preview.h"
#include "cli/session.h"
#include "cli/settings.h"
#include "cli/statistics.h"
#include "cli/verbs.h"
#include "film/write_file.h"
#include "gltf/reader.h"
#include "image/texel_memory.h"
#include "integrate/passes.h"
#include "math/error.h"
#include "report/provenance.h"
#include "scene/defaults.h"
#include "world/needs.h"

namespace wardmis {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

struct Options {
  std::string scene, output, stats, progress = "auto", preview, layer = "ViewLayer", passes, filter = "scene",
                                    resolution, samples;
  double previewInterval = 1;
  bool watchStdin = false, noDefaults = false, uncompressed = false;
  SettingOptions settings;
  // what ends it, and its seed
  uint32_t spp = 64;
  double seconds = 0, targetError = 0;
  uint64_t seed = 0;
  int threads = 0;
};

constexpr std::array kFilters{FilterType::kBox, FilterType::kGaussian, FilterType::kBlackmanHarris};

constexpr size_t kLongestLayer = 200;  // the name of a channel has at most 255 bytes in an OpenEXR, the pass's included

std::string line(const Progress& p) {
  return fmt::format("{} {}{}", p.pilot ? "pilot" : "sample", p.samples, p.of > 0 ? fmt::format("/{}", p.of) : "");
}

json event(const Progress& p) {
  return {{"event", "progress"},
          {"phase", p.pilot ? "pilot" : "render"},
          {"samples", p.samples},
          {"of", p.of > 0 ? json(p.of) : json()},
          {"fraction", p.fraction},
          {"seconds", p.seconds},
          {"left", p.left ? json(*p.left) : json()}};
}

// `list` as --passes has it; empty: what a scene with `techniques` has. A pass that is named is there for every scene,
// so that who asked for it knows what the file holds.
std::vector<PassInfo> choosePasses(const std::string& list, TechniqueMask techniques,
                                   const std::vector<std::string>& names) {
  if (list.empty()) return passesFor(techniques, names);
  std::vector<PassInfo> known = passesFor(~TechniqueMask{0}, names), chosen;
  const std::vector<PassInfo> others = passesOnRequest();
  known.insert(known.end(), others.begin(), others.end());
  for (const std::string& each : CLI::detail::split(list, ',')) {
    const size_t equals = each.find('=');
    const std::string want = each.substr(0, equals);
    const size_t before = chosen.size();
    for (const PassInfo& p : known) {
      if (p.group != want) continue;
      PassInfo& made = chosen.emplace_back(p);
      if (equals == std::string::npos) continue;
      made.name = each.substr(equals + 1);
      if (!(p.data || p.light) || made.name.empty() || made.name.find('.') != std::string::npos)
        throw Error(ExitCode::kUsage, fmt::format("--passes: '{}' cannot be a name of that pass", each),
                    "names are for the passes from position on, as --help lists them, and have no dot");
    }
    if (chosen.size() == before)
      throw Error(ExitCode::kUsage, fmt::format("--passes: there is no pass '{}'", want),
                  "known: combined, depth, normal, albedo, variance, allocation, samples, position, uv, object-index, "
                  "material-index, emission, environment, and diffuse-, glossy-, transmission- with direct, indirect, "
                  "color");
  }
  for (size_t i = 0; i < chosen.size(); ++i)
    for (size_t k = 0; k < i; ++k)
      if (chosen[i].name == chosen[k].name)
        throw Error(ExitCode::kUsage, fmt::format("--passes: two passes are called '{}'", chosen[i].name),
                    "name each pass once, and give each a name of its own");
  return chosen;
}

// FROM..TO, as --samples has it.
SampleRange rangeOf(const std::string& text, uint32_t spp) {
  const size_t dots = text.find("..");
  SampleRange r;
  if (dots == text.npos || !CLI::detail::lexical_cast(text.substr(0, dots), r.from) ||
      !CLI::detail::lexical_cast(text.substr(dots + 2), r.to) || r.from >= r.to || r.to > spp)
    throw Error(ExitCode::kUsage, fmt::format("--samples '{}' is no part of {} samples (--spp)", text, spp),
                fmt::format("give FROM..TO with 0 <= FROM < TO <= {}; TO is not one of them", spp));
  return r;
}

int run(Options& o) {
  const auto start = Clock::now();
  RenderSettings s = o.settings.chosen();
  s.spp = o.spp, s.seconds = o.seconds, s.targetError = o.targetError, s.seed = o.seed, s.threads = o.threads;
  if (!o.samples.empty()) {
    s.part = rangeOf(o.samples, s.spp);
    if (s.allocation == Allocation::kAuto && s.costFrom == CostFrom::kMeasured)
      throw Error(ExitCode::kUsage, "--samples with --cost measured: each part would measure other costs",
                  "leave one of them out, or give the costs: --cost L,C,S");
    if (s.pixels == PixelSamples::kByError)
      throw Error(ExitCode::kUsage,
                  "--samples with --pixels by-error: no part knows the samples that tell where more are wanted",
                  "leave one of them out");
  }
  for (const PassInfo& p : choosePasses(o.passes, 0, {"any"}))  // whether they exist
    s.data = s.data || p.data, s.light = s.light || p.light;
  checkDistinct({{"SCENE", o.scene}, {"--output", o.output}, {"--stats", o.stats}, {"--preview", o.preview}});
  for (const std::string* path : {&o.output, &o.stats, &o.preview})
    if (!path->empty()) checkWritable(*path);
  for (const std::string* path : {&o.output, &o.preview})
    if (!path->empty()) checkNamedExr(*path);

  const std::atomic<Stop>& stopRequest = stopOnSignals(o.watchStdin);
  Reporter reporter(o.progress);
  Scene scene = readGlb(o.scene, o.noDefaults);
  if (!o.resolution.empty()) useResolution(scene, o.resolution);
  if (!o.noDefaults) addDefaults(scene);
  if (const std::string why = o.settings.yielding(); !why.empty()) scene.notes.push_back(why);
  if (o.filter != "scene") scene.film.filter = pick(o.filter, kFilters);
  const double readSeconds = since(start);

  Statistics st;
  const auto cancelled = [&] { return stopRequest.load() != Stop::kNo; };
  RenderObserver observer;
  observer.stop = &stopRequest;
  observer.started = [&](const Statistics&) {
    if ((st.needs & (kNeedsEnvironment | kNeedsLightSampling)) == 0)
      scene.notes.emplace_back(
          scene.lights.empty() ? "nothing in the scene gives light, so that the image is black; add a light or a world"
                               : "the scene's lights are so weak or so small that none is left of them, so that the "
                                 "image is black; make them or the whole scene larger");
    json passes = json::array();
    for (const PassInfo& p : choosePasses(o.passes, st.techniques, st.techniqueNames))
      passes.push_back({{"name", p.name}, {"channels", p.channels}});
    reporter.event({{"event", "start"},
                    {"version", WARDMIS_VERSION},
                    {"width", scene.film.x1 - scene.film.x0},
                    {"height", scene.film.y1 - scene.film.y0},
                    {"spp", s.open() ? json() : json(s.range().count())},
                    {"passes", passes},
                    {"left_out", st.leftOut},
                    {"notes", scene.notes}});
    reporter.info(fmt::format("{}: {} triangles, kernel: {}", o.scene, st.triangles, describe(st.kernel)));
    if (const std::string taken = describe(texelUse()); !taken.empty()) reporter.info("  textures: " + taken);
    for (size_t i = scene.lacking.size(); i < st.leftOut.size(); ++i)  // of those before it warns
      reporter.info("  left out: " + st.leftOut[i]);
    if (!reporter.json())
      for (const std::string& note : scene.notes) reporter.warn(note);
    reporter.warnOfLacking(scene.lacking);
    for (const std::string& doubt : st.doubts) reporter.warn(doubt);
    if (scene.degenerateTriangles > 0)
      reporter.info(fmt::format("  dropped: {} triangles without area", scene.degenerateTriangles));
  };
  observer.progress = [&](const Progress& p) {
    reporter.event(event(p));
    reporter.bar(p.fraction, line(p), p.seconds, p.left);
  };
  Preview preview(o.preview, o.previewInterval, scene.film.x1 - scene.film.x0, scene.film.y1 - scene.film.y0);
  if (!o.preview.empty())
    observer.image = [&](const FilmBuffer& film, int side) {
      const std::string list = o.passes.empty() ? "combined" : o.passes;
      const std::vector<PassInfo> passes = choosePasses(list, st.techniques, st.techniqueNames);
      if (preview.show(film, side, passes, st.techniqueNames, o.layer, scene.zUp))
        reporter.event({{"event", "preview"}, {"path", o.preview}, {"samples", film.samples}});
    };

  const FilmBuffer film = render(scene, s, st, observer);
  reporter.clear();

  const Stop stopped = stopRequest.load();
  if (stopped == Stop::kDiscard || (cancelled() && film.samples == 0))
    throw Error(ExitCode::kCancelled, "cancelled; nothing was written");
  std::string output = o.output;
  if (stopped == Stop::kKeep) {
    const std::filesystem::path p(output);
    output = (p.parent_path() / p.stem()).string() + ".partial.exr";
  }

  const auto writeStart = Clock::now();
  const ImageDescription description{o.layer, scene.zUp, choosePasses(o.passes, st.techniques, st.techniqueNames),
                                     st.techniqueNames};
  ExrImage image = toImage(film, description);
  const json statsBefore = statisticsJson(o.scene, s, scene, st, film, readSeconds, 0, since(start));
  describe(image, statsBefore);
  if (s.part) {
    const Film& f = scene.film;
    makePart(image, film,
             {{"scene", hashOf(scene.files)},
              {"samples", s.spp},
              {"frame", {f.width, f.height}},
              {"border", {f.x0, f.y0, f.x1, f.y1}},
              {"defaults", !o.noDefaults}},
             description, statsBefore, countsJson(st.pilotCounts, st.techniqueNames));
  }
  writeExr(output, image, !o.uncompressed);
  const json stats = statisticsJson(o.scene, s, scene, st, film, readSeconds, since(writeStart), since(start));
  if (!o.stats.empty()) writeFile(o.stats, dumped(stats, 2) + '\n');

  const RareCounts& rare = st.counts.rare;
  if (rare.total() > 0)
    reporter.warn(fmt::format(
        "{} of {} camera samples were dropped: {} not a number, {} infinite, {} negative; the image lacks their light",
        rare.total(), st.counts.cameraRays, rare.nan, rare.infinite, rare.negative));
  if (stopped == Stop::kNo && s.targetError > 0 && !(st.error && st.error->upper <= s.targetError))
    reporter.warn(st.error
                      ? fmt::format("the image's error is not yet surely below {:g}: after {} samples per pixel it is "
                                    "about {:.2g}, and below {:.2g} with 95 % confidence; allow more (--spp, --time)",
                                    s.targetError, film.samples, st.error->relMse, st.error->upper)
                      : fmt::format("{} samples per pixel are too few to tell the image's error; allow 8 and more "
                                    "(--spp, --time)",
                                    film.samples));
  if (stopped == Stop::kKeep)
    throw Error(ExitCode::kCancelled,
                fmt::format("cancelled after {} samples per pixel; {} {}", film.samples,
                            s.part ? fmt::format("samples {}..{} are in", film.first, film.first + film.samples)
                                   : "the image so far is in",
                            output));
  reporter.event(
      {{"event", "done"}, {"path", output}, {"seconds", since(start)}, {"samples", film.samples}, {"stats", stats}});
  if (!reporter.json())
    fmt::print(
        "{}: {} samples per pixel, {:.2f} s (pilot {:.2f} s), {} rays{}\n", output, film.samples,
        st.pilotSeconds + st.renderSeconds, st.pilotSeconds, st.counts.allRays(),
        st.error ? fmt::format(", error about {:.2g}, below {:.2g} with 95 %", st.error->relMse, st.error->upper) : "");
  return 0;
}

}  // namespace

Verb addRender(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("SCENE", o->scene, "a .glb or .gltf file")->required();
  app.add_option("-o,--output", o->output, "the EXR to write")->required();
  o->settings.add(app);
  auto* spp =
      app.add_option("--spp", o->spp, "camera samples per pixel, the pilot's included if it is part of the image")
          ->check(CLI::Range(1u, 1u << 24))
          ->capture_default_str();
  auto* time = app.add_option("--time", o->seconds, "stop after this many seconds instead, the pilot's included")
                   ->check(between(0.001, 1e7))
                   ->excludes(spp);
  auto* target = app.add_option("--target-error", o->targetError,
                                "stop as soon as the relMSE (without the worst 0.1 % of the pixels), as the samples "
                                "themselves tell it, is below this with 95 % "
                                "confidence, at the latest after --spp samples (65536, if not given) or --time")
                     ->check(between(1e-9, 1e3));
  app.add_option(
         "--samples", o->samples,
         "FROM..TO: of the --spp samples these alone (TO is not one of them), as a part that 'wardmis merge' adds "
         "to others")
      ->excludes(time)
      ->excludes(target);
  app.add_option("--filter", o->filter, "pixel filter")->check(among(kFilters, {"scene"}))->capture_default_str();
  app.add_option("--seed", o->seed, "another seed, another noise")->check(wholeNumber())->capture_default_str();
  app.add_option("--threads", o->threads, "0: all; the image does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--resolution", o->resolution, "WIDTHxHEIGHT instead of the scene's");
  app.add_flag("--no-defaults", o->noDefaults, "refuse a scene without a camera, and add no sky to one without lights");
  app.add_option("--layer", o->layer, "first part of the EXR's channel names")
      ->check(notLonger(kLongestLayer))
      ->capture_default_str();
  app.add_option(
      "--passes", o->passes,
      "of combined,depth,normal,albedo,variance,allocation (default: all of these), samples,position,uv,object-index,"
      "material-index,emission,environment, diffuse-direct,diffuse-indirect,diffuse-color and likewise for "
      "glossy and transmission; of the latter also PASS=NAME, its name in the file");
  app.add_flag("--uncompressed", o->uncompressed, "write the EXR without compression: larger, and sooner there");
  app.add_option("--stats", o->stats, "write statistics to this JSON file");
  app.add_option("--progress", o->progress, "bar, json or none")
      ->check(CLI::IsMember({"auto", "bar", "json", "none"}))
      ->capture_default_str();
  app.add_option("--preview", o->preview, "rewrite this EXR with the image so far");
  app.add_option("--preview-interval", o->previewInterval, "seconds between previews")
      ->check(between(0, 1e6))
      ->capture_default_str();
  app.add_flag("--watch-stdin", o->watchStdin, "stop when standard input is closed");
  return [o, spp] {
    if (o->targetError > 0 && spp->count() == 0) o->spp = 1u << 16;
    return run(*o);
  };
}

}  // namespace wardmis
