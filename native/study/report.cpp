// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "study/gnuplot.h"

namespace wardmis {

namespace {

using nlohmann::json;
size_t at(int i) { return static_cast<size_t>(i); }

// The 95 % interval of a variance from K trials: that of chi-square with as many degrees of freedom as their kurtosis
// leaves, 2 s^4/Var(s^2), and never more than the K - 1 of a normal distribution, since few trials show no tails. None
// under 4 trials.
std::pair<double, double> varianceInterval(const Estimate& e) {
  const double nan = std::nan(""), s2 = e.variance();
  if (e.count() < 4) return {nan, nan};
  if (!(s2 > 0)) return {0, 0};
  const double relative = e.varianceError() / s2;
  const boost::math::chi_squared distribution(std::clamp(2 / (relative * relative), 1.0, e.count() - 1));
  const double degrees = distribution.degrees_of_freedom();
  return {s2 * degrees / quantile(distribution, 0.975), s2 * degrees / quantile(distribution, 0.025)};
}

// What is derived of a run; NaN where it does not apply.
struct Derived {
  double z, variance, low, high, ratio, relativeCost, varianceCost;
};

Derived derive(const Study& study, const StrategyRun& run) {
  const double nan = std::nan("");
  const Estimate& e = run.estimate;
  Derived d{nan, nan, nan, nan, nan, nan, nan};
  if (e.count() < 2) return d;
  d.variance = e.variance();
  d.z = e.error() > 0 ? (e.mean() - study.exact.moments.integral) / e.error() : 0;
  std::tie(d.low, d.high) = varianceInterval(e);
  if (run.predictedVariance && *run.predictedVariance > 0) d.ratio = d.variance / *run.predictedVariance;
  d.varianceCost = d.variance * run.seconds;
  return d;
}

// A column of the table: significant digits without padding, '-' where there is nothing.
std::string number(double x, int digits = 4) { return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "-"; }

// ln(N Var) as a number of any size.
std::string big(double log) {
  if (log < 700) return number(std::exp(log));
  if (std::isinf(log)) return log > 0 ? "infinite" : "0";
  return fmt::format("1e{:.0f}", log / std::log(10.0));
}

std::string joined(const Densities& a, int n) {
  std::string s;
  for (int i = 0; i < n; ++i) s += fmt::format("{}{:.4g}", i > 0 ? " " : "", a[at(i)]);
  return s;
}

json finite(double x) { return std::isfinite(x) ? json(x) : json(); }

std::string title(const StudyInput& in) {
  std::string s = std::string(name(in.brdf));
  if (!in.ward())
    s += fmt::format(", m = {:g}", in.m);
  else if (in.alphaX == in.alphaY)
    s += fmt::format(", alpha = {:g}", in.alphaX);
  else
    s += fmt::format(", alpha = {:g}, {:g}, phi_o = {:g}", in.alphaX, in.alphaY, in.phiO);
  s += fmt::format(", theta_o = {:g}, rho_d = {:g}, rho_s = {:g}, R = {:g}, {}", in.thetaO, in.rhoD, in.rhoS, in.R,
                   in.joint ? "joint" : "split");
  return s + (in.mode == StudyMode::kPlanar ? ", planar (the paper's 1-D reduction, no radiance)" : "");
}

// Rows of equal length as aligned columns; the first is on the left, the others on the right.
std::string aligned(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> width(rows.front().size(), 0);
  for (const auto& row : rows)
    for (size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], row[c].size());
  std::string out;
  for (const auto& row : rows) {
    std::string line;
    for (size_t c = 0; c < row.size(); ++c)
      line += c == 0 ? fmt::format("{:<{}}", row[c], width[c]) : fmt::format("  {:>{}}", row[c], width[c]);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  }
  return out;
}

}  // namespace

