// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/render.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cctype>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/options.h"
#include "cli/paths.h"
#include "cli/verbs.h"
#include "film/write_file.h"
#include "integrate/passes.h"
#include "math/clones.h"
#include "math/error.h"
#include "scene/glb.h"

namespace wardmis {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

std::atomic<Stop> stopRequest{Stop::kNo};
static_assert(std::atomic<Stop>::is_always_lock_free, "set from a signal handler");

void onSignal(int signal) {
  // the second Ctrl-C no longer waits for the pass to end
  const bool keep = signal == SIGINT && stopRequest.load() == Stop::kNo;
  stopRequest.store(keep ? Stop::kKeep : Stop::kDiscard);
}

double since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

struct Options {
  std::string scene, output, stats, progress = "auto", preview, layer = "ViewLayer", passes, filter = "scene",
                                    resolution;
  double previewInterval = 1;
  bool watchStdin = false;
  std::string allocation = "second-moment", weights = "auto", integrand = "split", integrator = "path",
              sampler = "sobol", kernel = "auto";
  RenderSettings settings;
};

// What the settings' names mean; the parser has checked that they are among these.
template <class E, size_t N>
E pick(const std::string& value, const std::array<E, N>& all) {
  for (E e : all)
    if (name(e) == value) return e;
  throw Error(ExitCode::kUsage, "unknown value " + value);
}
constexpr std::array kAllocations{Allocation::kEqual,
                                  Allocation::kVariance,
                                  Allocation::kStandardDeviation,
                                  Allocation::kSecondMoment,
                                  Allocation::kInverseVariance,
                                  Allocation::kEqualised,
                                  Allocation::kRepresentativity,
                                  Allocation::kAlbedo,
                                  Allocation::kAuto};
constexpr std::array kWeights{Weights::kBalance, Weights::kNonbalance, Weights::kPower, Weights::kCutoff,
                              Weights::kMaximum};
constexpr std::array kIntegrands{Integrand::kSplit, Integrand::kJoint};
constexpr std::array kIntegrators{Integrator::kDirect, Integrator::kPath};
constexpr std::array kSamplers{SamplerType::kIndependent, SamplerType::kStratified, SamplerType::kSobol};
constexpr std::array kFilters{FilterType::kBox, FilterType::kGaussian, FilterType::kBlackmanHarris};

constexpr size_t kLongestLayer = 200;  // the name of a channel has at most 255 bytes in an OpenEXR, the pass's included

template <class E, size_t N>
CLI::IsMember among(const std::array<E, N>& all, std::vector<std::string> more = {}) {
  for (E e : all) more.emplace_back(name(e));
  return CLI::IsMember(more);
}

// Progress for whoever listens: a bar on a terminal, JSON lines for a program.
class Reporter {
 public:
  explicit Reporter(const std::string& kind)
      : json_(kind == "json"), bar_(kind == "bar" || (kind == "auto" && isatty(STDERR_FILENO) != 0)) {}

  bool json() const { return json_; }
  void event(const nlohmann::json& e) {
    if (!json_) return;
    const std::lock_guard lock(mutex_);
    fmt::print("{}\n", e.dump(-1, ' ', false, json::error_handler_t::replace));
    std::fflush(stdout);
  }
  void warn(const std::string& message) {
    if (json_) return event({{"event", "warning"}, {"message", message}});
    clear();
    fmt::print(stderr, "wardmis: warning: {}\n", message);
  }
  void info(const std::string& message) {
    if (json_ || !bar_) return;
    clear();
    fmt::print(stderr, "{}\n", message);
  }
  void progress(const Progress& p) {
    event({{"event", "progress"},
           {"phase", p.pilot ? "pilot" : "render"},
           {"samples", p.samples},
           {"of", p.of > 0 ? nlohmann::json(p.of) : nlohmann::json()},
           {"fraction", p.fraction},
           {"seconds", p.seconds},
           {"left", p.left}});
    if (!bar_) return;
    constexpr int kWidth = 30;
    const int full = static_cast<int>(p.fraction * kWidth);
    fmt::print(stderr, "\r[{:#<{}}{:.<{}}] {:3.0f} %  {} {}{}  {:.1f} s, {:.1f} s left\x1b[K", "", full, "",
               kWidth - full, 100 * p.fraction, p.pilot ? "pilot" : "sample", p.samples,
               p.of > 0 ? fmt::format("/{}", p.of) : "", p.seconds, p.left);
    std::fflush(stderr);
    drawn_ = true;
  }
  void clear() {
    if (drawn_) fmt::print(stderr, "\r\x1b[K");
    drawn_ = false;
  }

