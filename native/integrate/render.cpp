// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/render.h"

#include <tbb/enumerable_thread_specific.h>

#include <bit>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "integrate/cost.h"
#include "integrate/doubles.h"
#include "integrate/memory.h"
#include "integrate/setup.h"
#include "integrate/way_pilot.h"

namespace wardmis {
namespace {

constexpr uint32_t kLeastForPilot = 16;  // samples: the pilot of `auto` does not pay with fewer
constexpr uint32_t kUsualSamples = 64;
constexpr double kWatched = 0.5;  // seconds after which one wants to see more
constexpr uint32_t kMostParts = 64;
// Lights are drawn by what of them is hidden where that leaves less than this of the variance: a place in the table
// costs as much as 2 to 5 % of a sample.
constexpr double kHiddenPay = 0.8;
constexpr double kPilotTime = 1.0 / 16;  // of a time limit, for the pilot of `auto`
// What a sample of a coarse pilot costs, in samples of the image: its hits draw kSets of each technique.
constexpr double kCoarseSample = double(kSets) / (kCoarse * kCoarse);

uint32_t targetOf(const RenderSettings& s) { return s.seconds > 0 ? ~uint32_t{0} : s.spp; }
uint32_t countOf(const RenderSettings& s) { return s.seconds > 0 ? ~uint32_t{0} : s.range().count(); }
bool coarse(const RenderSettings& s) { return s.allocation == Allocation::kAuto; }
// Of a render of `target` samples: at most half of them, and none of one sample. A coarse one is no part of the image
// and is to cost little: at most a thirty-second of the render. It grows like the root of the samples: what a wrong
// choice costs grows with the samples that follow it, and falls with the pilot's.
uint32_t pilotOf(const RenderSettings& s, uint32_t target) {
  if (!coarse(s)) return std::min(s.pilotSpp, target / 2);
  const double growth =
      s.open() ? 1 : std::max(1.0, std::sqrt(target / double(kUsualSamples)));  // pilotSpp is for these
  const uint32_t most = target / kLeastForPilot;
  return static_cast<uint32_t>(std::min(s.pilotSpp * growth, double(most)));
}

// Calls a function every quarter of a second from a thread of its own, until finished or destroyed.
class Ticker {
 public:
  explicit Ticker(std::function<void()> f)
      : thread_([this, f = std::move(f)] {
          std::unique_lock lock(mutex_);
          try {
            while (!wake_.wait_for(lock, std::chrono::milliseconds(250), [this] { return done_; })) f();
          } catch (...) {
            failure_ = std::current_exception();
          }
        }) {}
  ~Ticker() { join(); }