std::string studyTable(const Study& s) {
  const int n = s.exact.points.techniques;
  const IntegrandMoments& m = s.exact.moments;
  std::string out = title(s.input) + "\n";
  const bool planar = s.input.mode == StudyMode::kPlanar;
  out += fmt::format(
      "{} = {:.12g}{}   (quadrature, relative error about {:.0e})\n\n",
      planar ? "integral of the 1-D reduction + diffuse part" : "L_o", m.integral + s.exact.diffusePart,
      s.exact.diffusePart > 0 ? fmt::format(" = {:.12g} + {:.6g} diffuse", m.integral, s.exact.diffusePart) : "",
      s.exact.integralError);
  std::vector<std::vector<std::string>> rows{{"technique", "mu_i,eq", "sigma^2_i,eq", "m^2_i", "outside", "ns/sample"}};
  for (int i = 0; i < n; ++i)
    rows.push_back({std::string(name(s.input.techniques[at(i)])), number(m.mean[at(i)], 6),
                    number(m.variance[at(i)], 6), big(m.logSecond[at(i)]), number(s.exact.points.outside[at(i)], 3),
                    number(s.costNanoseconds[at(i)], 3)});
  out += aligned(rows);

  for (size_t k = 0; k < s.runs.size(); ++k) {
    const TrialSettings& settings = s.settings[k];
    out += fmt::format("\nN = {} samples, {} trials, seed {}{}\n", settings.samples, settings.trials, settings.seed,
                       settings.cost ? fmt::format(", costs {}", joined(*settings.cost, n)) : "");
    rows = {{"strategy", "fractions", "N Var", "counts"}};
    if (settings.trials > 0)
      rows[0].insert(rows[0].end(), {"mean", "bias z", "variance", "95 %", "/predicted", "us/trial", "var x s"});
    for (const StrategyRun& run : s.runs[k]) {
      std::string counts;
      for (int i = 0; i < n; ++i) counts += fmt::format("{}{}", i > 0 ? " " : "", run.counts[at(i)]);
      const bool given = run.strategy->knowledge == Knowledge::kGiven;
      std::vector<std::string> row{std::string(run.strategy->name), joined(run.exact.fractions, n),
                                   big(run.exact.logVariance), (given ? "" : "~ ") + counts};
      if (settings.trials > 0) {
        const Derived d = derive(s, run);
        row.insert(row.end(),
                   {number(run.estimate.mean() + s.exact.diffusePart, 6), run.judgeable ? number(d.z, 2) : "?",
                    number(d.variance),
                    std::isfinite(d.low) ? fmt::format("{}..{}", number(d.low, 3), number(d.high, 3)) : "-",
                    run.judgeable ? number(d.ratio) : "?", number(run.seconds * 1e6, 3), number(d.varianceCost, 3)});
      }
      rows.push_back(row);
    }
    out += aligned(rows);
  }
  const auto any = [&](auto&& which) {
    return std::any_of(s.runs.begin(), s.runs.end(),
                       [&](const auto& runs) { return std::any_of(runs.begin(), runs.end(), which); });
  };
  if (any([](const StrategyRun& r) { return r.estimate.count() > 0 && !r.judgeable; }))
    out +=
        "\n?: says nothing. The trials are too few, or the variance rests on so rare events that they may have met "
        "none; the mean\nis then too small and the measured variance far too small, without a bias.\n";
  if (any([](const StrategyRun& r) { return r.estimate.count() > 0 && r.strategy->knowledge == Knowledge::kDirect; }))
    out += "\n'optimal-direct' has a bias of O(1/N), as its source says.\n";
  out +=
      "\nN Var: exact, for real-valued fractions. Where counts follow the samples (~, those of the last pass), it is "
      "that of the\n"
      "exact fractions, the strategy's goal. 'variance' and 'equal' have the same N Var whatever the case "
      "(docs/theory.md).\n";
  if (const double error = std::max(s.exact.cutoffError, s.exact.maximumError); error > 1e-6)
    out += fmt::format(
        "The weights of cutoff and maximum jump within the quadrature's cells: their N Var has a relative error of "
        "about "
        "{:.0e}.\n",
        error);
  return out;
}

