// SPDX-License-Identifier: GPL-3.0-or-later
// Every lobe that surfaces are made of, Ward's among them, at random extremes of roughness, angle and index: whether
// its numbers are numbers, and float agrees with double.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "bsdf/lobe.h"

namespace wardmis {

namespace threshold {
// Error of float against double for the same float directions, over 1 + |ln pdf|: an error of so many roundings in the
// exponent is that of any formula. What is refracted adds the rounding of wo + eta wi, over the roughness or how far
// the facet is from not being seen, and of what Fresnel lets pass; Phong's that of the cosine, times the exponent.
inline constexpr double kLobePdf = 3e-5, kLobeValue = 3e-4, kRefraction = 2e-6, kPhong = 5e-7;
}  // namespace threshold

struct LobeStability {
  LobeKind kind = LobeKind::kLambert;
  uint64_t lobes = 0, inDouble = 0, compared = 0;  // those that the renderer has in double; float compared with that
  uint64_t bad = 0;       // directions, values, densities and weights that are NaN, negative, or may not be infinite
  uint64_t overflow = 0;  // densities and values beyond float, of sharp lobes: shown
  double pdf = 0, value = 0;  // largest errors, as shares of their limits
  double weight = 0;          // largest of a sample's
  std::string worst;          // the lobe and directions of the largest share, or of the first bad number

  bool pass() const { return bad == 0 && pdf <= 1 && value <= 1; }
};

struct LobeStabilitySettings {
  bool thorough = false;  // ten times as many
  uint64_t seed = 0;
  int threads = 0;
};
// What is tested: the renderer's own, or, in tests of these checks, one with a defect.
using EvaluateInFloat = std::function<LobeValue<float>(const Lobe&, Vec3f wi, Vec3f wo)>;
std::vector<LobeStability> runLobeStability(
    const LobeStabilitySettings&,
    const EvaluateInFloat& = [](const Lobe& l, Vec3f wi, Vec3f wo) { return evaluate(l, wi, wo); });

std::string_view name(LobeKind);

// One line a lobe, and as JSON.
std::string lobeStabilityTable(const std::vector<LobeStability>&);
nlohmann::json lobeStabilityJson(const std::vector<LobeStability>&);

}  // namespace wardmis
