// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/render.h"

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>
#include <thread>

#include "integrate/kernel.h"
#include "math/error.h"

namespace wardmis {
namespace {

constexpr int kTileSize = 16;

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}
// CPU time of all threads of the process.
double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Calls a function every quarter of a second from a thread of its own, until destroyed.
class Ticker {
 public:
  explicit Ticker(std::function<void()> f)
      : thread_([this, f = std::move(f)] {
          std::unique_lock lock(mutex_);
          while (!wake_.wait_for(lock, std::chrono::milliseconds(250), [this] { return done_; })) f();
        }) {}
  ~Ticker() {
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

 private:
  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::thread thread_;
};

// One render in progress: passes of whole tiles, each adding the same number of camera samples to every pixel.
class Run {
 public:
  Run(const RenderSettings& settings, const RenderObserver& observer, FilmBuffer& film, KernelInput& input,
      TileKernel kernel)
      : settings_(settings), observer_(observer), film_(film), input_(input), kernel_(kernel), start_(wallSeconds()) {}

  double seconds() const { return wallSeconds() - start_; }
  Stop stop() const { return observer_.stop != nullptr ? observer_.stop->load(std::memory_order_relaxed) : Stop::kNo; }
  bool stopped() const { return stop() != Stop::kNo; }

  // Adds `samples` to every pixel. A stop that keeps the image lets the pass end; one that discards it does not: false.
  bool pass(uint32_t samples, Pilot* pilot) {
    const int tilesX = (film_.width + kTileSize - 1) / kTileSize, tilesY = (film_.height + kTileSize - 1) / kTileSize;
    const double total = double(tilesX) * tilesY;
    std::atomic<int> done{0};
    const Ticker ticker([&] { report(pilot != nullptr, samples * done.load() / total); });
    tbb::parallel_for(
        tbb::blocked_range2d<int>(0, tilesY, 1, 0, tilesX, 1),
        [&](const auto& range) {
          for (int ty = range.rows().begin(); ty != range.rows().end(); ++ty)
            for (int tx = range.cols().begin(); tx != range.cols().end(); ++tx) {
              if (stop() == Stop::kDiscard) return;
              const Tile tile{tx * kTileSize,
                              ty * kTileSize,
                              std::min(film_.width, (tx + 1) * kTileSize),
                              std::min(film_.height, (ty + 1) * kTileSize),
                              film_.samples,
                              samples};
              kernel_(input_, tile, film_, pilot, counts_.local());
              ++done;
            }
        },
        tbb::simple_partitioner());
    if (stop() == Stop::kDiscard) return false;
    film_.samples += samples;
    return true;
  }

  // Passes until `target` samples or, with a time limit, until the next pass would end too late.
  void until(uint32_t target, Pilot* pilot) {
    uint32_t chunk = 1;
    while (film_.samples < target && !stopped()) {
      const double before = seconds();
      chunk = std::min(chunk, target - film_.samples);
      if (!pass(chunk, pilot)) return;
      const double now = seconds(), perSample = (now - before) / chunk;
      report(pilot != nullptr, 0);
      if (observer_.image && pilot == nullptr) observer_.image(film_);
      if (settings_.seconds > 0 && now + perSample > settings_.seconds) return;
      // passes of about half a second: long enough to cost nothing, short enough to watch
      double next = std::min({2.0 * chunk, std::max(1.0, 0.5 / std::max(perSample, 1e-9)), 4096.0});
      if (settings_.seconds > 0) next = std::min(next, std::max(1.0, (settings_.seconds - now) / perSample));
      chunk = static_cast<uint32_t>(next);
    }
  }

  Counts counts() {
    Counts sum;
    for (const Counts& c : counts_) sum += c;
    return sum;
  }

 private:
  // partial: samples of the running pass, in mean over the pixels.
  void report(bool pilot, double partial) {
    if (!observer_.progress) return;
    Progress p;
    p.pilot = pilot;
    p.samples = film_.samples;
    p.of = settings_.seconds > 0 ? 0 : settings_.spp;
    p.seconds = seconds();
    p.fraction = settings_.seconds > 0 ? std::min(1.0, p.seconds / settings_.seconds)
                                       : (film_.samples + partial) / settings_.spp;
    p.left = settings_.seconds > 0 ? std::max(0.0, settings_.seconds - p.seconds)
             : p.fraction > 0      ? p.seconds * (1 - p.fraction) / p.fraction
                                   : 0;
    observer_.progress(p);
  }

