// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/setup.h"

#include <fmt/format.h>
#include <tbb/blocked_range2d.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "integrate/light_tracer.h"
#include "math/error.h"

namespace wardmis {
namespace {

constexpr int kTileSize = 16;

const Scene& renderable(const Scene& scene) {
  if (!scene.camera)
    throw Error(ExitCode::kScene, scene.path + ": the scene has no camera", "add a camera, or make one active");
  requireMemoryFor(scene);
  return scene;
}

int tilesAcross(int pixels) { return (pixels + kTileSize - 1) / kTileSize; }

// Whether rays of the surface's techniques can find light.
bool surfaceRays(const Emitters& e, uint32_t needs) {
  return e.anyShared() || e.anySky() || e.anyStrands() || (needs & kNeedsBounces) != 0;
}

// Whether there is light that takes away from other light, or a surface that light goes through turns it so.
bool negativeLight(const Scene& scene) {
  const auto negative = [](Rgb c) { return c.x < 0 || c.y < 0 || c.z < 0; };
  const auto texels = [&](int texture) {
    if (texture < 0) return false;
    const auto& floats = scene.images[static_cast<size_t>(scene.textures[static_cast<size_t>(texture)].image)].floats;
    return std::any_of(floats.begin(), floats.end(), [](float x) { return x < 0; });
  };
  // what a program makes may be anything
  for (const Light& l : scene.lights)
    if (negative(l.emitted) || l.program) return true;
  for (const Material& m : scene.materials)
    if (negative(m.emission.value) || m.emission.result >= 0 ||
        (!isBlack(m.emission.value) && texels(m.emission.texture.texture)))
      return true;
  for (const Material& m : scene.materials)
    for (const Closure& c : m.closures)
      if (c.type == ClosureType::kTransparent &&
          (negative(c.colors[0].value) || c.colors[0].result >= 0 || texels(c.colors[0].texture.texture)))
        return true;
  for (const World& w : scene.worlds)
    if (negative(w.radiance) || w.program || (!isBlack(w.radiance) && texels(w.texture))) return true;
  return false;
}

template <size_t K>
TechniqueMask techniquesOf(const BuiltScene& built, uint32_t needs) {
  TechniqueMask mask = 0;
  if (built.emitters.any()) mask |= maskOf(Techniques<K>::kLight);
  if (!surfaceRays(built.emitters, needs)) return mask;
  if ((needs & kNeedsSpecular) != 0)
    for (size_t l = 0; l < built.geometry.lobes.used(); ++l) mask |= maskOf(l);
  if ((needs & kNeedsDiffuse) != 0) mask |= maskOf(Techniques<K>::kCosine);
  return mask;
}

template <size_t K>
Fractions<K> equalFractions(Integrand integrand, TechniqueMask techniques) {
  return integrand == Integrand::kJoint ? allocate<K>(Allocation::kEqual, {}, techniques, 0)
                                        : allocateSplit<K>(Allocation::kEqual, {}, techniques, 0);
}

template <size_t K>
SampleCost<K> givenCost(const GivenCost& given) {
  SampleCost<K> cost;
  cost.technique.fill(given.lobe);
  cost.technique[Techniques<K>::kCosine] = given.cosine, cost.technique[Techniques<K>::kLight] = given.light;
  return cost;
}

// Ways that cover each other share one integral.
Integrand integrandOf(const RenderSettings& s, uint32_t needs) {
  return (needs & kNeedsConnections) != 0 ? Integrand::kJoint : s.integrand;
}

// Variance-aware factors are of groups of ways, and come in beside these.
Weights hitWeights(const RenderSettings& s) {
  return s.weightRule() == Weights::kVarianceAware ? Weights::kBalance : s.weightRule();
}

std::optional<RenderScene> alone(const BuiltScene& built, const RenderScene& world, uint32_t needs) {
  if (!built.catchers) return std::nullopt;
  const BuiltScene::Catchers& c = *built.catchers;
  return RenderScene{world.scene,           c.geometry,        c.accel, c.emitters, surfaceRays(c.emitters, needs),
                     world.mostTransparent, world.mostFollowed};
}

// How many surfaces rays pass that are no shadow rays: up to version 4 one more than these, since 5 as many, but always
// one.
int mostFollowed(const Scene& scene, int mostTransparent) {
  const auto isNew = [](const Closure& c) { return c.version >= 5; };
  const bool any = std::any_of(scene.materials.begin(), scene.materials.end(), [&](const Material& m) {
    return m.transparent && std::any_of(m.closures.begin(), m.closures.end(), isNew);
  });
  return any ? std::max(mostTransparent, 1) : mostTransparent + 1;
}

}  // namespace

BuiltScene::BuiltScene(const Scene& s, int threads)
    : scene(renderable(s)),
      geometry((seconds = wallSeconds(), s)),
      environments(environmentsOf(s)),
      emitters(s, geometry, environments),
      accel(geometry, threads) {
  const auto catches = [](const Placement& p) { return p.shadowCatcher; };
  if (std::any_of(geometry.placements.begin(), geometry.placements.end(), catches)) {
    catchers = std::make_unique<Catchers>(scene, environments, threads);
    catchers->geometry.lobes = geometry.lobes;
  }
  seconds = wallSeconds() - seconds;
}

BuiltScene::Catchers::Catchers(const Scene& scene, const std::vector<Environment>& environments, int threads)
    : geometry(scene, true), emitters(scene, geometry, environments, true), accel(geometry, threads) {}

std::vector<std::string> BuiltScene::techniqueNames() const {
  return withTechniques(lobes(), [&](auto k) {
    constexpr size_t kLobes = Techniques<k()>::kLobes;
    std::vector<std::string> names(k());
    for (size_t l = 0; l < kLobes; ++l) names[l] = kLobes == 1 ? "lobe" : fmt::format("lobe {}", l + 1);
    const LobeNumbers& n = geometry.lobes;
    for (size_t c = 0; n.byClass && c < kLobeClasses; ++c)
      for (size_t i = 0; i < n.count[c]; ++i) {
        const std::string_view kind = name(static_cast<LobeClass>(c));
        names[n.first[c] + i] = n.count[c] == 1 ? std::string(kind) : fmt::format("{} {}", kind, i + 1);
      }
    names[Techniques<k()>::kCosine] = "cosine", names[Techniques<k()>::kLight] = "light";
    return names;
  });
}

uint32_t needs(const BuiltScene& built, const RenderSettings& s) {
  const bool connects = s.bidirectional() && noLightPaths(built.scene, built.geometry, built.emitters, s).empty();
  uint32_t n =
      wardmis::needs(built.scene, built.geometry, built.emitters, connects || s.integrand == Integrand::kJoint);
  if (s.limits().bounce((n & kNeedsLobes) != 0)) n |= kNeedsBounces;
  return connects ? n | kNeedsConnections : n;
}

std::vector<std::string> leftOut(const BuiltScene& built, const RenderSettings& s) {
  std::vector<std::string> all = leftOut(built.scene, needs(built, s), built.emitters);
  if (s.bidirectional())
    if (std::string none = noLightPaths(built.scene, built.geometry, built.emitters, s); !none.empty())
      all.push_back(std::move(none));
  return all;
}

uint32_t kernelNeeds(const BuiltScene& built, const RenderSettings& s) {
  const uint32_t all = needs(built, s), n = all & kKernelNeeds;
  if ((all & kNeedsConnections) != 0) return kKernelNeeds | kNeedsConnections;
  return s.generalKernel ? n | (kKernelNeeds & ~uint32_t{kNeedsLobes}) : n;
}

template <size_t K>
RenderSetup<K>::RenderSetup(const BuiltScene& built, const RenderSettings& s)
    : needs(wardmis::needs(built, s)),
      kernelNeeds(wardmis::kernelNeeds(built, s)),
      techniques(techniquesOf<K>(built, needs)),
      world_{built.scene,
             built.geometry,
             built.accel,
             built.emitters,
             surfaceRays(built.emitters, needs),
             (needs & kNeedsTransparency) != 0 ? s.maxTransparent : 0,
             mostFollowed(built.scene, s.maxTransparent)},
      catchers_(alone(built, world_, needs)),
      camera_(*built.scene.camera, built.scene.film),
      shutter_(built.scene.film.shutter.open, built.scene.film.shutter.rolling),
      filter_(built.scene.film.filter, built.scene.film.filterWidth),
      sampler_(s.sampler, s.seed, s.seconds > 0 ? 64 : s.spp),
      candidates_(s.samplesPerHit),
      input{world_,
            catchers_ ? &*catchers_ : nullptr,
            camera_,
            filter_,
            sampler_,
            nullptr,
            equalFractions<K>(integrandOf(s, needs), techniques),
            s.allocation,
            integrandOf(s, needs),
            hitWeights(s),
            candidates_,
            givenCost<K>(s.cost),
            s.samplesPerHit,
            s.limits(),
            built.geometry.moves() || camera_.moves() ? &shutter_ : nullptr,
            negativeLight(built.scene) ? -3.4e38f : 0.0f,
            built.scene.film.x0,
            built.scene.film.y0},
      kernel(tileKernel<K>(kernelNeeds)) {
  if ((needs & kNeedsConnections) == 0) return;
  emission_.emplace(built.emitters, built.geometry);
  light_.emplace(LightPaths{*emission_, {input.weights == Weights::kPower}});
  const PathLimits& limits = input.limits;
  light_->countsBounces = *std::min_element(limits.bounces.begin(), limits.bounces.end()) < limits.depth;
  input.light = &*light_;
  light_->toFilm = false;
  light_->verticesPerPath = verticesPerPath<K>(input);
  light_->toFilm = s.fromLights.film && camera_.seesBack();
  samplesPerHit_ = s.samplesPerHit;
  useWays(s.fromLights.counts(), nullptr);
}

template <size_t K>
void RenderSetup<K>::setPaths(double perPixel, int side) {
  const Film& f = world_.scene.film;
  const double pixels = double(pixelsAcross(f.x1 - f.x0, side)) * pixelsAcross(f.y1 - f.y0, side);
  light_->paths = static_cast<uint32_t>(std::max(std::round(perPixel * pixels), 1.0));
  light_->kept = std::min(light_->paths, kMostKeptPaths);
  light_->pixelsPerRay = double(side) * side;
  tracedLight_.reset();
}

template <size_t K>
int RenderSetup<K>::samplesAtHit(const WayCounts& counts) const {
  return std::max(1, static_cast<int>(std::round(counts.atHit * samplesPerHit_)));
}

template <size_t K>
void RenderSetup<K>::useWays(const WayCounts& counts, const WayMap* map) {
  input.samplesPerHit = map != nullptr ? samplesPerHit_ : samplesAtHit(counts);
  input.ways = map;
  light_->connections = static_cast<int>(std::ceil(counts.connections));
  light_->laterConnections = static_cast<int>(std::ceil(counts.laterConnections));
  setPaths(counts.paths, 1);
}

template <size_t K>
void RenderSetup<K>::beginWayNotes(WayTally& tally, int side, const WayCounts& counts, const WayMap* map) {
  useWays(counts, map);
  setPaths(counts.paths, side);
  input.side = side, input.light = &*light_;
  input.wayPilot = &tally;
}

template <size_t K>
void RenderSetup<K>::endWayNotes() {
  input.side = 1;
  input.wayPilot = nullptr;
}

template <size_t K>
void RenderSetup<K>::traceLightOf(uint32_t sample, const std::function<Counts&()>& counts) {
  if (input.light == nullptr || tracedLight_ == sample) return;
  traceLight<K>(input, sample, *light_, counts);
  tracedLight_ = sample;
}

template <size_t K>
FilmBuffer RenderSetup<K>::film(int side) const {
  const Film& f = world_.scene.film;
  FilmBuffer film(pixelsAcross(f.x1 - f.x0, side), pixelsAcross(f.y1 - f.y0, side), K);
  film.transparent = f.transparent;
  return film;
}

int tilesOf(const FilmBuffer& film) { return tilesAcross(film.width) * tilesAcross(film.height); }

template <size_t K>
void renderTiles(const RenderSetup<K>& setup, FilmBuffer& film, double samples, Pilot<K>* pilot,
                 const std::function<Counts&()>& counts, std::atomic<int>& tilesDone,
                 const std::function<bool()>& discard) {
  const double first = film.first + film.samples + film.partial;
  tbb::parallel_for(
      tbb::blocked_range2d<int>(0, tilesAcross(film.height), 1, 0, tilesAcross(film.width), 1),
      [&](const auto& range) {
        for (int ty = range.rows().begin(); ty != range.rows().end(); ++ty)
          for (int tx = range.cols().begin(); tx != range.cols().end(); ++tx) {
            if (discard && discard()) return;
            const Tile tile{tx * kTileSize,
                            ty * kTileSize,
                            std::min(film.width, (tx + 1) * kTileSize),
                            std::min(film.height, (ty + 1) * kTileSize),
                            first,
                            first + samples};
            setup.kernel(setup.input, tile, film, pilot, counts());
            ++tilesDone;
          }
      },
      tbb::simple_partitioner());
}

int threadsOf(int setting) { return setting > 0 ? setting : tbb::info::default_concurrency(); }

void withThreads(int threads, const std::function<void()>& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<size_t>(threadsOf(threads)));
  tbb::task_arena arena(threadsOf(threads));
  arena.execute(work);
}

double wallSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpuSeconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

#define WARDMIS_INSTANTIATE(K)                                                                                         \
  template struct RenderSetup<K>;                                                                                      \
  template void renderTiles<K>(const RenderSetup<K>&, FilmBuffer&, double, Pilot<K>*, const std::function<Counts&()>&, \
                               std::atomic<int>&, const std::function<bool()>&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
