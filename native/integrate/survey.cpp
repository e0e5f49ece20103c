// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/survey.h"

#include <tbb/enumerable_thread_specific.h>

namespace wardmis {
namespace {

float ratioOf(const Moments& m, TechniqueMask used) {
  float least = 0, most = 0;
  int n = 0;
  for (int t = 0; t < kTechniques; ++t)
    if ((used >> t & 1u) != 0 && m.second(t) > 0) {
      least = n == 0 ? m.second(t) : std::min(least, m.second(t));
      most = std::max(most, m.second(t));
      ++n;
    }
  return n > 1 ? most / least : 0;
}

}  // namespace

Survey survey(const BuiltScene& built, const RenderSettings& settings, uint32_t samples) {
  RenderSettings s = settings;
  s.allocation = Allocation::kEqual;
  s.integrator = Integrator::kDirect;  // moments are those of the first hit
  s.spp = samples;
  Survey result;
  withThreads(s.threads, [&] {
    const RenderSetup setup(built, s);
    FilmBuffer film = setup.film();
    Pilot pilot(film.width, film.height, s.allocation);
    tbb::enumerable_thread_specific<Counts> counts;
    std::atomic<int> done{0};
    renderTiles(setup, film, samples, &pilot, [&]() -> Counts& { return counts.local(); }, done, {});

    result.techniques = setup.techniques;
    result.pixels.resize(pilot.pixels.size());
    std::array<double, kTechniques> pixelsWith{};
    const bool joint = s.integrand == Integrand::kJoint;
    for (int y = 0; y < film.height; ++y)
      for (int x = 0; x < film.width; ++x) {
        const size_t from = static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x);
        const PilotPixel& p = pilot.pixels[from];
        SurveyPixel& to = result.pixels[static_cast<size_t>(film.height - 1 - y) * static_cast<size_t>(film.width) +
                                        static_cast<size_t>(x)];
        if (p.surface.material < 0) continue;
        const HitMoments m = pilot.smoothed(pilot.moments, x, y);
        const TechniqueMask mask = setup.techniques & p.techniques;
        to = {p.surface.material, mask, p.surface.placement,
              joint ? ratioOf(m.specular, mask)
                    : std::max(ratioOf(m.specular, mask & kSpecularTechniques),
                               ratioOf(m.diffuse, mask & kDiffuseTechniques))};
        for (size_t t = 0; t < kTechniques; ++t) {
          if ((mask >> t & 1u) == 0) continue;
          pixelsWith[t] += 1;
          for (const Moments* each : {&m.specular, &m.diffuse}) {
            if (!(each->hits > 0) || !(each->second(static_cast<int>(t)) > 0)) continue;
            const double mean = (double(each->mean[0]) + each->mean[1] + each->mean[2]) / each->hits;
            const double second = double(each->second(static_cast<int>(t))) / each->hits;
            result.secondMoment[t] += second;
            result.variance[t] += std::max(0.0, second - mean * mean);
          }
        }
      }
    for (size_t t = 0; t < kTechniques; ++t)
      if (pixelsWith[t] > 0) result.secondMoment[t] /= pixelsWith[t], result.variance[t] /= pixelsWith[t];
  });
  return result;
}

}  // namespace wardmis
