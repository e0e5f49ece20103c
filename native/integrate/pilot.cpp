// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/pilot.h"

#include <tbb/parallel_for.h>

#include <bit>
#include <map>

namespace wardmis {

template <size_t K>
std::vector<PixelFractions<K>> Pilot<K>::fractions(Allocation rule, Integrand integrand, TechniqueMask available,
                                                   float minimum, const CandidateLists<K>& lists,
                                                   const SampleCost<K>& cost, int samplesPerHit) const {
  std::vector<PixelFractions<K>> result(pixels.size());
  std::map<std::pair<int, uint32_t>, SurfaceScatter<K>> surfaces;  // by material and placement
  for (size_t i = 0; i < candidates.size(); ++i)
    surfaces[{pixels[i].surface.material, pixels[i].surface.placement}] += candidates[i];
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const TechniqueMask mask = available & pixels[index(x, y)].techniques;
      auto& [surface, a, samples] = result[index(x, y)];
      surface = pixels[index(x, y)].surface;
      samples = samplesPerHit;
      if (rule == Allocation::kAuto) {
        const CandidateSums<K> sums = smoothed(candidates, x, y);
        const SurfaceScatter<K>& all = surfaces.at({surface.material, surface.placement});
        a = chooseCandidate(sums, all, lists.of(mask), cost);
        const int few = std::max(2, std::popcount(mask));  // one of each technique: counts that vary are noise, too
        if (samples > few && suffice(few, sums, all)) samples = few, a = restrict<K>({}, mask);
        continue;
      }
      const HitMoments<K> m = smoothed(moments, x, y);
      a = integrand == Integrand::kJoint ? allocate<K>(rule, m.of[0], mask, minimum)
                                         : allocateSplit<K>(rule, m.of, mask, minimum);
    }
  });
  return result;
}

#define WARDMIS_INSTANTIATE(K) template struct Pilot<K>;
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
