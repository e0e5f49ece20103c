// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/pilot.h"

#include <tbb/parallel_for.h>

#include <map>

namespace wardmis {

std::vector<PixelFractions> Pilot::fractions(Allocation rule, Integrand integrand, TechniqueMask available,
                                             float minimum, const CandidateLists& lists, const SampleCost& cost) const {
  std::vector<PixelFractions> result(pixels.size());
  std::map<std::pair<int, uint32_t>, GainScatter> surfaces;  // by material and placement
  for (size_t i = 0; i < candidates.size(); ++i)
    surfaces[{pixels[i].surface.material, pixels[i].surface.placement}] += candidates[i];
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const TechniqueMask mask = available & pixels[index(x, y)].techniques;
      auto& [surface, a] = result[index(x, y)];
      surface = pixels[index(x, y)].surface;
      if (rule == Allocation::kAuto) {
        a = chooseCandidate(smoothed(candidates, x, y), surfaces.at({surface.material, surface.placement}),
                            lists.of(mask), cost);
        continue;
      }
      const HitMoments m = smoothed(moments, x, y);
      a = integrand == Integrand::kJoint ? allocate(rule, m.specular, mask, minimum)
                                         : allocateSplit(rule, m.specular, m.diffuse, mask, minimum);
    }
  });
  return result;
}

}  // namespace wardmis
