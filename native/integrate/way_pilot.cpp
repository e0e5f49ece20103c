// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/way_pilot.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/rel_mse.h"

namespace wardmis {
namespace {

constexpr int kSide = 4;                    // of a pilot's pixel, in pixels of the image
constexpr double kShare = 0.01;             // of the image's camera samples that it takes
constexpr uint32_t kLeast = 4, kMost = 64;  // samples of its own pixels

// Paths from the camera alone have more to share: techniques, lights that are hidden, pixels. What that gains in the
// mean over the scenes of docs/performance.md.
constexpr double kAlone = 1.6;

// By candidate.
using PerCandidate = std::array<double, WayCandidates::kCount>;

// The pilot's pixels, from which candidates are chosen.
class Tallied {
 public:
  Tallied(const WayTally& tally, const FilmBuffer& film, const Counts& counts)
      : candidates_(tally.candidates), width_(film.width), height_(film.height) {
    const auto n = tally.pixels.size();
    fixed_ = double(counts.cameraRays), light_ = kLightRayCost * double(counts.lightRays);
    std::vector<Pixel> own(n);
    for (size_t i = 0; i < n; ++i) {
      const WayTally::Pixel& p = tally.pixels[i];
      const double mean = double(luminance(absolute(film.mean(film.pixels[i]))));
      for (size_t c = 0; c < candidates_.size(); ++c)
        own[i].moment[c] = double(p.sums[c]) / (mean * mean + kRelMseEpsilon);
      own[i].rays = double(p.rays), own[i].joined = {double(p.joined[0]), double(p.joined[1])};
    }
    leaveOutWorst(own);
    smoothe(own);
  }

  // The candidate that is best for all.
  size_t forAll() const {
    size_t best = 0;
    for (size_t c = 1; c < candidates_.size(); ++c)
      if (product(c) < product(best)) best = c;
    return best;
  }
  double product(size_t c) const { return total(c).product(); }

  // The candidate of each pixel, with as many paths as `start` has: each the one of least share of all error and of all
  // cost, which is where their product cannot be lessened by one more change.
  std::vector<size_t> forEach(size_t start, double& product) const {
    std::vector<size_t> of(pixels_.size(), start);
    Sum all = total(start);
    for (int step = 0; step < 4; ++step) {
      tbb::parallel_for(size_t{0}, pixels_.size(), [&](size_t i) {
        double least = 0;
        for (size_t c = 0; c < candidates_.size(); ++c) {
          if (candidates_.at(c).paths != candidates_.at(start).paths) continue;
          const double each = pixels_[i].moment[c] / all.moment + cost(pixels_[i], c) / all.cost;
          if (least == 0 || each < least) least = each, of[i] = c;
        }
      });
      all = total([&](size_t i) { return of[i]; }, candidates_.at(start).paths);
    }
    product = all.product();
    return of;
  }

 private:
  struct Pixel {
    PerCandidate moment{};  // relative to the square of the pixel's mean
    double rays = 0;
    std::array<double, 2> joined{};
    bool counts = true;
  };
  struct Sum {
    double moment = 0, cost = 0;
    double product() const { return moment * cost; }
  };

  // What a candidate's numbers cost in one pixel, but for what all pixels have.
  double cost(const Pixel& p, size_t c) const {
    const WayCounts& w = candidates_.at(c);
    const double joins =
        w.paths > 0 ? kConnectionCost * (w.connections * p.joined[0] + w.laterConnections * w.atHit * p.joined[1]) : 0;
    return w.atHit * p.rays + joins;
  }
  template <class Of>
  Sum total(const Of& of, double paths) const {
    Sum s{0, fixed_ + paths * light_};
    for (size_t i = 0; i < pixels_.size(); ++i) s.moment += pixels_[i].moment[of(i)], s.cost += cost(pixels_[i], of(i));
    return s;
  }
  Sum total(size_t c) const {
    return total([c](size_t) { return c; }, candidates_.at(c).paths);
  }

