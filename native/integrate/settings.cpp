// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/settings.h"

#include "film/pixel_shares.h"

namespace wardmis {

PathLimits RenderSettings::limits() const {
  PathLimits limits;
  if (integrator == Integrator::kDirect) return limits;
  limits.depth = maxDepth;
  limits.bounces[kGlossyBounce] = maxGlossy, limits.bounces[kDiffuseBounce] = maxDiffuse;
  limits.bounces[kTransmissionBounce] = maxTransmission;
  return limits;
}

bool RenderSettings::sharesPixels() const {
  if (part || pixels == PixelSamples::kEven) return false;  // parts of an image do not know of each other
  if (bidirectional()) return false;                        // paths from the lights come for all pixels alike
  if (!open() && PixelSurvey::samplesFor(spp) == 0) return false;
  return pixels == PixelSamples::kByError || (allocation == Allocation::kAuto && sampler != SamplerType::kStratified);
}

std::string_view name(Integrator i) {
  constexpr std::string_view names[] = {"direct", "path", "bidirectional"};
  return names[static_cast<int>(i)];
}
std::string_view name(SamplerType s) {
  constexpr std::string_view names[] = {"independent", "stratified", "sobol"};
  return names[static_cast<int>(s)];
}
std::string_view name(PixelSamples p) {
  constexpr std::string_view names[] = {"even", "by-error", "auto"};
  return names[static_cast<int>(p)];
}
std::string_view name(FilterType f) {
  constexpr std::string_view names[] = {"box", "gaussian", "blackman-harris"};
  return names[static_cast<int>(f)];
}

}  // namespace wardmis
