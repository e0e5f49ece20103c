// SPDX-License-Identifier: GPL-3.0-or-later
// One case of the study: the scattering integral of the paper's sections 3 and 4 at one outgoing direction,
//   full    L = integral over the hemisphere of f_r(wi, wo) R cos(theta_i) cos(theta_i) dwi
//   planar  the paper's reduction to x = cos(theta_i) in [0, 1], phi integrated as 2 pi: F(x) = 2 pi R f_r(x) x^2.
//           No radiance: it is far too bright where theta_o > 0 (docs/theory.md).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace wardmis {

enum class StudyBrdf : uint8_t { kLafortunePhong, kWard, kWardDur, kWardGmd };
enum class StudyMode : uint8_t { kFull, kPlanar };
inline constexpr size_t kStudyTechniques = 3;
enum class StudyTechnique : uint8_t { kLobe, kCosine, kUniform };  // the BRDF's own lobe; cos/pi; 1/(2 pi)

struct StudyInput {
  StudyBrdf brdf = StudyBrdf::kWard;
  StudyMode mode = StudyMode::kFull;
  double alphaX = 0.1, alphaY = 0.1;  // Ward
  double m = 10;                      // Lafortune and Phong's exponent
  double thetaO = 60, phiO = 0;       // degrees
  double rhoD = 0, rhoS = 1, R = 1;
  bool joint = false;  // the diffuse part inside the integrand; else apart, known exactly
  std::vector<StudyTechnique> techniques{StudyTechnique::kLobe, StudyTechnique::kCosine};

  bool ward() const { return brdf != StudyBrdf::kLafortunePhong; }
  double diffusePart() const { return joint ? 0 : 2.0 / 3.0 * rhoD * R; }  // of L_o, added to the integral

  // Throws Error (usage) on what makes no sense.
  void check() const;
};

std::string_view name(StudyBrdf);
std::string_view name(StudyMode);
std::string_view name(StudyTechnique);

// The golden file's key `input`.
nlohmann::json toJson(const StudyInput&);
StudyInput studyInputFromJson(const nlohmann::json&);

}  // namespace wardmis