 private:
  bool json_, bar_, drawn_ = false;
  std::mutex mutex_;
};

json settingsJson(const RenderSettings& s, const Scene& scene) {
  return {{"allocation", name(s.allocation)},
          {"weights", name(s.weightRule())},
          {"integrand", name(s.integrand)},
          {"integrator", name(s.integrator)},
          {"sampler", name(s.sampler)},
          {"spp", s.seconds > 0 ? json() : json(s.spp)},
          {"time", s.seconds > 0 ? json(s.seconds) : json()},
          {"samples_per_hit", s.samplesPerHit},
          {"pilot_spp", s.pilotSpp},
          {"min_fraction", s.minFraction},
          {"cost", s.cost},
          {"max_depth", s.maxDepth},
          {"seed", s.seed},
          {"filter", name(scene.film.filter)},
          {"filter_width", scene.film.filterWidth},
          {"kernel", s.generalKernel ? "general" : "auto"}};
}

json statisticsJson(const Options& o, const Scene& scene, const Statistics& s, const FilmBuffer& film, double read,
                    double write, double total) {
  const Counts& c = s.counts;
  double variance = 0;
  for (const Pixel& p : film.pixels) variance += static_cast<double>(luminance(film.variance(p)));
  variance /= static_cast<double>(std::max<size_t>(1, film.pixels.size()));
  return {{"version", WARDMIS_VERSION},
          {"scene", o.scene},
          {"settings", settingsJson(o.settings, scene)},
          {"seconds",
           {{"read", read},
            {"build", s.buildSeconds},
            {"pilot", s.pilotSeconds},
            {"render", s.renderSeconds},
            {"write", write},
            {"total", total}}},
          {"cpu_seconds", {{"pilot", s.pilotCpuSeconds}, {"render", s.renderCpuSeconds}}},
          {"samples_per_pixel", film.samples},
          {"pixels", film.pixels.size()},
          {"camera_paths", c.cameraRays},
          {"samples",
           {{"lobe", c.samples[kLobe]},
            {"cosine", c.samples[kCosine]},
            {"light", c.samples[kLight]},
            {"total", c.samples[0] + c.samples[1] + c.samples[2]}}},
          {"rays",
           {{"camera", c.cameraRays},
            {"lobe", c.lobeRays},
            {"cosine", c.cosineRays},
            {"shadow", c.shadowRays},
            {"total", c.cameraRays + c.lobeRays + c.cosineRays + c.shadowRays}}},
          {"counts", {{"nan", c.rare.nan}, {"infinite", c.rare.infinite}, {"negative", c.rare.negative}}},
          {"needs", describe(s.needs)},
          {"kernel", describe(s.kernel)},
          {"allocated", s.allocated},
          {"left_out", s.leftOut},
          {"notes", scene.notes},
          {"scene_counts",
           {{"triangles", s.triangles},
            {"instances", s.instances},
            {"materials", scene.materials.size()},
            {"lights", scene.lights.size()},
            {"emissive_triangles", s.emissiveTriangles}}},
          {"mean_variance", variance},
          {"threads", s.threads},
          {"isa", clonedFor()}};
}

std::vector<PassInfo> choosePasses(const std::string& list, TechniqueMask techniques) {
  std::vector<PassInfo> all = passesFor(techniques);
  if (list.empty()) return all;
  std::vector<PassInfo> chosen;
  for (const std::string& want : CLI::detail::split(list, ',')) {
    bool known = want == "allocation";  // a scene may have none
    for (const PassInfo& p : all)
      if (p.group == want) chosen.push_back(p), known = true;
    if (!known)
      throw Error(ExitCode::kUsage, fmt::format("--passes: there is no pass '{}'", want),
                  "known: combined, depth, normal, albedo, variance, allocation");
  }
  return chosen;
}

bool isNamedExr(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension == ".exr";
}

void useResolution(Scene& scene, const std::string& text) {
  int w = 0, h = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &w, &h, &rest) != 2 || w < 1 || h < 1 || w > 65536 || h > 65536)
    throw Error(ExitCode::kUsage, fmt::format("--resolution '{}'", text), "give WIDTHxHEIGHT, for example 1920x1080");
  Film& f = scene.film;
  if (scene.camera) {
    // keep the larger side of the view plane, as another aspect would in Blender
    Camera& c = *scene.camera;
    const float aspect = static_cast<float>(w) / static_cast<float>(h), old = (c.right - c.left) / (c.top - c.bottom);
    const float cx = 0.5f * (c.left + c.right), cy = 0.5f * (c.bottom + c.top);
    if (aspect >= 1) {
      const float half = 0.5f * (old >= 1 ? c.right - c.left : c.top - c.bottom);
      c.left = cx - half, c.right = cx + half, c.bottom = cy - half / aspect, c.top = cy + half / aspect;
    } else {
      const float half = 0.5f * (old >= 1 ? c.right - c.left : c.top - c.bottom);
      c.bottom = cy - half, c.top = cy + half, c.left = cx - half * aspect, c.right = cx + half * aspect;
    }
  }
  const double sx = double(w) / f.width, sy = double(h) / f.height;
  f.x0 = static_cast<int>(f.x0 * sx), f.x1 = std::max(f.x0 + 1, static_cast<int>(f.x1 * sx));
  f.y0 = static_cast<int>(f.y0 * sy), f.y1 = std::max(f.y0 + 1, static_cast<int>(f.y1 * sy));
  f.width = w, f.height = h;
}

