// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the numbers hold in stiff and extreme cases: a sweep over alpha, theta_o, anisotropy, rho, light size,
// radiance, N and grazing directions, each cell with checks that pass or fail by the thresholds below (docs/theory.md
// says why these). Stiffness of a cell is the ratio of its largest to its smallest technique second moment.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "study/stability_estimators.h"
#include "study/stability_lobe.h"
#include "study/stability_numbers.h"

namespace wardmis {

// What the sweep varies; the other parameters stay at ordinary values.
enum class StabilityAxis : uint8_t { kGrid, kAnisotropy, kEnergy, kLight, kSamples, kGrazing };

enum class StabilityCheck : uint8_t {
  kSpecial,     // no NaN, negative value, or infinity where the exact value is finite
  kErrorFloat,  // f, pdf and weight against long double, in units of their bound
  kErrorDouble,
  kDensity,     // the pdf's integral over the hemisphere against 1 - P_below
  kChiSquare,   // the sampler against the pdf
  kWeight,      // largest sampling weight: at most 2 for ward-gmd, finite for all
  kAlbedo,      // at most 1 for ward-gmd; shown for the others
  kPrediction,  // fractions sum to 1, N Var finite and not negative
  kBias,        // mean of the trials against the integral
};
inline constexpr int kStabilityChecks = 9;

namespace threshold {
inline constexpr double kBound = 1;       // errors, in units of (12 + 8E) eps
inline constexpr double kDensity = 1e-9;  // absolute
inline constexpr double kWeightGmd = 2;   // times 1 + 8 eps
inline constexpr double kAlbedoGmd = 1 + 1e-9;
inline constexpr double kFalseAlarms = 1e-3;  // of all chi-square tests together, and of all bias tests together
}  // namespace threshold

struct StabilityCell {
  StabilityAxis axis = StabilityAxis::kGrid;
  StudyInput input;
  double lightAngle = 0;  // half angle of the cone light, radians; 0: the sky R cos(theta)
  double cosO = -1;       // grazing cells: cos(theta_o) as given; no integral there
  int samples = 64, trials = 400;
  int sampler = 100000;  // samples of the chi-square test
};

struct StabilityResult {
  StabilityCell cell;
  NumberErrors single, twice;      // float, double
  std::optional<LobeReport> lobe;  // none in grazing cells
  std::optional<EstimatorReport> estimators;
  std::array<bool, kStabilityChecks> checked{}, failed{};

  bool pass() const;
};

struct StabilityReport {
  std::vector<StabilityResult> results;
  double chiSquareThreshold = 0, zThreshold = 0;  // Sidak's, for threshold::kFalseAlarms
  int chiSquareTests = 0, biasTests = 0;
  uint64_t seed = 0;
  bool thorough = false;
  double seconds = 0;

  bool pass() const;
};

struct StabilitySettings {
  std::vector<StudyBrdf> variants{StudyBrdf::kWard, StudyBrdf::kWardDur, StudyBrdf::kWardGmd};
  bool thorough = false;  // ten times the work
  uint64_t seed = 0;
  int threads = 0;
};
std::vector<StabilityCell> stabilityGrid(const StabilitySettings&);

// What is tested: the renderer's own functions, or, in tests of these checks, others with a defect.
struct StabilitySubject {
  WardFunctions<float> single = WardFunctions<float>::own();
  WardFunctions<double> twice = WardFunctions<double>::own();
  WardFunctions<long double> extended = WardFunctions<long double>::own();
  std::function<std::unique_ptr<Problem>(const StudyInput&)> problem = makeProblem;
};
StabilityReport runStability(const std::vector<StabilityCell>&, const StabilitySettings&, const StabilitySubject& = {});

std::string_view name(StabilityAxis);
std::string_view name(StabilityCheck);

// The report as text, JSON, and heat maps over alpha and theta_o.
std::string stabilityTable(const StabilityReport&);
nlohmann::json stabilityJson(const StabilityReport&);
void plotStability(const StabilityReport&, const std::string& path);

}  // namespace wardmis
