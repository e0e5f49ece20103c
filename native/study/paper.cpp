// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/paper.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>

#include "math/number.h"
#include "study/gnuplot.h"

namespace wardmis {

namespace {

constexpr double kPid = kPi<double>;
constexpr double kAlphas[] = {0.01, 0.015, 0.02, 0.03, 0.05, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1};
constexpr double kThetas[] = {0, 30, 60, 80};

Exact planarPhong(double m) {
  StudyInput in;
  in.brdf = StudyBrdf::kLafortunePhong, in.mode = StudyMode::kPlanar;
  in.m = m, in.thetaO = 0;
  return solve(*makeProblem(in));
}

// Mean of F_eq over the true integral where its samples are the true ones, but its denominator is `printed`(p): of
// sum_i (1/n) sum_j f/(sum of the printed densities), the share of each point is p_1 + p_2.
template <class F>
double meanWithDenominator(const Exact& e, const F& printed) {
  return e.points.integrate([&](const Point& x) { return x.f * (x.p[0] + x.p[1]) / printed(x); }) / e.moments.integral;
}

// Eq. 13's denominator takes each density at its own technique's sample: p_1(X_1j) + p_2(X_2j).
double meanWithMixedIndices(const Exact& e) {
  double sum = 0;
  for (const Point& x : e.points.list)
    for (const Point& y : e.points.list) sum += x.w * x.p[0] * y.w * y.p[1] * (x.f + y.f) / (x.p[0] + y.p[1]);
  return sum / e.moments.integral;
}

// The printed formulas of the planar reduction. All in x = cos(theta_i), with t = tan((theta_i - theta_o)/2), and the
// parts of cos(theta_h) and (h.o): cos((theta_i -+ theta_o)/2) = sqrt((1+x)/2) C +- sqrt((1-x)/2) S.
struct Planar {
  double alpha, thetaO;  // radians
  double c = std::cos(thetaO / 2), s = std::sin(thetaO / 2);