int run(Options& o) {
  const auto start = Clock::now();
  RenderSettings& s = o.settings;
  s.allocation = pick(o.allocation, kAllocations);
  if (o.weights != "auto") s.weights = pick(o.weights, kWeights);
  s.integrand = pick(o.integrand, kIntegrands);
  s.integrator = pick(o.integrator, kIntegrators);
  s.sampler = pick(o.sampler, kSamplers);
  s.generalKernel = o.kernel == "general";
  choosePasses(o.passes, kAllTechniques);
  checkDistinct({{"SCENE", o.scene}, {"--output", o.output}, {"--stats", o.stats}, {"--preview", o.preview}});
  for (const std::string* path : {&o.output, &o.stats, &o.preview})
    if (!path->empty()) checkWritable(*path);
  for (const std::string* path : {&o.output, &o.preview})
    if (!path->empty() && !isNamedExr(*path))
      throw Error(ExitCode::kUsage, fmt::format("{}: the image is an OpenEXR", *path), "give a name that ends in .exr");

  struct sigaction action {};
  action.sa_handler = onSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is an error of write(), as a full disk is
  if (o.watchStdin)
    std::thread([] {
      char c;
      while (true) {
        const ssize_t n = read(STDIN_FILENO, &c, 1);
        if (n == 0 || (n < 0 && errno != EINTR)) break;
      }
      stopRequest.store(Stop::kDiscard);
    }).detach();

  Reporter reporter(o.progress);
  Scene scene = readGlb(o.scene);
  if (!o.resolution.empty()) useResolution(scene, o.resolution);
  if (o.filter != "scene") scene.film.filter = pick(o.filter, kFilters);
  const double readSeconds = since(start);

  const auto cancelled = [&] { return stopRequest.load() != Stop::kNo; };
  RenderObserver observer;
  observer.stop = &stopRequest;
  observer.started = [&](const Statistics& st) {
    if ((st.needs & (kNeedsEnvironment | kNeedsLightSampling)) == 0)
      scene.notes.emplace_back("nothing in the scene gives light, so that the image is black; add a light or a world");
    json passes = json::array();
    for (const PassInfo& p : choosePasses(o.passes, st.techniques))
      passes.push_back({{"name", p.name}, {"channels", p.channels}});
    reporter.event({{"event", "start"},
                    {"version", WARDMIS_VERSION},
                    {"width", scene.film.x1 - scene.film.x0},
                    {"height", scene.film.y1 - scene.film.y0},
                    {"spp", s.seconds > 0 ? json() : json(s.spp)},
                    {"passes", passes},
                    {"left_out", st.leftOut},
                    {"notes", scene.notes}});
    reporter.info(fmt::format("{}: {} triangles, kernel: {}", o.scene, st.triangles, describe(st.kernel)));
    for (const std::string& left : st.leftOut) reporter.info("  left out: " + left);
    if (!reporter.json())
      for (const std::string& note : scene.notes) reporter.warn(note);
    if (scene.degenerateTriangles > 0)
      reporter.info(fmt::format("  dropped: {} triangles without area", scene.degenerateTriangles));
  };
  observer.progress = [&](const Progress& p) { reporter.progress(p); };
  auto lastPreview = Clock::now();
  bool previewed = false;
  if (!o.preview.empty())
    observer.image = [&](const FilmBuffer& film) {
      if (previewed && since(lastPreview) < o.previewInterval) return;
      writeExr(o.preview, toPasses(film, {{"Combined", "RGBA", "combined"}}, o.layer, scene.zUp), false);
      reporter.event({{"event", "preview"}, {"path", o.preview}, {"samples", film.samples}});
      lastPreview = Clock::now();
      previewed = true;
    };

  Statistics st;
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
  ExrImage image = toPasses(film, choosePasses(o.passes, st.techniques), o.layer, scene.zUp);
  const json statsBefore = statisticsJson(o, scene, st, film, readSeconds, 0, since(start));
  for (const char* key : {"version", "settings", "seconds", "samples_per_pixel", "samples", "rays", "counts", "needs",
                          "kernel", "left_out", "notes", "threads"}) {
    const json& v = statsBefore.at(key);
    image.attributes.emplace_back(
        fmt::format("wardmis:{}", key),
        v.is_string() ? v.get<std::string>() : v.dump(-1, ' ', false, json::error_handler_t::replace));
  }
  writeExr(output, image, true);
  const json stats = statisticsJson(o, scene, st, film, readSeconds, since(writeStart), since(start));
  if (!o.stats.empty()) writeFile(o.stats, stats.dump(2, ' ', false, json::error_handler_t::replace) + '\n');

  const RareCounts& rare = st.counts.rare;
  if (rare.total() > 0)
    reporter.warn(fmt::format(
        "{} of {} camera samples were dropped: {} not a number, {} infinite, {} negative; the image lacks their light",
        rare.total(), st.counts.cameraRays, rare.nan, rare.infinite, rare.negative));
  if (stopped == Stop::kKeep)
    throw Error(ExitCode::kCancelled,
                fmt::format("cancelled after {} samples per pixel; the image so far is in {}", film.samples, output));
  reporter.event(
      {{"event", "done"}, {"path", output}, {"seconds", since(start)}, {"samples", film.samples}, {"stats", stats}});
  if (!reporter.json())
    fmt::print("{}: {} samples per pixel, {:.2f} s (pilot {:.2f} s), {} rays\n", output, film.samples,
               st.pilotSeconds + st.renderSeconds, st.pilotSeconds, stats["rays"]["total"].get<uint64_t>());
  return 0;
}

}  // namespace

