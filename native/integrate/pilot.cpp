// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/pilot.h"

#include <tbb/parallel_for.h>

#include <map>

namespace wardmis {

std::pair<HitMoments, CandidateSums> Pilot::smoothed(int x, int y) const {
  constexpr int kRadius = 3;  // 7 x 7 pixels
  const PilotPixel& center = pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  HitMoments m;
  CandidateSums sums;
  for (int v = std::max(0, y - kRadius); v <= std::min(height - 1, y + kRadius); ++v)
    for (int u = std::max(0, x - kRadius); u <= std::min(width - 1, x + kRadius); ++u) {
      const size_t neighbour = static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u);
      const PilotPixel& q = pixels[neighbour];
      if (!center.surface.holds(q.surface)) continue;
      m.specular += q.moments.specular;
      m.diffuse += q.moments.diffuse;
      if (!candidates.empty()) sums += candidates[neighbour];
    }
  return {m, sums};
}

std::vector<PixelFractions> Pilot::fractions(Allocation rule, Integrand integrand, TechniqueMask available,
                                             float minimum, const CandidateLists& lists, const SampleCost& cost) const {
  std::vector<PixelFractions> result(pixels.size());
  std::map<std::pair<int, uint32_t>, GainScatter> surfaces;  // by material and placement
  for (size_t i = 0; i < candidates.size(); ++i)
    surfaces[{pixels[i].surface.material, pixels[i].surface.placement}] += candidates[i];
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; ++x) {
      const auto [m, sums] = smoothed(x, y);
      const size_t index = static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      const TechniqueMask mask = available & pixels[index].techniques;
      auto& [surface, a] = result[index];
      surface = pixels[index].surface;
      if (rule == Allocation::kAuto) {
        a = chooseCandidate(sums, surfaces.at({surface.material, surface.placement}), lists.of(mask), cost);
        continue;
      }
      a = integrand == Integrand::kJoint ? allocate(rule, m.specular, mask, minimum)
                                         : allocateSplit(rule, m.specular, m.diffuse, mask, minimum);
    }
  });
  return result;
}

}  // namespace wardmis