  // Of the pixels the few with the most error by paths from the camera alone: what is rare and bright, and may be so
  // whatever the numbers are. As many as hold the worst thousandth of the image's.
  static void leaveOutWorst(std::vector<Pixel>& own) {
    const auto worst = static_cast<size_t>(0.001 * kSide * kSide * double(own.size()));
    std::vector<size_t> order(own.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(worst), order.end(),
                     [&](size_t a, size_t b) { return own[a].moment[0] > own[b].moment[0]; });
    for (size_t k = 0; k < worst; ++k) own[order[k]].counts = false;
  }

  // Means over the pixels around: one pixel's few samples know little.
  void smoothe(const std::vector<Pixel>& own) {
    constexpr int kRadius = 3;
    pixels_.resize(own.size());
    tbb::parallel_for(0, height_, [&](int y) {
      for (int x = 0; x < width_; ++x) {
        Pixel& to = pixels_[index(x, y)];
        double moments = 0, all = 0;
        for (int v = std::max(0, y - kRadius); v <= std::min(height_ - 1, y + kRadius); ++v)
          for (int u = std::max(0, x - kRadius); u <= std::min(width_ - 1, x + kRadius); ++u) {
            const Pixel& p = own[index(u, v)];
            to.rays += p.rays, to.joined[0] += p.joined[0], to.joined[1] += p.joined[1];
            ++all;
            if (!p.counts) continue;
            ++moments;
            for (size_t c = 0; c < to.moment.size(); ++c) to.moment[c] += p.moment[c];
          }
        to.rays /= all, to.joined[0] /= all, to.joined[1] /= all;
        for (double& m : to.moment) m /= std::max(moments, 1.0);
      }
    });
  }
  size_t index(int x, int y) const {
    return static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
  }