Verb addRender(CLI::App& app) {
  auto o = std::make_shared<Options>();
  RenderSettings& s = o->settings;
  app.add_option("SCENE", o->scene, "a .glb or .gltf file")->required();
  app.add_option("-o,--output", o->output, "the EXR to write")->required()->check(named());
  app.add_option("--allocation", o->allocation, "how the samples of a hit are shared")
      ->check(among(kAllocations))
      ->capture_default_str();
  app.add_option("--weights", o->weights, "MIS weights; auto: what the paper pairs with the allocation")
      ->check(among(kWeights, {"auto"}))
      ->capture_default_str();
  app.add_option("--integrand", o->integrand, "specular and diffuse as separate integrals or as one")
      ->check(among(kIntegrands))
      ->capture_default_str();
  app.add_option("--integrator", o->integrator, "direct light only, or all of it")
      ->check(among(kIntegrators))
      ->capture_default_str();
  app.add_option("--sampler", o->sampler, "where the random numbers come from")
      ->check(among(kSamplers))
      ->capture_default_str();
  auto* spp = app.add_option("--spp", s.spp, "camera samples per pixel, the pilot's included")
                  ->check(CLI::Range(1u, 1u << 24))
                  ->capture_default_str();
  app.add_option("--time", s.seconds, "stop after this many seconds instead, the pilot's included")
      ->check(between(0.001, 1e7))
      ->excludes(spp);
  app.add_option("--samples-per-hit", s.samplesPerHit, "samples shared at the first hit")
      ->check(CLI::Range(1, kMaxSamplesPerHit))
      ->capture_default_str();
  app.add_option("--pilot-spp", s.pilotSpp, "camera samples per pixel that estimate the moments")
      ->check(CLI::Range(0u, 1u << 20))
      ->capture_default_str();
  app.add_option("--min-fraction", s.minFraction, "no technique gets less than this share")
      ->check(between(0.001, 0.5))
      ->capture_default_str();
  app.add_option("--cost", s.cost, "of a lobe, cosine and light sample, for --allocation auto")
      ->delimiter(',')
      ->check(CLI::Range(1e-3f, 1e6f))
      ->default_str("1,1,1");
  app.add_option("--max-depth", s.maxDepth, "surface hits of a path; 1 is direct light")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option("--filter", o->filter, "pixel filter")->check(among(kFilters, {"scene"}))->capture_default_str();
  app.add_option("--seed", s.seed, "another seed, another noise")->check(wholeNumber())->capture_default_str();
  app.add_option("--threads", s.threads, "0: all; the image does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  app.add_option("--resolution", o->resolution, "WIDTHxHEIGHT instead of the scene's");
  app.add_option("--layer", o->layer, "first part of the EXR's channel names")
      ->check(named(kLongestLayer))
      ->capture_default_str();
  app.add_option("--passes", o->passes, "of combined,depth,normal,albedo,variance,allocation (default: all)");
  app.add_option("--kernel", o->kernel, "general: with everything compiled in; the image is the same")
      ->check(CLI::IsMember({"auto", "general"}))
      ->capture_default_str();
  app.add_option("--stats", o->stats, "write statistics to this JSON file")->check(named());
  app.add_option("--progress", o->progress, "bar, json or none")
      ->check(CLI::IsMember({"auto", "bar", "json", "none"}))
      ->capture_default_str();
  app.add_option("--preview", o->preview, "rewrite this EXR with the image so far")->check(named());
  app.add_option("--preview-interval", o->previewInterval, "seconds between previews")
      ->check(between(0, 1e6))
      ->capture_default_str();
  app.add_flag("--watch-stdin", o->watchStdin, "stop when standard input is closed");
  return [o] { return run(*o); };
}

}  // namespace wardmis