json studyJson(const Study& s) {
  const int n = s.exact.points.techniques;
  json measured{{"cost_ns", json::array()}, {"seconds", s.seconds}, {"runs", json::array()}};
  for (int i = 0; i < n; ++i) measured["cost_ns"].push_back(s.costNanoseconds[at(i)]);
  for (size_t k = 0; k < s.runs.size(); ++k) {
    const TrialSettings& settings = s.settings[k];
    json run{{"samples", settings.samples}, {"trials", settings.trials}, {"seed", settings.seed}};
    json& list = run["strategies"] = json::object();
    for (const StrategyRun& r : s.runs[k]) {
      const Derived d = derive(s, r);
      json counts = json::array(), a = json::array();
      for (int i = 0; i < n; ++i) counts.push_back(r.counts[at(i)]), a.push_back(r.exact.fractions[at(i)]);
      list[std::string(r.strategy->name)] = {
          {"source", r.strategy->source},
          {"fractions", a},
          {"nvar", finite(std::exp(r.exact.logVariance))},
          {"nvar_log10", finite(r.exact.logVariance / std::log(10.0))},
          {"counts", counts},
          {"counts_follow_samples", r.strategy->knowledge != Knowledge::kGiven},
          {"predicted_variance", r.predictedVariance ? finite(*r.predictedVariance) : json()},
          {"mean", settings.trials > 0 ? finite(r.estimate.mean()) : json()},
          {"bias_z", finite(d.z)},
          {"events", finite(r.events)},
          {"judgeable", r.judgeable},
          {"variance", finite(d.variance)},
          {"variance_95", {finite(d.low), finite(d.high)}},
          {"variance_error", settings.trials > 1 ? finite(r.estimate.varianceError()) : json()},
          {"variance_over_predicted", finite(d.ratio)},
          {"seconds_per_trial", r.seconds},
          {"variance_x_seconds", finite(d.varianceCost)}};
    }
    measured["runs"].push_back(run);
  }
  json j{{"input", toJson(s.input)},
         {"expect", expectJson(s.input, s.exact, s.settings.empty() ? 256 : s.settings.front().samples)}};
  if (s.input.mode == StudyMode::kPlanar) j["note"] = "planar: the paper's 1-D reduction, no radiance";
  if (s.settings.empty() || s.settings.front().trials == 0) return j;
  j["measured"] = measured;
  return j;
}

std::string studyCsv(const Study& s) {
  const int n = s.exact.points.techniques;
  std::string out =
      "strategy,samples,trials,seed,exact_integral,nvar,nvar_log10,predicted_variance,mean,bias_z,variance,"
      "variance_low95,variance_high95,variance_over_predicted,seconds_per_trial,variance_x_seconds,"
      "counts_follow_samples";
  for (const char* what : {"fraction", "count", "cost_ns"})
    for (int i = 0; i < n; ++i) out += fmt::format(",{}_{}", what, name(s.input.techniques[at(i)]));
  out += "\n";
  const auto cell = [](double x) { return std::isfinite(x) ? fmt::format(",{:.17g}", x) : std::string(","); };
  for (size_t k = 0; k < s.runs.size(); ++k)
    for (const StrategyRun& r : s.runs[k]) {
      const Derived d = derive(s, r);
      out +=
          fmt::format("{},{},{},{}", r.strategy->name, s.settings[k].samples, s.settings[k].trials, s.settings[k].seed);
      for (double x :
           {s.exact.moments.integral, std::exp(r.exact.logVariance), r.exact.logVariance / std::log(10.0),
            r.predictedVariance.value_or(std::nan("")), r.estimate.count() > 0 ? r.estimate.mean() : std::nan(""), d.z,
            d.variance, d.low, d.high, d.ratio, r.seconds, d.varianceCost})
        out += cell(x);
      out += r.strategy->knowledge != Knowledge::kGiven ? ",1" : ",0";
      for (int i = 0; i < n; ++i) out += cell(r.exact.fractions[at(i)]);
      for (int i = 0; i < n; ++i) out += fmt::format(",{}", r.counts[at(i)]);
      for (int i = 0; i < n; ++i) out += cell(s.costNanoseconds[at(i)]);
      out += "\n";
    }
  return out;
}