  const RenderSettings& settings_;
  const RenderObserver& observer_;
  FilmBuffer& film_;
  KernelInput& input_;
  TileKernel kernel_;
  double start_;
  tbb::enumerable_thread_specific<Counts> counts_;
};

FilmBuffer renderInArena(const Scene& scene, const RenderSettings& settings, Statistics& stats,
                         const RenderObserver& observer) {
  if (!scene.camera)
    throw Error(ExitCode::kScene, scene.path + ": the scene has no camera", "add a camera, or make one active");
  const double buildStart = wallSeconds();
  Geometry geometry(scene);
  const Environment environment(scene);
  const Emitters emitters(scene, geometry, environment);
  const Accel accel(geometry, settings.threads);
  stats.buildSeconds = wallSeconds() - buildStart;

  const bool joint = settings.integrand == Integrand::kJoint;
  uint32_t n = needs(scene, geometry, emitters, joint);
  if (settings.integrator == Integrator::kPath && settings.maxDepth > 1) n |= kNeedsBounces;
  stats.needs = n;
  stats.kernel = settings.generalKernel ? uint32_t{kKernelNeeds} : n & kKernelNeeds;
  stats.leftOut = leftOut(scene, n, emitters);
  stats.triangles = geometry.triangles;
  stats.instances = geometry.placements.size();
  stats.emissiveTriangles = emitters.emissiveTriangles();
  stats.threads = settings.threads > 0 ? settings.threads : tbb::info::default_concurrency();

  const bool surfaceRays = emitters.anyShared() || environment.exists() || (n & kNeedsBounces) != 0;
  if (emitters.any()) stats.techniques |= maskOf(kLight);
  if (surfaceRays && (n & kNeedsSpecular) != 0) stats.techniques |= maskOf(kLobe);
  if (surfaceRays && (n & kNeedsDiffuse) != 0) stats.techniques |= maskOf(kCosine);
  const uint32_t target = settings.seconds > 0 ? ~uint32_t{0} : settings.spp;
  // The pilot takes at most half of the samples; a render of one sample has none.
  const uint32_t pilotSpp = std::min(settings.pilotSpp, target / 2);
  stats.allocated = needsMoments(settings.allocation) && (n & kNeedsAllocation) != 0 && pilotSpp > 0;
  if (needsMoments(settings.allocation) && (n & kNeedsAllocation) != 0 && pilotSpp == 0)
    stats.leftOut.emplace_back("no samples for a pilot: counts are equal");

  const Film& film = scene.film;
  FilmBuffer buffer(film.x1 - film.x0, film.y1 - film.y0);
  const RenderScene world{scene, geometry, accel, emitters};
  const CameraRays camera(*scene.camera, film);
  const PixelFilter filter(film.filter, film.filterWidth);
  const Sampler sampler(settings.sampler, settings.seed, settings.seconds > 0 ? 64 : settings.spp);
  KernelInput input{world,
                    camera,
                    filter,
                    sampler,
                    nullptr,
                    {},
                    settings.allocation,
                    settings.integrand,
                    settings.weightRule(),
                    settings.cost,
                    settings.samplesPerHit,
                    settings.integrator == Integrator::kPath ? settings.maxDepth : 1,
                    emitters.any(),
                    surfaceRays,
                    film.x0,
                    film.y0};
  // Before the pilot, and for `equal`: the same count for every technique of an integral.
  const TechniqueMask available = stats.techniques;
  input.fractions =
      joint ? allocate(Allocation::kEqual, {}, available, 0) : allocateSplit(Allocation::kEqual, {}, {}, available, 0);

  Run run(settings, observer, buffer, input, tileKernel(stats.kernel));
  if (observer.started) observer.started(stats);
  const double cpuStart = cpuSeconds();
  std::vector<Fractions> perPixel;
  if (stats.allocated) {
    Pilot pilot(buffer.width, buffer.height, settings.allocation);
    run.until(pilotSpp, &pilot);
    if (!run.stopped()) {
      perPixel =
          pilot.fractions(settings.allocation, settings.integrand, available, settings.minFraction, settings.cost);
      input.perPixel = &perPixel;
    }
    stats.pilotSeconds = run.seconds();
    stats.pilotCpuSeconds = cpuSeconds() - cpuStart;
  }
  run.until(target, nullptr);
  stats.renderSeconds = run.seconds() - stats.pilotSeconds;
  stats.renderCpuSeconds = cpuSeconds() - cpuStart - stats.pilotCpuSeconds;
  stats.counts = run.counts();
  return buffer;
}

}  // namespace

FilmBuffer render(const Scene& scene, const RenderSettings& settings, Statistics& statistics,
                  const RenderObserver& observer) {
  const int threads = settings.threads > 0 ? settings.threads : tbb::info::default_concurrency();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  tbb::task_arena arena(threads);
  FilmBuffer film;
  arena.execute([&] { film = renderInArena(scene, settings, statistics, observer); });
  return film;
}

std::string_view name(Integrator i) { return i == Integrator::kDirect ? "direct" : "path"; }
std::string_view name(SamplerType s) {
  constexpr std::string_view names[] = {"independent", "stratified", "sobol"};
  return names[static_cast<int>(s)];
}
std::string_view name(FilterType f) {
  constexpr std::string_view names[] = {"box", "gaussian", "blackman-harris"};
  return names[static_cast<int>(f)];
}

}  // namespace wardmis
