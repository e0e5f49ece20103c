// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <chrono>
#include <cmath>

#include "bsdf/surface.h"
#include "study/cone_light.h"
#include "study/slope_disk.h"

namespace wardmis {

namespace {

using Check = StabilityCheck;
size_t at(Check c) { return static_cast<size_t>(c); }

// Geometric steps from lo to hi, both included.
std::vector<double> geometric(double lo, double hi, int steps) {
  std::vector<double> list;
  for (int i = 0; i <= steps; ++i) list.push_back(lo * std::pow(hi / lo, double(i) / steps));
  return list;
}

std::vector<double> alphas(bool thorough) {
  if (!thorough) return {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 1, 3, 10};
  return geometric(1e-6, 10, 28);
}
std::vector<double> thetas(bool thorough) {
  if (!thorough) return {0, 30, 60, 80, 89, 89.9, 89.99, 89.9999};
  return {0, 5, 15, 30, 45, 60, 70, 80, 85, 88, 89, 89.5, 89.9, 89.97, 89.99, 89.999, 89.9997, 89.9999};
}

// ---- one cell -------------------------------------------------------------------------------------------------------

Vec3<double> outgoing(const StabilityCell& cell) {
  const StudyInput& in = cell.input;
  if (cell.cosO < 0) return SlopeDisk(in.alphaX, in.alphaY, in.thetaO, in.phiO).wo();
  const double phi = in.phiO * (kPi<double> / 180), s = std::sqrt((1 - cell.cosO) * (1 + cell.cosO));
  return {s * std::cos(phi), s * std::sin(phi), cell.cosO};
}

bool samplesInFloat(const StudyInput& in, Vec3<double> wo) {
  Surface s;
  s.ax = static_cast<float>(in.alphaX), s.ay = static_cast<float>(in.alphaY);
  return !s.needsDouble(static_cast<float>(wo.z));
}

StabilityResult measure(const StabilityCell& cell, const StabilitySubject& subject, uint64_t seed, uint64_t index) {
  StabilityResult r;
  r.cell = cell;
  const StudyInput& in = cell.input;
  const WardVariant variant = wardVariant(in.brdf);
  const Vec3<double> wo = outgoing(cell);
  constexpr int kDirections = 100;
  const auto stream = [&](uint64_t use) { return Stream(seed, index * 8 + use); };
  r.single = measureErrors(subject.single, variant, wo, in.alphaX, in.alphaY, kDirections, stream(0));
  r.twice = measureErrors(subject.twice, variant, wo, in.alphaX, in.alphaY, kDirections, stream(1));
  if (cell.cosO >= 0) return r;

  LobeReport lobe;
  integrateLobe(subject.extended, in, lobe);
  lobe.single = samplesInFloat(in, wo);
  lobe.pDouble = chiSquareOfLobe(subject.twice, subject.extended, in, cell.sampler, stream(2), lobe.largestWeight);
  if (lobe.single)
    lobe.pSingle = chiSquareOfLobe(subject.single, subject.extended, in, cell.sampler, stream(3), lobe.largestWeight);
  r.lobe = lobe;
  const std::unique_ptr<Problem> problem =
      cell.lightAngle > 0 ? makeConeLight(in, cell.lightAngle) : subject.problem(in);
  r.estimators = measureEstimators(*problem, cell.samples, cell.trials, seed * 0x9e3779b97f4a7c15ull + index);
  return r;
}

// ---- verdicts -------------------------------------------------------------------------------------------------------

// Sidak: the level of one of n independent tests whose false alarms together have probability kFalseAlarms.
double levelOfOne(int n) { return -std::expm1(std::log1p(-threshold::kFalseAlarms) / std::max(1, n)); }

void judge(StabilityResult& r, const StabilityReport& report) {
  const auto verdict = [&](Check c, bool good) { r.checked[at(c)] = true, r.failed[at(c)] = !good; };
  const bool gmd = r.cell.input.brdf == StudyBrdf::kWardGmd;
  const auto special = [](const NumberErrors& e) { return e.nan + e.infinite + e.negative; };
  verdict(Check::kSpecial, special(r.single) + special(r.twice) == 0);
  verdict(Check::kErrorFloat, r.single.worstBounds() <= threshold::kBound);
  verdict(Check::kErrorDouble, r.twice.worstBounds() <= threshold::kBound);
  if (r.lobe) {
    const LobeReport& l = *r.lobe;
    verdict(Check::kDensity, std::abs(l.mass - (1 - l.below)) <= threshold::kDensity);
    verdict(Check::kChiSquare, std::min(l.pSingle, l.pDouble) >= report.chiSquareThreshold);
    verdict(Check::kWeight,
            gmd ? l.largestWeight <= threshold::kWeightGmd * (1 + 8 * 0x1p-23) : std::isfinite(l.largestWeight));
    verdict(Check::kAlbedo,
            gmd ? l.albedo >= 0 && l.albedo <= threshold::kAlbedoGmd : l.albedo >= 0 && std::isfinite(l.albedo));
  }
  if (r.estimators) {
    bool sound = true, biased = false, any = false;
    for (const StrategyReport& s : r.estimators->strategies) {
      sound &= s.sound;
      any |= s.measurable();
      biased |= s.measurable() && !(std::abs(s.z) <= report.zThreshold);
    }
    verdict(Check::kPrediction, sound);
    if (any) verdict(Check::kBias, !biased);
  }
}

}  // namespace

std::vector<StabilityCell> stabilityGrid(const StabilitySettings& settings) {
  const bool more = settings.thorough;
  std::vector<StabilityCell> cells;
  for (StudyBrdf brdf : settings.variants) {
    StabilityCell base;
    base.input.brdf = brdf;
    base.trials = more ? 1000 : 400;
    base.sampler = more ? 60000 : 20000;
    const auto add = [&](StabilityAxis axis, auto&& change) {
      StabilityCell cell = base;
      cell.axis = axis;
      change(cell);
      cells.push_back(cell);
    };
    // N, the longest first
    for (double n : {1048576.0, 65536.0, 4096.0, 256.0, 16.0, 4.0, 3.0, 2.0})
      for (const std::pair<double, double>& place :
           more ? std::vector<std::pair<double, double>>{{0.1, 60}, {0.01, 85}, {0.3, 89.9}, {1e-4, 30}, {3, 0}}
                : std::vector<std::pair<double, double>>{{0.1, 60}})
        add(StabilityAxis::kSamples, [&](StabilityCell& c) {
          c.input.alphaX = c.input.alphaY = place.first, c.input.thetaO = place.second;
          c.samples = int(n), c.trials = std::clamp(int(262144 / n), 2, 2000);
        });
    for (double alpha : alphas(more))
      for (double theta : thetas(more))
        add(StabilityAxis::kGrid,
            [&](StabilityCell& c) { c.input.alphaX = c.input.alphaY = alpha, c.input.thetaO = theta; });
    // anisotropy 1:10 to 1:1000, both ways about
    for (double ratio : more ? std::vector<double>{10, 30, 100, 300, 1000} : std::vector<double>{10, 1000})
      for (double alpha :
           more ? std::vector<double>{1e-6, 1e-5, 1e-4, 1e-3, 1e-2} : std::vector<double>{1e-6, 1e-4, 1e-2})
        for (double theta :
             more ? std::vector<double>{0, 60, 85, 89, 89.99, 89.9999} : std::vector<double>{60, 89.9999})
          for (double phi : more ? std::vector<double>{0, 37, 90} : std::vector<double>{0, 37})
            add(StabilityAxis::kAnisotropy, [&](StabilityCell& c) {
              c.input.alphaX = alpha, c.input.alphaY = alpha * ratio, c.input.thetaO = theta, c.input.phiO = phi;
            });
    // rho_d + rho_s = 1, as one integrand
    for (double rhoS :
         more ? std::vector<double>{1, 0.999, 0.9, 0.5, 0.1, 0.001, 1e-6} : std::vector<double>{0.999, 0.5, 0.001})
      for (double alpha : more ? geometric(1e-6, 10, 7) : std::vector<double>{1e-6, 1e-2, 1})
        for (double theta : more ? std::vector<double>{0, 60, 80, 89, 89.9999} : std::vector<double>{0, 80, 89.9999})
          add(StabilityAxis::kEnergy, [&](StabilityCell& c) {
            c.input.alphaX = c.input.alphaY = alpha, c.input.thetaO = theta;
            c.input.rhoS = rhoS, c.input.rhoD = 1 - rhoS, c.input.joint = true;
          });
    // half angles over ten decades, each at a radiance of twelve
    int turn = 0;
    for (double angle : geometric(1e-10, 1, more ? 40 : 10))
      for (double alpha : more ? geometric(1e-6, 10, 7) : std::vector<double>{1e-6, 1e-4, 1e-2, 0.3})
        add(StabilityAxis::kLight, [&](StabilityCell& c) {
          c.input.alphaX = c.input.alphaY = alpha, c.input.thetaO = 30, c.lightAngle = angle;
          c.input.R = std::pow(10.0, 3 * (turn++ % 5) - 6);
          c.input.techniques = {StudyTechnique::kLobe, StudyTechnique::kUniform};
        });
    // cosines that are denormal, or zero
    for (double cosO : {0.0, 4.9e-324, 1e-310, 1.4e-45, 5e-39, 1.2e-38, 1e-30, 1e-20, 1e-10})
      for (double alpha : alphas(more))
        for (double ratio : {1.0, 1000.0})
          add(StabilityAxis::kGrazing, [&](StabilityCell& c) {
            c.cosO = cosO, c.input.alphaX = alpha, c.input.alphaY = std::min(10.0, alpha * ratio), c.input.phiO = 37;
          });
  }
  return cells;
}

StabilityReport runStability(const std::vector<StabilityCell>& cells, const StabilitySettings& settings,
                             const StabilitySubject& subject) {
  const auto start = std::chrono::steady_clock::now();
  StabilityReport report;
  report.seed = settings.seed, report.thorough = settings.thorough;
  report.results.resize(cells.size());
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<size_t>(0, cells.size(), 1),
        [&](const auto& range) {
          for (size_t i = range.begin(); i != range.end(); ++i)
            report.results[i] = measure(cells[i], subject, settings.seed, i);
        },
        tbb::simple_partitioner{});
  });
  for (const StabilityResult& r : report.results) {
    if (r.lobe) report.chiSquareTests += r.lobe->single ? 2 : 1;
    if (r.estimators)
      for (const StrategyReport& s : r.estimators->strategies) report.biasTests += s.measurable() ? 1 : 0;
  }
  report.chiSquareThreshold = levelOfOne(report.chiSquareTests);
  report.zThreshold = zOf(levelOfOne(report.biasTests));
  for (StabilityResult& r : report.results) judge(r, report);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
}

bool StabilityResult::pass() const {
  for (bool f : failed)
    if (f) return false;
  return true;
}
bool StabilityReport::pass() const {
  for (const StabilityResult& r : results)
    if (!r.pass()) return false;
  return true;
}

std::string_view name(StabilityAxis a) {
  constexpr std::string_view names[] = {"grid", "anisotropy", "energy", "light", "samples", "grazing"};
  return names[static_cast<int>(a)];
}
std::string_view name(StabilityCheck c) {
  constexpr std::string_view names[] = {"special", "error-float", "error-double", "density", "chi-square",
                                        "weight",  "albedo",      "prediction",   "bias"};
  return names[static_cast<int>(c)];
}

}  // namespace wardmis