  static double a(double x) { return std::sqrt((1 + x) / 2); }
  static double b(double x) { return std::sqrt((1 - x) / 2); }
  double t(double x) const { return (b(x) * c - a(x) * s) / (a(x) * c + b(x) * s); }
  // rho_s = 1: f_s x^2, for an exponent
  double lobe(double x, double exponent) const {
    return x * x * std::exp(-exponent) / (4 * kPid * alpha * alpha * std::sqrt(x * std::cos(thetaO)));
  }
  double walter(double x, double b) const {
    return std::exp(-t(x) * t(x) / (alpha * alpha)) /
           (4 * kPid * alpha * alpha * (a(x) * c - b * s) * std::pow(a(x) * c + b * s, 3));
  }
  // Over [0, 1], in theta_i and split at the lobe, which is narrow.
  template <class F>
  double integrate(const F& f) const {
    const auto inTheta = [&](double theta) { return f(std::cos(theta)) * std::sin(theta); };
    double sum = 0;
    std::vector<double> ends{0, kPid / 2};
    for (double k : {0.0, 1.0, 3.0, 8.0, 20.0, 60.0})
      for (double sign : {-1.0, 1.0})
        if (const double at = thetaO + sign * k * alpha; at > 0 && at < kPid / 2) ends.push_back(at);
    std::sort(ends.begin(), ends.end());
    for (size_t k = 0; k + 1 < ends.size(); ++k)
      if (ends[k + 1] > ends[k])
        sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(inTheta, ends[k], ends[k + 1], 10, 1e-10);
    return sum;
  }
};

void addPlanar(std::vector<Erratum>& list, double alpha, double degrees) {
  const Planar p{alpha, degrees * kPid / 180};
  const std::string of = fmt::format("ward, alpha = {:g}, theta_o = {:g}", alpha, degrees);
  const double a2 = alpha * alpha;
  const double right = p.integrate([&](double x) { return p.lobe(x, p.t(x) * p.t(x) / a2); });
  list.push_back({"(17)", "its last line's + in the numerator of t: the integral", of, p.integrate([&](double x) {
                    const double t =
                        (Planar::b(x) * p.c + Planar::a(x) * p.s) / (Planar::a(x) * p.c + Planar::b(x) * p.s);
                    return p.lobe(x, t * t / a2);
                  }) / right});
  list.push_back({"(18)", "exponent t^2, without /alpha^2: the integral", of,
                  p.integrate([&](double x) { return p.lobe(x, p.t(x) * p.t(x)); }) / right});
  list.push_back({"(19)", "g_1 without 4 pi alpha^2 sqrt(x cos(theta_o)): the integral", of,
                  p.integrate([&](double x) { return x * x * std::exp(-p.t(x) * p.t(x) / a2); }) / right});
  list.push_back({"(21)", "sin before sqrt((1-x)/2): integral of P", of, p.integrate([&](double x) {
                    return p.walter(x, std::sin(Planar::b(x)));
                  }) / p.integrate([&](double x) { return p.walter(x, Planar::b(x)); })});
}

}  // namespace

std::vector<Erratum> errata() {
  std::vector<Erratum> list;
  for (double m : {1.0, 10.0, 100.0}) {
    const Exact e = planarPhong(m);
    const std::string of = fmt::format("Lafortune-Phong, m = {:g}", m);
    // on [0, 1] the true densities are (m+1) x^m and 2x
    list.push_back({"(11), (12)", "densities as printed, (m+1)/(2 pi) x^m and 4x/pi: mean of F_eq", of,
                    meanWithDenominator(e, [](const Point& x) { return x.p[0] / (2 * kPid) + x.p[1] * 2 / kPid; })});
    list.push_back(
        {"(24), (26)", "p_2 as printed there, 4x^2/pi: mean of F_eq", of,
         meanWithDenominator(e, [](const Point& x) { return x.p[0] / (2 * kPid) + x.p[1] * x.p[1] / kPid; })});
    list.push_back({"(13)", "p_1(X_1j) + p_2(X_2j) in the denominator: mean of F_eq", of, meanWithMixedIndices(e)});
  }
  for (double m : {10.0, 100.0})
    for (double theta : {30.0, 60.0}) {
      StudyInput in;
      in.brdf = StudyBrdf::kLafortunePhong, in.m = m, in.thetaO = theta;
      // of cos^m(theta_i): the integral of (m+2)/(2 pi) cos^(m+2) is (m+2)/(m+3)
      list.push_back({"(9)", "cos^m(theta_i), not of the angle to the mirror direction: L_o",
                      fmt::format("Lafortune-Phong, m = {:g}, theta_o = {:g}", m, theta),
                      (m + 2) / (m + 3) / solve(*makeProblem(in)).moments.integral});
    }
  list.push_back({"(14)", "R rho_s (m+2)/pi as printed, on [0, 1]", "any m", 1 / kPid});
  for (double theta : {30.0, 60.0, 80.0})
    for (double alpha : {0.01, 0.1, 0.5}) {
      StudyInput full;
      full.alphaX = full.alphaY = alpha, full.thetaO = theta;
      StudyInput planar = full;
      planar.mode = StudyMode::kPlanar;
      const Exact p = solve(*makeProblem(planar));
      const std::string of = fmt::format("ward, alpha = {:g}, theta_o = {:g}", alpha, theta);
      list.push_back({"(16) to (26)", "the planar reduction, theta_h = |theta_i - theta_o|/2 for every azimuth", of,
                      p.moments.integral / solve(*makeProblem(full)).moments.integral});
      addPlanar(list, alpha, theta);
      list.push_back({"(23)", "integral over [0, 1] of what is called a density", of, p.lobeNormalization});
    }
  return list;
}

std::vector<Verdict> verdicts() {
  std::vector<Verdict> list;
  for (bool joint : {false, true})
    for (double theta : kThetas)
      for (double alpha : kAlphas) list.push_back({joint, alpha, theta, {}});
  tbb::parallel_for(size_t{0}, list.size(), [&](size_t k) {
    Verdict& v = list[k];
    StudyInput in;
    in.alphaX = in.alphaY = v.alpha, in.thetaO = v.thetaO, in.joint = v.joint, in.rhoS = 0.5, in.rhoD = 0.3;
    const Exact e = solve(*makeProblem(in));
    const double equal = predict(*findStrategy("equal"), e).logVariance;
    for (const char* name : kVerdictStrategies)
      v.logRatio.push_back(predict(*findStrategy(name), e).logVariance - equal);
  });
  return list;
}

std::string errataTable(const std::vector<Erratum>& list) {
  std::string out = "| paper | as printed | of | printed / true |\n|---|---|---|---:|\n";
  for (const Erratum& e : list) out += fmt::format("| {} | {} | {} | {:.4g} |\n", e.where, e.what, e.of, e.ratio);
  return out;
}

std::string verdictTable(const std::vector<Verdict>& list) {
  std::string out = "| integrand | theta_o | alpha |";
  for (const char* name : kVerdictStrategies) out += fmt::format(" {} |", name);
  out += "\n|---|---:|---:|";
  for (size_t i = 0; i < std::size(kVerdictStrategies); ++i) out += "---:|";
  for (const Verdict& v : list) {
    out += fmt::format("\n| {} | {:g} | {:g} |", v.joint ? "joint" : "split", v.thetaO, v.alpha);
    for (double r : v.logRatio)
      out += r < 20 ? fmt::format(" {:.4g} |", std::exp(r)) : fmt::format(" 1e{:.0f} |", r / std::log(10.0));
  }
  return out + "\n";
}

void plotVerdicts(const std::vector<Verdict>& list, const std::string& path) {
  constexpr const char* kColours[] = {"#d62728", "#ff9896", "#1f77b4", "#9467bd", "#2ca02c", "#000000"};
  std::string script =
      "set multiplot title 'Variance over that of equal counts (Def. 7): below 1 is better' noenhanced\nset logscale "
      "xy\n"
      "set grid lc rgb '#dddddd'\nset border lc rgb '#666666'\nset tics font ',9'\nset xlabel 'alpha'\n"
      "set format y '10^{%T}'\nset xrange [0.01:1]\nset yrange [1e-5:1e5]\n";
  int panel = 0;
  for (bool joint : {false, true})
    for (double theta : {0.0, 60.0}) {
      for (size_t s = 0; s < std::size(kVerdictStrategies); ++s) {
        script += fmt::format("$p{}s{} << END\n", panel, s);
        for (const Verdict& v : list)
          if (v.joint == joint && v.thetaO == theta)
            script += fmt::format("{} {:.6g}\n", v.alpha, std::exp(std::min(v.logRatio[s], 100.0)));
        script += "END\n";
      }
      script += fmt::format("set origin {},{}\nset size {},0.47\nset title '{}, theta_o = {:g} degrees' noenhanced\n",
                            panel % 2 == 0 ? 0.0 : 0.39, panel < 2 ? 0.48 : 0.0, panel % 2 == 0 ? 0.39 : 0.61,
                            joint ? "joint (diffuse inside)" : "split (specular alone)", theta);
      script += panel % 2 == 1 ? "set key outside right noenhanced font ',9'\n" : "set key off\n";
      script += "plot 1 with lines lc rgb '#999999' dt 2 title 'equal'";
      for (size_t s = 0; s < std::size(kVerdictStrategies); ++s)
        script += fmt::format(", $p{}s{} with linespoints lc rgb '{}' pt {} ps 0.6 lw 1.6 title '{}'", panel, s,
                              kColours[s], s + 4, kVerdictStrategies[s]);
      script += "\n";
      panel += 1;
    }
  script += "unset multiplot\n";
  drawWithGnuplot(path, 1180, 860, script);
}

}  // namespace wardmis
