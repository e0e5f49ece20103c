// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "study/gnuplot.h"
#include "study/stability.h"

namespace wardmis {

namespace {

using nlohmann::json;
using Check = StabilityCheck;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const double kLn10 = std::log(10.0);
size_t at(int i) { return static_cast<size_t>(i); }

// The value that a check judges: larger is worse.
double measured(const StabilityResult& r, Check c) {
  const auto special = [](const NumberErrors& e) { return double(e.nan + e.infinite + e.negative); };
  switch (c) {
    case Check::kSpecial:
      return special(r.single) + special(r.twice);
    case Check::kErrorFloat:
      return r.single.worstBounds();
    case Check::kErrorDouble:
      return r.twice.worstBounds();
    case Check::kDensity:
      return r.lobe ? std::abs(r.lobe->mass - (1 - r.lobe->below)) : kNaN;
    case Check::kChiSquare:
      return r.lobe ? -std::min(r.lobe->pSingle, r.lobe->pDouble) : kNaN;  // small p is worse
    case Check::kWeight:
      return r.lobe ? r.lobe->largestWeight : kNaN;
    case Check::kAlbedo:
      return r.lobe ? r.lobe->albedo : kNaN;
    case Check::kPrediction: {
      if (!r.estimators) return kNaN;
      double unsound = 0;
      for (const StrategyReport& s : r.estimators->strategies) unsound += s.sound ? 0 : 1;
      return unsound;
    }
    case Check::kBias: {
      double worst = kNaN;
      if (r.estimators)
        for (const StrategyReport& s : r.estimators->strategies)
          if (s.measurable() && !(std::abs(s.z) <= worst)) worst = std::abs(s.z);
      return worst;
    }
  }
  return kNaN;
}

struct Row {
  const char *what, *unit;
  std::string limit;
};
Row rowOf(Check c, const StabilityReport& report, bool gmd) {
  switch (c) {
    case Check::kSpecial:
      return {"NaN, infinite, negative", "values", "0"};
    case Check::kErrorFloat:
      return {"error in float", "of (12 + 8E) eps", fmt::format("{:g}", threshold::kBound)};
    case Check::kErrorDouble:
      return {"error in double", "of (12 + 8E) eps", fmt::format("{:g}", threshold::kBound)};
    case Check::kDensity:
      return {"pdf's integral - (1 - P_below)", "", fmt::format("{:g}", threshold::kDensity)};
    case Check::kChiSquare:
      return {"sampler against pdf, chi-square", "p", fmt::format(">= {:.2g}", report.chiSquareThreshold)};
    case Check::kWeight:
      return {"largest sampling weight", "", gmd ? fmt::format("{:g}", threshold::kWeightGmd) : "finite"};
    case Check::kAlbedo:
      return {"albedo at rho_s = 1", "", gmd ? "1" : "shown"};
    case Check::kPrediction:
      return {"fractions and N Var are numbers", "unsound", "0"};
    case Check::kBias:
      return {"bias of the estimators", "|z|", fmt::format("{:.2f}", report.zThreshold)};
  }
  return {"", "", ""};
}

std::string describe(const StabilityCell& c) {
  const StudyInput& in = c.input;
  std::string s = in.alphaX == in.alphaY ? fmt::format("alpha {:.3g}", in.alphaX)
                                         : fmt::format("alpha {:.3g}:{:.3g} phi_o {:g}", in.alphaX, in.alphaY, in.phiO);
  s += c.cosO >= 0 ? fmt::format(" cos_o {:.2g}", c.cosO) : fmt::format(" theta_o {:g}", in.thetaO);
  if (in.joint) s += fmt::format(" rho_s {:g}", in.rhoS);
  if (c.lightAngle > 0) s += fmt::format(" light {:.2g} R {:g}", c.lightAngle, in.R);
  if (c.axis == StabilityAxis::kSamples) s += fmt::format(" N {}", c.samples);
  return s;
}

std::string value(Check c, double x) {
  if (c == Check::kSpecial || c == Check::kPrediction) return fmt::format("{:.0f}", x);
  if (c == Check::kChiSquare) return fmt::format("{:.2g}", -x);
  return fmt::format("{:.3g}", x);
}

std::vector<const StabilityResult*> ofVariant(const StabilityReport& report, StudyBrdf brdf) {
  std::vector<const StabilityResult*> list;
  for (const StabilityResult& r : report.results)
    if (r.cell.input.brdf == brdf) list.push_back(&r);
  return list;
}

std::vector<StudyBrdf> variantsOf(const StabilityReport& report) {
  std::vector<StudyBrdf> list;
  for (StudyBrdf b : {StudyBrdf::kWard, StudyBrdf::kWardDur, StudyBrdf::kWardGmd})
    if (!ofVariant(report, b).empty()) list.push_back(b);
  return list;
}

std::string variantTable(const StabilityReport& report, StudyBrdf brdf) {
  const std::vector<const StabilityResult*> list = ofVariant(report, brdf);
  std::string out = fmt::format("{}: {} cells\n{:<33}{:>12} {:<17}{:>13}{:>7}{:>7}  {:<6}{}\n", name(brdf), list.size(),
                                "check", "worst", "", "limit", "cells", "failed", "", "the worst cell");
  for (int k = 0; k < kStabilityChecks; ++k) {
    const auto c = static_cast<Check>(k);
    const StabilityResult* worst = nullptr;
    int checked = 0, failed = 0;
    for (const StabilityResult* r : list) {
      if (!r->checked[at(k)]) continue;
      ++checked, failed += r->failed[at(k)] ? 1 : 0;
      // NaN is worse than any number
      if (worst == nullptr || !(measured(*r, c) <= measured(*worst, c))) worst = r;
    }
    if (worst == nullptr) continue;
    const Row row = rowOf(c, report, brdf == StudyBrdf::kWardGmd);
    out += fmt::format("{:<33}{:>12} {:<17}{:>13}{:>7}{:>7}  {:<6}{}\n", row.what, value(c, measured(*worst, c)),
                       row.unit, row.limit, checked, failed, failed == 0 ? "pass" : "FAIL",
                       c == Check::kSpecial && failed == 0 ? "" : describe(worst->cell));
  }
  uint64_t underflow[2] = {0, 0}, overflow[2] = {0, 0}, values[2] = {0, 0};
  double stiffness = 0, relative[2] = {0, 0};
  int above = 0;
  const StabilityResult* stiffest = nullptr;
  for (const StabilityResult* r : list) {
    for (int t = 0; t < 2; ++t) {
      const NumberErrors& e = t == 0 ? r->single : r->twice;
      values[t] += e.values, underflow[t] += e.underflow, overflow[t] += e.overflow;
      relative[t] = std::max(relative[t], e.worstRelative());
    }
    above += r->lobe && r->lobe->albedo > 1 ? 1 : 0;
    if (r->estimators && r->estimators->logStiffness > stiffness) stiffness = r->estimators->logStiffness, stiffest = r;
  }
  for (int t = 0; t < 2; ++t)
    out += fmt::format(
        "in {}: {} values; {} underflowed, as e^-E or they themselves do, {} overflowed as they must; largest "
        "relative error {:.2g}\n",
        t == 0 ? "float" : "double", values[t], underflow[t], overflow[t], relative[t]);
  if (brdf != StudyBrdf::kWardGmd) out += fmt::format("albedo above 1, as this variant has it, in {} cells\n", above);
  if (stiffest != nullptr)
    out += fmt::format("stiffest: log10 of the second moments' ratio is {:.3g}, {}\n", stiffness / kLn10,
                       describe(stiffest->cell));
  return out;
}

std::string strategyTable(const StabilityReport& report) {
  struct Line {
    int cells = 0, measured = 0, equal = 0, failed = 0;
    double worst = 0;
    bool biased = false;
    std::string where;
  };
  std::vector<std::pair<std::string_view, Line>> lines;
  for (const Strategy& s : strategies()) lines.emplace_back(s.name, Line{});
  for (const StabilityResult& r : report.results) {
    if (!r.estimators) continue;
    for (const StrategyReport& s : r.estimators->strategies) {
      Line& line = lines[static_cast<size_t>(s.strategy - strategies().data())].second;
      ++line.cells, line.equal += s.equalCounts ? 1 : 0, line.biased = s.biased;
      if (s.equalCounts && line.where.empty())
        line.where = std::string(name(r.cell.input.brdf)) + " " + describe(r.cell);
      if (!s.measurable()) continue;
      ++line.measured, line.worst = std::max(line.worst, std::abs(s.z));
      line.failed += std::abs(s.z) <= report.zThreshold ? 0 : 1;
    }
  }
  std::string out = fmt::format("{:<28}{:>9}{:>15}{:>10}{:>8}{:>14}  {}\n", "strategy", "measured", "not measurable",
                                "worst |z|", "failed", "equal counts", "in, for example");
  for (const auto& [strategy, line] : lines) {
    if (line.cells == 0) continue;
    const std::string z = line.biased ? "O(1/N)" : line.measured > 0 ? fmt::format("{:.2f}", line.worst) : "-";
    out += fmt::format("{:<28}{:>9}{:>15}{:>10}{:>8}{:>14}  {}\n", strategy, line.measured, line.cells - line.measured,
                       z, line.failed, line.equal, line.where);
  }
  return out;
}

json number(double x) { return std::isfinite(x) ? json(x) : json(); }

json errorsJson(const NumberErrors& e) {
  const auto three = [](const std::array<double, 3>& a) {
    return json{{"f", number(a[0])}, {"pdf", number(a[1])}, {"weight", number(a[2])}};
  };
  return {{"values", e.values},
          {"nan", e.nan},
          {"infinite", e.infinite},
          {"negative", e.negative},
          {"underflow", e.underflow},
          {"overflow", e.overflow},
          {"relative_error", three(e.relative)},
          {"error_over_bound", three(e.bounds)}};
}

}  // namespace

std::string stabilityTable(const StabilityReport& report) {
  std::string out;
  for (StudyBrdf b : variantsOf(report)) out += variantTable(report, b) + "\n";
  out += strategyTable(report);
  out += fmt::format(
      "\nNot measurable: the trials' variance rests on fewer than {:g} events ({:g} where counts follow the samples), "
      "so that a\n"
      "technique that meets its light so rarely may have met none. False alarms: {:g} over all {} chi-square tests, "
      "and over all\n"
      "{} bias tests.\n",
      kEventsGiven, kEventsOwn, threshold::kFalseAlarms, report.chiSquareTests, report.biasTests);
  size_t failed = 0;
  for (const StabilityResult& r : report.results)
    if (!r.pass() && ++failed <= 20) {
      out += fmt::format("failed: {} {}:", name(r.cell.input.brdf), describe(r.cell));
      for (int k = 0; k < kStabilityChecks; ++k)
        if (r.failed[at(k)])
          out += fmt::format(" {} {}", name(static_cast<Check>(k)),
                             value(static_cast<Check>(k), measured(r, static_cast<Check>(k))));
      out += "\n";
    }
  if (failed > 20) out += fmt::format("and {} more\n", failed - 20);
  size_t pairs = 0;
  for (const StabilityResult& r : report.results) pairs += r.estimators ? r.estimators->strategies.size() : 0;
  out += fmt::format(
      "{}: {} of {} cells pass (the bias could be judged of {} of {} pairs of a strategy and a cell), seed {}, {:.1f} "
      "s\n",
      failed == 0 ? "PASS" : "FAIL", report.results.size() - failed, report.results.size(), report.biasTests, pairs,
      report.seed, report.seconds);
  return out;
}

json stabilityJson(const StabilityReport& report) {
  json cells = json::array();
  size_t failed = 0;
  for (const StabilityResult& r : report.results) {
    failed += r.pass() ? 0 : 1;
    const StabilityCell& c = r.cell;
    json j{{"axis", name(c.axis)}, {"input", toJson(c.input)}, {"pass", r.pass()}};
    if (c.cosO >= 0) j["cos_o"] = c.cosO;
    if (c.lightAngle > 0) j["light_half_angle"] = c.lightAngle;
    j["float"] = errorsJson(r.single), j["double"] = errorsJson(r.twice);
    for (int k = 0; k < kStabilityChecks; ++k)
      if (r.checked[at(k)]) j["checks"][std::string(name(static_cast<Check>(k)))] = !r.failed[at(k)];
    if (r.lobe)
      j["lobe"] = {{"pdf_integral", number(r.lobe->mass)},
                   {"P_below", number(r.lobe->below)},
                   {"albedo", number(r.lobe->albedo)},
                   {"quadrature_error", number(r.lobe->quadrature)},
                   {"largest_weight", number(r.lobe->largestWeight)},
                   {"samples", c.sampler},
                   {"chi_square_p_double", number(r.lobe->pDouble)},
                   {"chi_square_p_float", r.lobe->single ? number(r.lobe->pSingle) : json()}};
    if (r.estimators) {
      const EstimatorReport& e = *r.estimators;
      json second = json::array(), list = json::object();
      for (int i = 0; i < e.techniques; ++i) second.push_back(number(e.logSecond[at(i)] / kLn10));
      for (const StrategyReport& s : e.strategies) {
        json a = json::array();
        for (int i = 0; i < e.techniques; ++i) a.push_back(number(s.fractions[at(i)]));
        list[std::string(s.strategy->name)] = {{"fractions", a},
                                               {"nvar_log10", number(s.logVariance / kLn10)},
                                               {"sound", s.sound},
                                               {"equal_counts", s.equalCounts},
                                               {"bias_z", number(s.z)},
                                               {"measurable", s.measurable()},
                                               {"biased_by_design", s.biased},
                                               {"events", number(s.events)},
                                               {"variance", number(s.variance)}};
      }
      j["estimators"] = {{"samples", c.samples},
                         {"trials", c.trials},
                         {"integral", number(e.integral)},
                         {"quadrature_error", number(e.quadrature)},
                         {"stiffness_log10", number(e.logStiffness / kLn10)},
                         {"second_moment_log10", second},
                         {"strategies", list}};
    }
    cells.push_back(j);
  }
  return {{"pass", report.pass()},
          {"cells_failed", failed},
          {"seed", report.seed},
          {"thorough", report.thorough},
          {"seconds", report.seconds},
          {"thresholds",
           {{"error_over_bound", threshold::kBound},
            {"pdf_integral", threshold::kDensity},
            {"weight_ward_gmd", threshold::kWeightGmd},
            {"albedo_ward_gmd", threshold::kAlbedoGmd},
            {"false_alarms", threshold::kFalseAlarms},
            {"chi_square_p", report.chiSquareThreshold},
            {"bias_z", report.zThreshold},
            {"events_given", kEventsGiven},
            {"events_own", kEventsOwn}}},
          {"chi_square_tests", report.chiSquareTests},
          {"bias_tests", report.biasTests},
          {"cells", cells}};
}

namespace {

// For a cell of a heat map: two digits, whole numbers from 10, and 12k, 3M.
std::string shortNumber(double x) {
  if (!std::isfinite(x)) return std::isnan(x) ? "nan" : "inf";
  if (x < 9.95) return x < 5e-3 ? "0" : fmt::format("{:.2g}", std::round(x * 100) / 100);
  if (x < 999.5) return fmt::format("{:.0f}", x);
  return x < 999.5e3 ? fmt::format("{:.0f}k", x / 1e3) : fmt::format("{:.0e}", x);
}

}  // namespace

void plotStability(const StabilityReport& report, const std::string& path) {
  std::map<double, int> alphas, thetas;
  for (const StabilityResult& r : report.results)
    if (r.cell.axis == StabilityAxis::kGrid)
      alphas.emplace(r.cell.input.alphaX, 0), thetas.emplace(r.cell.input.thetaO, 0);
  int k = 0;
  for (auto& [alpha, index] : alphas) index = k++;
  k = 0;
  for (auto& [theta, index] : thetas) index = k++;
  const std::vector<StudyBrdf> variants = variantsOf(report);
  const bool few = alphas.size() <= 12;  // room for a number in each cell

  // Black numbers must be legible on every colour.
  struct Map {
    const char *title, *palette, *range;
    double (*value)(const StabilityResult&);
  };
  const Map maps[] = {
      {"largest error in float / its bound", "defined (0 '#f7fbff', 0.999 '#6baed6', 1 '#fb6a4a', 1.2 '#fb6a4a')",
       "[0:1.2]", [](const StabilityResult& r) { return r.single.worstBounds(); }},
      {"albedo at rho_s = 1 (red: above 1)", "defined (0 '#bdbdbd', 1.0001 '#ffffff', 1.0002 '#fcbba1', 1.5 '#fb6a4a')",
       "[0:1.5]", [](const StabilityResult& r) { return r.lobe->albedo; }},
      {"stiffness, log10", "defined (0 '#ffffe5', 5 '#fec44f', 20 '#ec7014')", "[0:20]",
       [](const StabilityResult& r) { return r.estimators->logStiffness / kLn10; }},
      {"checks that fail (green: none)", "defined (0 '#a1d99b', 0.49 '#a1d99b', 0.5 '#fcae91', 9 '#fb6a4a')", "[0:9]",
       [](const StabilityResult& r) { return double(std::count(r.failed.begin(), r.failed.end(), true)); }}};
  const size_t columns = std::size(maps), rows = variants.size();

  std::string script, xtics, ytics;
  for (const auto& [alpha, index] : alphas)
    if (few || index % 4 == 0) xtics += fmt::format("{}'{:.2g}' {}", xtics.empty() ? "" : ", ", alpha, index);
  for (const auto& [theta, index] : thetas)
    ytics += fmt::format("{}'{:g}' {}", ytics.empty() ? "" : ", ", theta, index);
  for (size_t row = 0; row < rows; ++row) {
    script += fmt::format("$d{} << END\n", row);
    for (const StabilityResult* r : ofVariant(report, variants[row])) {
      if (r->cell.axis != StabilityAxis::kGrid || !r->lobe) continue;
      script += fmt::format("{} {}", alphas[r->cell.input.alphaX], thetas[r->cell.input.thetaO]);
      for (const Map& m : maps) script += fmt::format(" {:.9g} {}", m.value(*r), shortNumber(m.value(*r)));
      script += "\n";
    }
    script += "END\n";
  }
  script += fmt::format(
      "set multiplot\nset datafile missing 'nan'\nset border lc rgb '#666666'\nset tics out nomirror font ',9'\nunset "
      "key\n"
      "set xrange [-0.5:{}]\nset yrange [-0.5:{}]\nset xtics rotate by 30 right ({})\nset ytics ({})\n",
      double(alphas.size()) - 0.5, double(thetas.size()) - 0.5, xtics, ytics);
  for (size_t row = 0; row < rows; ++row)
    for (size_t c = 0; c < columns; ++c) {
      const Map& m = maps[c];
      script += fmt::format("set origin {},{}\nset size {},{}\n", double(c) / double(columns),
                            double(rows - 1 - row) / double(rows), 1.0 / double(columns), 1.0 / double(rows));
      script += fmt::format(
          "set title \"{}: {}\" noenhanced font ',12' offset 0,-0.5\nset xlabel 'alpha' offset 0,0.5\n"
          "set ylabel 'theta_o, degrees' noenhanced offset 1.5,0\nset lmargin 11\nset rmargin 6\nset palette {}\nset "
          "cbrange {}\nset cbtics font ',8'\n",
          name(variants[row]), m.title, m.palette, m.range);
      script += fmt::format("plot $d{0} using 1:2:{1} with image", row, 2 * c + 3);
      if (few) script += fmt::format(", $d{} using 1:2:{} with labels font ',8' noenhanced", row, 2 * c + 4);
      script += "\n";
    }
  script += "unset multiplot\n";
  drawWithGnuplot(path, 2240, static_cast<int>(420 * rows), script);
}

}  // namespace wardmis
