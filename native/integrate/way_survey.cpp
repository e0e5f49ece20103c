// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/way_survey.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "integrate/way_pilot.h"
#include "math/rel_mse.h"

namespace wardmis {
namespace {

template <size_t K>
WaySurvey surveyWith(const BuiltScene& built, const RenderSettings& settings, uint32_t samples, int across,
                     const std::function<bool()>& stopped) {
  WaySurvey survey;
  const WayChoice choice = waysOf<K>(built, settings, settings.spp, stopped);
  if (choice.asked && !(choice.counts.paths > 0)) return survey;
  RenderSetup<K> setup(built, settings);
  if ((setup.needs & kNeedsConnections) == 0) return survey;
  const FromLights& asked = settings.fromLights;
  survey.counts = choice.asked ? choice.counts
                               : WayCounts{1, asked.paths, double(asked.connections), double(asked.laterConnections)};
  const Film& frame = built.scene.film;
  const int side = std::max(1, (frame.x1 - frame.x0 + across - 1) / across);
  FilmBuffer film = setup.film(side);
  WayTally tally;
  tally.pixels.resize(film.pixels.size());
  tally.images.emplace(film.pixels.size(), settings.maxDepth);
  setup.drawFrom({SamplerType::kIndependent, settings.seed, 1});
  setup.beginWayNotes(tally, side, survey.counts, choice.map.squares.empty() ? nullptr : &choice.map);
  tbb::enumerable_thread_specific<Counts> counts;
  const auto own = [&]() -> Counts& { return counts.local(); };
  std::atomic<int> tiles{0};
  for (; survey.samples < samples && !stopped(); ++survey.samples) {
    setup.traceLightOf(survey.samples, own);
    renderTiles<K>(setup, film, 1, nullptr, own, tiles, stopped);
    ++film.samples;
    tally.endSample();
  }
  setup.endWayNotes();
  survey.width = film.width, survey.height = film.height;
  double variance = 0, cost = 0;
  for (int n = 1; n <= tally.images->surfaces(); ++n)
    for (int k = 0; k <= n; ++k) {
      const size_t at = WayImages::index(n, k);
      WaySurvey::Way way{n, k, tally.images->weighted(at), tally.images->alone(at)};
      const std::vector<double> each = tally.images->variance(at);
      for (size_t i = 0; i < each.size(); ++i) {
        const double mean = double(luminance(absolute(film.mean(film.pixels[i]))));
        way.variance += each[i] / (mean * mean + kRelMseEpsilon);
      }
      way.samples = tally.images->tried(at);
      way.cost = way.samples * (k == n ? 1 : k == 0 ? kLightRayCost : kConnectionCost);
      variance += way.variance, cost += way.cost;
      survey.ways.push_back(std::move(way));
    }
  for (WaySurvey::Way& way : survey.ways)
    way.variance /= std::max(variance, 1e-300), way.cost /= std::max(cost, 1e-300);
  return survey;
}

}  // namespace

WaySurvey surveyWays(const BuiltScene& built, const RenderSettings& settings, uint32_t samples, int across,
                     const std::function<bool()>& stopped) {
  WaySurvey survey;
  withThreads(settings.threads, [&] {
    survey = withTechniques(built.lobes(),
                            [&](auto k) { return surveyWith<k()>(built, settings, samples, across, stopped); });
  });
  return survey;
}

}  // namespace wardmis