void plotStudy(const Study& s, const std::string& path) {
  std::string script;
  const size_t strategies = s.runs.front().size();
  // one data block a strategy: samples, N x variance, low, high, seconds, standard deviation, N x predicted variance
  for (size_t k = 0; k < strategies; ++k) {
    script += fmt::format("$s{} << END\n", k);
    for (size_t r = 0; r < s.runs.size(); ++r) {
      const StrategyRun& run = s.runs[r][k];
      const Derived d = derive(s, run);
      const double n = s.settings[r].samples;
      script += fmt::format("{} {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} {}\n", n, n * d.variance,
                            n * (std::isfinite(d.low) ? d.low : d.variance),
                            n * (std::isfinite(d.high) ? d.high : d.variance), run.seconds, std::sqrt(d.variance),
                            run.predictedVariance ? fmt::format("{:.9g}", n * *run.predictedVariance) : "NaN");
    }
    script += "END\n";
  }
  script += fmt::format(
      "set multiplot title {} noenhanced\nset logscale xy\nset format y '10^{{%T}}'\nset grid lc rgb '#dddddd'\n"
      "set tmargin 3\nset border lc rgb '#666666'\nset tics font ',9'\n",
      gnuplotText(title(s.input)));
  // A colour and a point of its own each, the ones that the paper compares thick. Of many, the others than these and
  // the yardsticks are thin and grey: to show some of them, name them by --strategies.
  static constexpr const char* kColours[] = {"#000000", "#d62728", "#1f77b4", "#2ca02c", "#9467bd",
                                             "#e6550d", "#17becf", "#8c564b", "#e377c2", "#bcbd22"};
  constexpr std::string_view kPapers[] = {"equal", "variance", "second-moment"};
  constexpr std::string_view kShown[] = {"equal", "variance", "second-moment", "standard-deviation",
                                         "best",  "optimal",  "auto"};
  const auto isOne = [&](const auto& names, size_t k) {
    return std::find(std::begin(names), std::end(names), s.runs[0][k].strategy->name) != std::end(names);
  };
  std::vector<size_t> colours;  // by strategy; none of them: grey
  for (size_t k = 0, next = 0; k < strategies; ++k)
    colours.push_back(strategies <= std::size(kColours) || isOne(kShown, k) ? next++ : std::size(kColours));
  const auto shown = [&](size_t k) { return colours[k] < std::size(kColours); };
  const auto line = [&](size_t k) {
    if (!shown(k)) return std::string("lc rgb '#c8c8c8' lw 0.6");
    return fmt::format("lc rgb '{}' lw {}", kColours[colours[k]], isOne(kPapers, k) ? "1.8" : "1.2");
  };
  const auto style = [&](size_t k) { return fmt::format("{} pt {} ps {}", line(k), 1 + k % 13, shown(k) ? 0.7 : 0.3); };
  std::vector<size_t> order;  // the grey ones first, beneath
  for (bool wanted : {false, true})
    for (size_t k = 0; k < strategies; ++k)
      if (shown(k) == wanted) order.push_back(k);
  script +=
      "set origin 0,0\nset size 0.42,0.95\nset key off noenhanced\nset xlabel 'samples N'\nset ylabel 'N x variance "
      "(bars: 95 %; lines: exact)'\nplot ";
  for (size_t k : order)
    script += fmt::format("{0}$s{1} using 1:7 with lines {3} notitle, $s{1} using 1:2:3:4 with yerrorbars {2} notitle",
                          k != order[0] ? ", " : "", k, style(k), line(k));
  script +=
      "\nset origin 0.42,0\nset size 0.58,0.95\nset key outside right top font ',9' noenhanced\n"
      "set xlabel 'seconds of one estimate (drawing and combining)'\nset format x '10^{%T}'\n"
      "set ylabel 'standard deviation of the estimate'\nplot ";
  const auto named = [&](size_t k) {
    return shown(k) ? "title " + gnuplotText(std::string(s.runs[0][k].strategy->name)) : std::string("notitle");
  };
  for (size_t k : order)
    script += fmt::format("{}$s{} using 5:6 with linespoints {} {}", k != order[0] ? ", " : "", k, style(k), named(k));
  if (std::any_of(order.begin(), order.end(), [&](size_t k) { return !shown(k); }))
    script += ", NaN with lines lc rgb '#c8c8c8' title 'the others'";
  script += "\nunset multiplot\n";
  drawWithGnuplot(path, 1280, 560, script);
}

}  // namespace wardmis
