// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/survey.h"

#include <tbb/enumerable_thread_specific.h>

#include <numeric>

namespace wardmis {
namespace {

template <size_t K>
float ratioOf(const Moments<K>& m, TechniqueMask used) {
  float least = 0, most = 0;
  int n = 0;
  for (size_t t = 0; t < K; ++t)
    if (has(used, t) && m.second(t) > 0) {
      least = n == 0 ? m.second(t) : std::min(least, m.second(t));
      most = std::max(most, m.second(t));
      ++n;
    }
  return n > 1 ? most / least : 0;
}

template <size_t K>
Survey surveyWith(const BuiltScene& built, const RenderSettings& settings, uint32_t samples) {
  RenderSettings s = settings;
  s.allocation = Allocation::kEqual;
  s.integrator = Integrator::kDirect;  // moments are those of the first hit
  s.spp = samples;
  Survey result;
  withThreads(s.threads, [&] {
    const RenderSetup<K> setup(built, s);
    FilmBuffer film = setup.film();
    Pilot<K> pilot(film.width, film.height, s.allocation);
    tbb::enumerable_thread_specific<Counts> counts;
    std::atomic<int> done{0};
    renderTiles<K>(setup, film, samples, &pilot, [&]() -> Counts& { return counts.local(); }, done, {});

    result.techniques = setup.techniques;
    result.techniqueNames = built.techniqueNames();
    result.pixels.resize(pilot.pixels.size());
    std::array<double, K> pixelsWith{};
    const bool joint = s.integrand == Integrand::kJoint;
    for (int y = 0; y < film.height; ++y)
      for (int x = 0; x < film.width; ++x) {
        const size_t from = static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x);
        const PilotPixel& p = pilot.pixels[from];
        SurveyPixel& to = result.pixels[static_cast<size_t>(film.height - 1 - y) * static_cast<size_t>(film.width) +
                                        static_cast<size_t>(x)];
        if (p.surface.material < 0) continue;
        const HitMoments<K> m = pilot.smoothed(pilot.moments, x, y);
        const TechniqueMask mask = setup.techniques & p.techniques;
        float stiffness = 0;
        for (size_t own = 0; own < (joint ? 1 : m.of.size()); ++own)
          stiffness = std::max(stiffness, ratioOf<K>(m.of[own], mask & techniquesFor<K>(s.integrand, own)));
        to = {p.surface.material, mask, p.surface.placement, stiffness};
        for (size_t t = 0; t < K; ++t) {
          if (!has(mask, t)) continue;
          pixelsWith[t] += 1;
          for (const Moments<K>& each : m.of) {
            if (!(each.hits > 0) || !(each.second(t) > 0)) continue;
            const double mean = std::accumulate(each.mean.begin(), each.mean.end(), 0.0) / each.hits;
            const double second = double(each.second(t)) / each.hits;
            result.secondMoment[t] += second;
            result.variance[t] += std::max(0.0, second - mean * mean);
          }
        }
      }
    for (size_t t = 0; t < K; ++t)
      if (pixelsWith[t] > 0) result.secondMoment[t] /= pixelsWith[t], result.variance[t] /= pixelsWith[t];
  });
  return result;
}

}  // namespace

Survey survey(const BuiltScene& built, const RenderSettings& settings, uint32_t samples) {
  return withTechniques(built.lobes(), [&](auto k) { return surveyWith<k()>(built, settings, samples); });
}

}  // namespace wardmis
