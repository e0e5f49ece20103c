// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/way_pilot.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "math/rel_mse.h"

namespace wardmis {
namespace {

constexpr int kSide = 4;                    // of a pilot's pixel, in pixels of the image
constexpr double kShare = 0.01;             // of the image's camera samples that it takes
constexpr uint32_t kLeast = 4, kMost = 64;  // samples of its own pixels

// What things cost, in rays that camera paths follow: as times in blend/ajar.blend have it.
constexpr double kJoined = 1.2;    // a connection: two surfaces are asked, and often a ray
constexpr double kLightRay = 2.2;  // of a path from a light: the surface is asked from both sides

}  // namespace

template <size_t K>
WayChoice chooseWays(RenderSetup<K>& setup, uint32_t expected, const std::function<bool()>& stopped) {
  const WayCandidates candidates;
  const auto samples =
      static_cast<uint32_t>(std::clamp(kShare * double(expected) * kSide * kSide, double(kLeast), double(kMost)));
  FilmBuffer film = setup.film(kSide);
  std::vector<WaySums> sums(film.pixels.size());
  setup.beginWayPilot(candidates, sums, kSide);
  tbb::enumerable_thread_specific<Counts> counts;
  const auto own = [&]() -> Counts& { return counts.local(); };
  std::atomic<int> tiles{0};
  for (uint32_t s = 0; s < samples && !stopped(); ++s) {
    setup.traceLightOf(s, own);
    renderTiles<K>(setup, film, 1, nullptr, own, tiles, stopped);
    ++film.samples;
  }
  setup.endWayPilot();
  WayChoice choice;
  for (const Counts& c : counts) choice.pilot += c;
  if (stopped()) return choice;

  std::array<double, WayCandidates::kCount> moment{};
  for (size_t i = 0; i < sums.size(); ++i) {
    const double mean = double(luminance(absolute(film.mean(film.pixels[i]))));
    for (size_t c = 0; c < moment.size(); ++c) moment[c] += double(sums[i][c]) / (mean * mean + kRelMseEpsilon);
  }
  const Counts& n = choice.pilot;
  const double camera = double(n.cameraRays), atHits = double(Counts::sum(n.rays)), light = double(n.lightRays);
  const auto cost = [&](const WayCounts& w) {
    const double joins =
        w.paths > 0
            ? kJoined * (w.connections * double(n.joined[0]) + w.laterConnections * w.atHit * double(n.joined[1]))
            : 0;
    return camera + w.atHit * atHits + joins + kLightRay * w.paths * light;
  };
  double least = 0;
  for (size_t c = 0; c < candidates.size(); ++c) {
    const double product = moment[c] * cost(candidates.at(c));
    if (c == 0 || product < least) least = product, choice.counts = candidates.at(c);
  }
  if (least > 0) choice.gain = moment[0] * cost(candidates.at(0)) / least;
  return choice;
}

#define WARDMIS_INSTANTIATE(K) \
  template WayChoice chooseWays<K>(RenderSetup<K>&, uint32_t, const std::function<bool()>&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