  const WayCandidates& candidates_;
  int width_, height_;
  std::vector<Pixel> pixels_;
  double fixed_ = 0, light_ = 0;  // rays of the camera; of one path from the lights for each pixel
};

// Numbers of the least predicted second moment x cost, for all pixels and then for each.
template <size_t K>
void choose(const WayTally& tally, const FilmBuffer& film, const RenderSetup<K>& setup, WayChoice& choice) {
  const Tallied tallied(tally, film, choice.pilot);
  const WayCandidates& candidates = tally.candidates;
  std::vector<size_t> best;
  double least = 0;
  for (size_t c = 1; c < candidates.size(); ++c) {  // the best of each number of paths
    bool isBest = true;
    for (size_t d = 1; d < candidates.size(); ++d)
      if (candidates.at(d).paths == candidates.at(c).paths && tallied.product(d) < tallied.product(c)) isBest = false;
    if (!isBest) continue;
    double product = 0;
    std::vector<size_t> of = tallied.forEach(c, product);
    if (best.empty() || product < least) best = std::move(of), least = product;
  }
  if (!(least > 0)) return;
  const double gain = tallied.product(0) / least;
  if (gain < kAlone) return;
  choice.gain = gain;
  choice.map.side = kSide, choice.map.width = film.width;
  WayCounts sum{0, candidates.at(best.front()).paths, 0, 0};
  for (const size_t c : best) {
    const WayCounts& w = candidates.at(c);
    const int samples = setup.samplesAtHit(w);
    choice.map.squares.push_back({samples, static_cast<int>(w.connections), static_cast<int>(w.laterConnections)});
    sum.atHit += w.atHit, sum.connections += w.connections, sum.laterConnections += w.laterConnections;
  }
  const auto n = double(best.size());
  choice.counts = {sum.atHit / n, sum.paths, sum.connections / n, sum.laterConnections / n};
}

// Numbers in proportion to the shares of an allocation, as many in all as with one of each that is asked for.
void share(const WayTally& tally, const FilmBuffer& film, const WayCounts& asked, bool toFilm, Allocation rule,
           double minimum, WayChoice& choice) {
  uint32_t groups = 1u << kByCamera;
  if (asked.connections > 0) groups |= 1u << kAtFirst;
  if (asked.laterConnections > 0) groups |= 1u << kAtLater;
  if (toFilm) groups |= 1u << kAtFilm;
  std::vector<double> means;
  for (const auto& p : film.pixels) means.push_back(double(luminance(absolute(film.mean(p)))));
  const auto shares = wayShares(rule, tally.moments, means, film.samples, groups, minimum);
  const double each = std::popcount(groups);
  choice.counts = {shares[kByCamera] * each, toFilm ? shares[kAtFilm] * each : 1, std::round(shares[kAtFirst] * each),
                   std::round(shares[kAtLater] * each)};
}

// How far each group is to be trusted, of each pixel from those around.
template <size_t K>
void trust(const WayTally& tally, const FilmBuffer& film, const RenderSetup<K>& setup, WayChoice& choice) {
  constexpr int kRadius = 3;
  const WayCounts& n = choice.counts;
  if (choice.map.squares.empty()) {
    const PixelWays all{setup.samplesAtHit(n), static_cast<int>(n.connections), static_cast<int>(n.laterConnections)};
    choice.map = {kSide, film.width, std::vector<PixelWays>(tally.groups.size(), all)};
  }
  const auto index = [&](int x, int y) {
    return static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x);
  };
  tbb::parallel_for(0, film.height, [&](int y) {
    for (int x = 0; x < film.width; ++x) {
      std::vector<const GroupSums*> around;
      for (int v = std::max(0, y - kRadius); v <= std::min(film.height - 1, y + kRadius); ++v)
        for (int u = std::max(0, x - kRadius); u <= std::min(film.width - 1, x + kRadius); ++u)
          around.push_back(&tally.groups[index(u, v)]);
      choice.map.squares[index(x, y)].trust = varianceAware(around, film.samples);
    }
  });
}

template <size_t K>
WayChoice chooseWays(RenderSetup<K>& setup, const WayCounts& asked, Allocation rule, bool aware, double minimum,
                     uint32_t expected, const std::function<bool()>& stopped) {
  const auto samples =
      static_cast<uint32_t>(std::clamp(kShare * double(expected) * kSide * kSide, double(kLeast), double(kMost)));
  FilmBuffer film = setup.film(kSide);
  WayTally tally;
  tally.pixels.resize(film.pixels.size());
  if (rule != Allocation::kAuto) tally.moments.resize(film.pixels.size());
  if (aware) tally.groups.resize(film.pixels.size());
  setup.beginWayNotes(tally, kSide, {1, 1, 1, 1}, nullptr);
  tbb::enumerable_thread_specific<Counts> counts;
  const auto own = [&]() -> Counts& { return counts.local(); };
  std::atomic<int> tiles{0};
  for (uint32_t s = 0; s < samples && !stopped(); ++s) {
    setup.traceLightOf(s, own);
    renderTiles<K>(setup, film, 1, nullptr, own, tiles, stopped);
    ++film.samples;
    tally.endSample();
  }
  setup.endWayNotes();
  WayChoice choice;
  for (const Counts& c : counts) choice.pilot += c;
  if (stopped()) return choice;
  if (rule == Allocation::kAuto)
    choose(tally, film, setup, choice);
  else if (needsMoments(rule))
    share(tally, film, asked, setup.input.light->toFilm, rule, minimum, choice);
  else
    choice.counts = asked;
  if (aware && choice.counts.paths > 0) trust(tally, film, setup, choice);
  return choice;
}

}  // namespace

template <size_t K>
WayChoice waysOf(const BuiltScene& built, const RenderSettings& settings, uint32_t expected,
                 const std::function<bool()>& stopped) {
  const bool aware = settings.weightRule() == Weights::kVarianceAware;
  if (!settings.bidirectional() || (!needsMoments(settings.allocation) && !aware)) return {};
  RenderSetup<K> setup(built, settings);
  if ((setup.needs & kNeedsConnections) == 0) return {};
  setup.drawFrom({SamplerType::kIndependent, ~settings.seed, 1});
  WayChoice choice = chooseWays<K>(setup, settings.fromLights.counts(), settings.allocation, aware,
                                   double(settings.minFraction), expected, stopped);
  choice.asked = true;
  return choice;
}

#define WARDMIS_INSTANTIATE(K) \
  template WayChoice waysOf<K>(const BuiltScene&, const RenderSettings&, uint32_t, const std::function<bool()>&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