  // From here on the function no longer runs. Throws what it threw, which ended its calls.
  void finish() {
    join();
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

 private:
  void join() {
    if (!thread_.joinable()) return;
    {
      const std::lock_guard lock(mutex_);
      done_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  bool done_ = false;
  std::exception_ptr failure_;
  std::thread thread_;
};

// One render in progress: passes over the whole image, each adding as many camera samples to every pixel, or to each
// what is its share of as many.
template <size_t K>
class Run {
 public:
  // before: what has been taken of the time.
  Run(const RenderSettings& settings, const RenderObserver& observer, RenderSetup<K>& setup, const Clocks& before)
      : settings_(settings), observer_(observer), setup_(setup), start_(now() - before) {}

  Clocks clocks() const { return now() - start_; }
  double seconds() const { return clocks().wall; }
  Stop stop() const { return observer_.stop != nullptr ? observer_.stop->load(std::memory_order_relaxed) : Stop::kNo; }
  bool stopped() const { return stop() != Stop::kNo; }

  // Adds `samples` to the image, which may be a part of one. A stop that keeps the image lets the pass end; one that
  // discards it does not: false.
  bool pass(double samples, Pilot<K>* pilot) {
    std::atomic<int> done{0};
    const double total = tilesOf(*film_);
    Ticker ticker([&] { report(pilot != nullptr, samples * done.load() / total); });
    const auto counts = [&]() -> Counts& { return counts_.local(); };
    setup_.traceLightOf(film_->first + film_->samples, counts);
    renderTiles(setup_, *film_, samples, pilot, counts, done, [&] { return stop() == Stop::kDiscard; });
    ticker.finish();  // it reads what is written now
    if (stop() == Stop::kDiscard) return false;
    const double now = film_->partial + samples;
    film_->samples += static_cast<uint32_t>(now);
    film_->partial = now - std::floor(now);
    return true;
  }

  // The same of whole samples, in parts where one of them takes so long that it is to be watched. False also where a
  // stop has left a sample in part.
  bool passes(uint32_t samples, Pilot<K>* pilot) {
    const double seconds = perSample_ * samples * costOf(pilot);
    // a power of two, whose fractions are exact
    const uint32_t parts =
        observer_.image && !settings_.part
            ? std::bit_ceil(static_cast<uint32_t>(std::clamp(seconds / kWatched, 1.0, double(kMostParts))))
            : 1;
    for (uint32_t k = 1; k <= parts; ++k) {
      if (!pass(double(samples) / parts, pilot)) return false;
      if (k == parts) break;
      show();
      if (stopped() && film_->samples > 0) return false;
    }
    return true;
  }

  // What is there so soon that one sees it at once: images of one sample for a square of pixels, each finer as long as
  // the next is ready in a moment. They are no part of the image, and not counted.
  void glance(const std::function<FilmBuffer(int side)>& filmOf, double pixels) {
    constexpr double kMoment = 0.25, kFirst = 1 << 13;  // seconds; samples
    int side = kCoarse;
    while (pixels / (side * side) > kFirst) side *= 2;
    while (side > kCoarse && !stopped()) {
      FilmBuffer film = filmOf(side);
      const double before = seconds();
      onto(film, 0, 1, side);
      if (!pass(1, nullptr)) return;
      perSample_ = (seconds() - before) * side * side;
      show();
      do side /= 2;
      while (side > kCoarse && perSample_ / (side * side) < 0.25 * kMoment);
      if (perSample_ / (side * side) > kMoment) break;
    }
    counts_.clear();
  }

  // Passes until `target` samples or, with a time limit, until the next pass would end too late.
  void until(uint32_t target, Pilot<K>* pilot) {
    uint32_t chunk = 1;
    const double limit = settings_.seconds * (apart_ > 0 && pilot != nullptr ? kPilotTime : 1);
    while (film_->samples < target && !over()) {
      const double before = seconds();
      chunk = std::min(chunk, target - film_->samples);
      if (setup_.input.light != nullptr) chunk = 1;  // whose paths from the lights are there
      if (observer_.checkpoint) {
        const uint32_t next = film_->samples == 0 ? 1 : 2 * std::bit_floor(film_->samples);
        chunk = std::min(chunk, next - film_->samples);
      }
      const bool ofImage = pilot == nullptr || apart_ == 0;
      if (settings_.targetError > 0 && ofImage)
        chunk = std::min(chunk, ErrorEstimate::next(film_->samples) - film_->samples);
      if (!passes(chunk, pilot)) return;
      if (settings_.targetError > 0 && ofImage) estimate();
      const double after = seconds(), perSample = (after - before) / chunk;
      perSample_ = perSample / costOf(pilot);
      report(pilot != nullptr, 0);
      if (ofImage) checkpoint();
      show();
      if (limit > 0 && after + perSample > limit) {
        timeIsUp_ = true;
        return;
      }
      // long enough to cost nothing, short enough to watch
      double next = std::min({2.0 * chunk, std::max(1.0, kWatched / std::max(perSample, 1e-9)), 4096.0});
      if (limit > 0) next = std::min(next, std::max(1.0, (limit - after) / perSample));
      chunk = static_cast<uint32_t>(next);
    }
  }

  // What is left of the time, which is too short for a sample of each pixel: one of so many pixels as there is time
  // for.
  void useTime() {
    constexpr double kLeast = 0.01;
    const double part = timeIsUp_ ? (settings_.seconds - seconds()) / perSample_ : 0;
    if (!(part > kLeast) || stopped() || isGoodEnough()) return;
    if (pass(std::min(part, 0.999), nullptr)) show();
  }

  // What follows is added to this film. apart: samples of a pilot on a film of its own, before the image's; each: what
  // one of these takes, in samples of the image; side: of the film's pixels, in the image's.
  void onto(FilmBuffer& film, uint32_t apart, double each, int side = 1) {
    film_ = &film, apart_ = apart, each_ = each;
    setup_.input.side = side;
    setup_.connectLights(side == 1);
    timeIsUp_ = false;
  }

  // Whether nothing more is wanted.
  bool over() const { return stopped() || isGoodEnough() || timeIsUp_; }

  const std::optional<EstimatedError>& error() const { return error_; }

  Counts counts() {
    Counts sum;
    for (const Counts& c : counts_) sum += c;
    return sum;
  }

 private:
  static Clocks now() { return {wallSeconds(), cpuSeconds()}; }

  // Tells the observer, whose time does not count.
  void checkpoint() {
    if (!observer_.checkpoint || (!std::has_single_bit(film_->samples) && film_->samples != settings_.spp)) return;
    const Clocks before = now();
    observer_.checkpoint(*film_, before - start_, counts());
    start_ += now() - before;
  }

  double costOf(const Pilot<K>* pilot) const { return pilot != nullptr && apart_ > 0 ? each_ : 1; }

  void show() {
    if (observer_.image) observer_.image(*film_, setup_.input.side);
  }

  void estimate() {
    if (ErrorEstimate::next(film_->samples - 1) != film_->samples) return;
    if (const auto error = estimate_.look(*film_)) error_ = error, lookedAt_ = film_->samples;
  }
  bool isGoodEnough() const { return error_ && error_->upper <= settings_.targetError; }

  // How far the render is by what it is to end after: samples, of which the pilot's are some, time or error. The last
  // is not known before there is an estimate; errors fall like 1/n.
  double fraction(double done, double extra, double time) const {
    const double bySamples = done / (double(countOf(settings_)) + extra),
                 byTime = settings_.seconds > 0 ? time / settings_.seconds : 0,
                 byError = error_ ? done / (lookedAt_ * error_->upper / settings_.targetError + extra) : 0;
    return std::min(1.0, std::max({bySamples, byTime, byError}));
  }

  // partial: samples of the running pass, in mean over the pixels.
  void report(bool pilot, double partial) {
    if (!observer_.progress || (setup_.input.side > 1 && !pilot)) return;
    Progress p;
    p.pilot = pilot;
    p.samples = film_->samples;
    p.of = settings_.open() ? 0 : countOf(settings_);
    p.seconds = seconds();
    const double extra = apart_ * each_, here = film_->samples + film_->partial + partial;
    const double done = !pilot ? here + extra : apart_ > 0 ? here * each_ : here;
    p.fraction = fraction(done, extra, p.seconds);
    if (settings_.targetError > 0 && !error_ && settings_.seconds <= 0)
      p.left = std::nullopt;
    else
      p.left = p.fraction > 0 ? p.seconds * (1 - p.fraction) / p.fraction : 0;
    observer_.progress(p);
  }

  const RenderSettings& settings_;
  const RenderObserver& observer_;
  RenderSetup<K>& setup_;
  FilmBuffer* film_ = nullptr;
  uint32_t apart_ = 0;
  double each_ = 0;
  ErrorEstimate estimate_;
  std::optional<EstimatedError> error_;
  uint32_t lookedAt_ = 0;
  double perSample_ = 0;   // seconds, of the last pass
  bool timeIsUp_ = false;  // but for a part of a sample
  Clocks start_;
  tbb::enumerable_thread_specific<Counts> counts_;
};

constexpr const char* kNoPilot = "too few samples for a pilot: counts are equal";

template <size_t K>
SampleCost<K> countedCost(const Counts& counts, int samplesPerHit) {
  SampleCost<K> cost;
  cost.hit = 1 / static_cast<float>(samplesPerHit);
  for (size_t t = 0; t < K; ++t)
    if (counts.samples[t] > 0)
      cost.technique[t] += static_cast<float>(double(counts.following[t]) / double(counts.samples[t]));
  return cost;
}

template <size_t K>
FilmBuffer renderWith(const BuiltScene& built, const RenderSettings& settings, const WayChoice& ways, Statistics& stats,
                      const RenderObserver& observer) {
  const Film& frame = built.scene.film;
  const Counts wayPilot = stats.pilotCounts;
  requireMemory(frame.x1 - frame.x0, frame.y1 - frame.y0, settings, built.lobes(), built.catchers != nullptr);
  RenderSetup<K> setup(built, settings);
  stats.buildSeconds = built.seconds;
  stats.needs = setup.needs;
  stats.kernel = setup.kernelNeeds;
  for (std::string& left : leftOut(built, settings)) stats.leftOut.push_back(std::move(left));
  if (const Doubles doubles = visibleDoubles(built); doubles.share >= kSharedPlaceIsTold)
    stats.doubts.push_back(doubles.told());
  stats.triangles = built.geometry.triangles;
  stats.instances = built.geometry.placements.size();
  stats.emissiveTriangles = built.emitters.emissiveTriangles();
  stats.threads = threadsOf(settings.threads);
  stats.techniques = setup.techniques;
  stats.techniqueNames = built.techniqueNames();
  if ((setup.needs & kNeedsConnections) != 0) {
    if (ways.counts.paths > 0) setup.useWays(ways.counts, ways.map.squares.empty() ? nullptr : &ways.map);
    stats.ways = ways.counts.paths > 0 ? ways.counts : settings.fromLights.counts();
    if (ways.map.squares.empty()) stats.ways->atHit = double(setup.input.samplesPerHit) / settings.samplesPerHit;
    stats.lightTracing = setup.input.light->toFilm;
  }
  const uint32_t target = targetOf(settings), pilotSpp = pilotOf(settings, target);
  const bool wanted = needsMoments(settings.allocation) && (setup.needs & kNeedsAllocation) != 0 &&
                      (setup.needs & kNeedsConnections) == 0;
  stats.allocated = wanted && pilotSpp > 0;
  if (wanted && pilotSpp == 0) stats.leftOut.emplace_back(kNoPilot);

  Run<K> run(settings, observer, setup, stats.wayPilot);
  stats.pilotSeconds = stats.wayPilot.wall, stats.pilotCpuSeconds = stats.wayPilot.cpu;
  if (observer.started) observer.started(stats);
  SampleCost<K>& cost = setup.input.cost;
  FractionsMap<K> map;
  std::optional<LightVisibility> lights;
  if (stats.allocated && settings.allocation == Allocation::kAuto && built.emitters.several())
    lights.emplace(*built.scene.camera, frame);
  const auto allocateFrom = [&](FilmBuffer& film, int side) {
    Pilot<K> pilot(film.width, film.height, settings.allocation);
    setup.drawLights(nullptr, lights ? &*lights : nullptr);
    if (settings.costFrom == CostFrom::kRays) {
      run.until(1, &pilot);
      cost = countedCost<K>(run.counts(), settings.samplesPerHit);
    }
    run.until(pilotSpp, &pilot);
    setup.drawLights(nullptr, nullptr);
    if (run.stopped()) return;
    if (const double left = lights ? lights->learn() : 1; left < kHiddenPay) {
      setup.drawLights(&*lights, nullptr);
      stats.hiddenLights = left;
    }
    map = {side, film.width,
           pilot.fractions(settings.allocation, settings.integrand, setup.techniques, settings.minFraction,
                           setup.input.candidates, cost, settings.samplesPerHit)};
    setup.input.perPixel = &map;
  };
  const auto pilotDone = [&] {
    const Clocks time = run.clocks();
    stats.cost.assign(cost.technique.begin(), cost.technique.end()), stats.costOfHit = cost.hit;
    stats.pilotSeconds = time.wall, stats.pilotCpuSeconds = time.cpu;
  };
  // A film with all that is shown of it.
  const auto filmOf = [&](int side) {
    FilmBuffer film = setup.film(side);
    if (settings.data) film.data.resize(film.pixels.size());
    if (settings.light) film.light.resize(film.pixels.size());
    return film;
  };
  if (observer.image) run.glance(filmOf, double(frame.x1 - frame.x0) * (frame.y1 - frame.y0));
  if (stats.allocated && settings.costFrom == CostFrom::kMeasured) cost = measureCost(built, settings).perSample<K>();
  // A pilot that is no part of these samples is made alike for all parts of an image.
  const uint32_t first = settings.range().from, count = countOf(settings);
  stats.pilotKept = stats.allocated && !coarse(settings);
  const bool apart = stats.allocated && (coarse(settings) || first > 0 || count < pilotSpp);
  if (apart) {
    const int side = coarse(settings) ? kCoarse : 1;
    FilmBuffer film = filmOf(side);
    run.onto(film, pilotSpp, coarse(settings) ? kCoarseSample : 1, side);
    // fractions must not depend on the points that they are used for, nor a hit's two samples on each other
    const Sampler own = setup.input.sampler;
    if (coarse(settings)) setup.drawFrom({SamplerType::kIndependent, ~settings.seed, 1});
    allocateFrom(film, side);
    setup.drawFrom(own);
    pilotDone();
    stats.pilotCounts += run.counts();
    const double samples = settings.seconds * kCoarseSample * film.samples / stats.pilotSeconds;
    if (settings.seconds > 0 && samples < kLeastForPilot) {
      setup.input.perPixel = nullptr, stats.allocated = false;
      setup.drawLights(nullptr, nullptr);
      stats.hiddenLights = 1;
      stats.leftOut.emplace_back(kNoPilot);
    }
  }
  FilmBuffer buffer = filmOf(1);
  buffer.first = first;
  if (built.catchers) buffer.catchers.resize(buffer.pixels.size());
  run.onto(buffer, stats.allocated && apart ? pilotSpp : 0, coarse(settings) ? kCoarseSample : 1);
  if (stats.pilotKept && !apart) {
    allocateFrom(buffer, 1);
    pilotDone();
  } else if (stats.pilotKept && first < pilotSpp) {  // what is the pilot's in the whole image
    setup.input.perPixel = nullptr;
    run.until(std::min(pilotSpp - first, count), nullptr);
    setup.input.perPixel = &map;
  }
  // Where the number of samples is not known before, shares are as for a usual one.
  const uint32_t expected = settings.open() ? std::min(count, kUsualSamples) : count;
  if (const uint32_t surveyed = settings.sharesPixels() ? PixelSurvey::samplesFor(expected) : 0) {
    PixelSurvey survey;
    buffer.rays.resize(buffer.pixels.size());
    run.until(surveyed / 2, nullptr);
    survey.half(buffer);
    run.until(surveyed, nullptr);
    const bool enough = settings.seconds <= 0 || run.seconds() < 0.5 * settings.seconds;
    if (!run.over() && enough) buffer.shares = survey.shares(buffer, expected, stats.pixelGain);
    buffer.rays = {};
  }
  run.until(count, nullptr);
  run.useTime();
  const Clocks time = run.clocks();
  stats.renderSeconds = time.wall - stats.pilotSeconds;
  stats.renderCpuSeconds = time.cpu - stats.pilotCpuSeconds;
  stats.counts = wayPilot;
  stats.counts += run.counts();
  stats.error = run.error();
  return buffer;
}

FilmBuffer renderInArena(const BuiltScene& built, const RenderSettings& settings, Statistics& stats,
                         const RenderObserver& observer) {
  return withTechniques(built.lobes(), [&](auto k) {
    RenderSettings chosen = settings;
    const Clocks start{wallSeconds(), cpuSeconds()};
    const auto stopped = [&] { return observer.stop != nullptr && observer.stop->load() != Stop::kNo; };
    const WayChoice ways =
        waysOf<k()>(built, settings, settings.open() ? kUsualSamples : settings.spp, stopped);  // alike for all parts
    if (ways.asked) {
      if (!(ways.counts.paths > 0)) {
        chosen.integrator = Integrator::kPath;
        stats.leftOut.emplace_back("no paths from lights: a pilot says that paths from the camera alone are sooner");
      }
      stats.wayGain = ways.gain, stats.wayPilot = Clocks{wallSeconds(), cpuSeconds()} - start;
      stats.pilotCounts = ways.pilot;
    }
    return renderWith<k()>(built, chosen, ways, stats, observer);
  });
}

}  // namespace

double pilotApart(const RenderSettings& s) {
  return coarse(s) ? double(pilotOf(s, targetOf(s))) / (kCoarse * kCoarse) : 0;
}

FilmBuffer render(const BuiltScene& built, const RenderSettings& settings, Statistics& statistics,
                  const RenderObserver& observer) {
  FilmBuffer film;
  withThreads(settings.threads, [&] { film = renderInArena(built, settings, statistics, observer); });
  return film;
}

FilmBuffer render(const Scene& scene, const RenderSettings& settings, Statistics& statistics,
                  const RenderObserver& observer) {
  FilmBuffer film;
  withThreads(settings.threads, [&] {
    const BuiltScene built(scene, settings.threads);
    film = renderInArena(built, settings, statistics, observer);
  });
  return film;
}

}  // namespace wardmis
