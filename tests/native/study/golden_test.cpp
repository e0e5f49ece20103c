// SPDX-License-Identifier: GPL-3.0-or-later
// The study's quadrature against the golden file, which another program made: every number of every case.
#include "golden.h"

#include <gtest/gtest.h>

#include "study/exact.h"
#include "study/slope_disk.h"

namespace wardmis {
namespace {

using nlohmann::json;

// Every number under `expect` that `ours` must have to a relative error of 1e-6, as "path: ours, expected".
void compare(const json& expect, const json& ours, const std::string& path, double tolerance,
             std::vector<std::string>& wrong) {
  for (const auto& [key, value] : expect.items()) {
    const std::string here = path + "/" + key;
    if (key.ends_with("_relerr") || key == "arithmetic" || key == "max_rel_quadrature_error_estimate" ||
        key == "P_below_horizon_p1")
      continue;
    // the fractions of a flat minimum are compared by their variance
    if (path.ends_with("fractions") && (key == "best_balance_numerical" || key == "equalised_second_moments")) continue;
    const json mine = ours.is_array() ? ours.at(static_cast<size_t>(std::stoi(key))) : ours.value(key, json());
    if (value.is_structured()) {
      compare(value, mine, here, tolerance, wrong);
    } else if (value.is_number()) {
      const double e = value.get<double>(), o = mine.is_number() ? mine.get<double>() : std::nan("");
      if (!(std::abs(o - e) <= tolerance * std::abs(e)))
        wrong.push_back(here + ": " + mine.dump() + ", not " + value.dump());
    } else if (value.is_null() && !mine.is_null()) {
      wrong.push_back(here + ": " + mine.dump() + ", not beyond double's range");
    }
  }
}

void check(const json& c) {
  const StudyInput input = studyInputFromJson(c["input"]);
  const Exact exact = solve(*makeProblem(input));
  const json ours = expectJson(input, exact);
  std::vector<std::string> wrong;
  compare(c["expect"], ours, "", 1e-6, wrong);
  for (const std::string& w : wrong)
    ADD_FAILURE() << c["input"].dump() << w << " (" << exact.points.list.size() << " points)";
  EXPECT_LT(exact.integralError, 1e-8) << c["input"].dump();
  EXPECT_LT(exact.relativeError, 1e-6) << c["input"].dump();
}

TEST(Golden, EveryEstimatorCase) {
  for (const json& c : test::golden()["estimator_cases"]) check(c);
}
TEST(Golden, EveryThreeTechniqueCase) {
  for (const json& c : test::golden()["three_technique_cases"]) check(c);
}

// The same in the planar reduction, where the error was a factor of 257 (value: numpy, composite Gauss-Legendre).
TEST(Exact, OptimalWeightsUseATechniqueWithNextToNoSamples) {
  const json j{{"model", "ward-gmd"}, {"mode", "planar"}, {"alpha", 0.08}, {"rho_d", 0.4},
               {"rho_s", 0.5},        {"R", 1.0},         {"joint", true}, {"theta_o_deg", 23.0}};
  const StudyInput input = studyInputFromJson(j);
  const json ours = expectJson(input, solve(*makeProblem(input)));
  EXPECT_LT(ours["fractions"]["inv_m2"][0].get<double>(), 1e-16);
  EXPECT_NEAR(ours["NVar"]["optimal weights inv_m2"].get<double>(), 0.18336300, 1e-7);
}

// A lobe that is hardly ever sampled, and reaches below the horizon still more rarely. Where the ratio o_1/a_1 of the
// two is large, its density is no control variate, and the optimal weights are those of technique 2 alone with the
// control variate tau_2 p_2: integral f^2/p_2 - mu^2. Both are 10^-1000 and less, and no step may show where either
// underflows: o_1 does at alpha .0211, where the variance once fell from 67 to .03.
TEST(Exact, OptimalWeightsDoNotJumpWhereProbabilitiesUnderflow) {
  for (const char* model : {"ward", "ward-dur", "ward-gmd"}) {
    double before = 0;
    for (double alpha : {0.0215, 0.0211, 0.0209, 0.01, 0.001}) {
      const json j{{"model", model}, {"mode", "full"}, {"alpha", alpha}, {"rho_d", 0.5},
                   {"rho_s", 0.5},   {"R", 1.0},       {"joint", true},  {"theta_o_deg", 30.0}};
      const Exact e = solve(*makeProblem(studyInputFromJson(j)), 200);
      const double v = expectJson(studyInputFromJson(j), e)["NVar"]["optimal weights inv_m2"].get<double>();
      EXPECT_NEAR(v / e.moments.variancePrim[1], 1, 1e-6) << model << ' ' << alpha;
      EXPECT_GT(v, before) << model << ' ' << alpha;
      before = v;
    }
  }
  // of an ellipse, and of Phong's lobe, whose second moment is infinite: o_1 = 10^-30103 alone decides
  StudyInput ellipse;
  ellipse.alphaX = 0.004, ellipse.alphaY = 0.02, ellipse.thetaO = 40, ellipse.phiO = 25;
  StudyInput phong;
  phong.brdf = StudyBrdf::kLafortunePhong, phong.m = 1e5, phong.thetaO = 30;
  for (StudyInput input : {ellipse, phong}) {
    input.joint = true, input.rhoD = input.rhoS = 0.5;
    const Exact e = solve(*makeProblem(input), 200);
    EXPECT_EQ(e.points.outside[0], 0);
    EXPECT_TRUE(std::isfinite(e.points.logOutside[0]));
    const double v = expectJson(input, e)["NVar"]["optimal weights inv_m2"].get<double>();
    EXPECT_NEAR(v / e.moments.variancePrim[1], 1, 1e-6);
  }
}

// ln P_below: against the plain integral where that can be held, and the mass of the peak, (pi/E'')^(1/2) e^-E/(2 pi)
// with E'' from the horizon's distance, where not.
TEST(Exact, MassBelowTheHorizonInLogarithms) {
  const auto at = [](double alpha, double theta) { return SlopeDisk(alpha, alpha, theta, 0).logBelow(); };
  // E = (tan(45 - theta/2)/alpha)^2 at psi = pi; d^2 rho/d psi^2 there is rho (tan theta/root + ...) = rho sin(theta)
  for (double theta : {30.0, 60.0})
    for (double alpha : {0.02, 0.01, 0.001, 1e-5}) {
      const double tangent = std::tan((90 - theta) * kPi<double> / 360), e = square(tangent / alpha);
      const double curvature = e * std::sin(theta * kPi<double> / 180);  // E = e + curvature psi^2
      const double peak = -e - 0.5 * std::log(4 * kPi<double> * curvature);
      EXPECT_NEAR(at(alpha, theta), peak, 2 / e + 1e-12 * e) << alpha << ' ' << theta;
    }
  // continuous where the plain integral gives way
  double last = at(0.0226, 30);
  for (double alpha = 0.0225; alpha > 0.021; alpha -= 1e-4) {
    const double next = at(alpha, 30), e = square(std::tan(kPi<double> / 6) / alpha);
    EXPECT_NEAR(last - next, e - square(std::tan(kPi<double> / 6) / (alpha + 1e-4)), 0.01);
    last = next;
  }
}

// Weights that jump. Planar: cells end at the jumps. Values: numpy, composite Gauss-Legendre between the bisected
// jumps. Full: each line of nodes is split at the jumps. Values: numpy, 6000 x 6000 midpoints and more,
// right to 1e-5.
TEST(Exact, JumpingWeights) {
  struct Case {
    const char* model;
    double alpha, theta, maximum, cutoff, scale;
  };
  for (const Case& c : {Case{"ward-gmd", 0.08, 23, 13.469377028, 18.931943197, 1},
                        Case{"ward", 0.17, 47, 55.797596695, 15.892197508550, 0.7 * 2.5},
                        Case{"ward-dur", 0.33, 71, 16.309002719, 4.6006529889, 1}}) {
    SCOPED_TRACE(c.model);
    StudyInput input;
    input.mode = StudyMode::kPlanar, input.alphaX = input.alphaY = c.alpha, input.thetaO = c.theta;
    input.brdf = c.model == std::string("ward")       ? StudyBrdf::kWard
                 : c.model == std::string("ward-dur") ? StudyBrdf::kWardDur
                                                      : StudyBrdf::kWardGmd;
    if (c.scale != 1) input.rhoS = 0.7, input.R = 2.5;
    const json v = expectJson(input, solve(*makeProblem(input)))["NVar"];
    EXPECT_NEAR(v["maximum equal"].get<double>() / c.maximum, 1, 1e-8);
    EXPECT_NEAR(v["cutoff equal"].get<double>() / c.cutoff, 1, 1e-8);
    EXPECT_LT(v["maximum equal_relerr"].get<double>(), 1e-6);
  }
  for (const auto& [brdf, alpha, theta, maximum] : {std::tuple{StudyBrdf::kWardGmd, 0.35, 40, 0.373595},
                                                    {StudyBrdf::kWard, 0.2, 40, 0.144456},
                                                    {StudyBrdf::kWard, 0.5, 70, 0.117278},
                                                    {StudyBrdf::kWard, 1.0, 30, 0.0131115}}) {
    StudyInput full;
    full.brdf = brdf, full.alphaX = full.alphaY = alpha, full.thetaO = theta;
    const json v = expectJson(full, solve(*makeProblem(full)))["NVar"];
    EXPECT_NEAR(v["maximum equal"].get<double>() / maximum, 1, 2e-5);
    EXPECT_LT(v["maximum equal_relerr"].get<double>(), 1e-6);
    EXPECT_LT(v["cutoff equal_relerr"].get<double>(), 1e-6);
  }
}

// Weights that do not know the counts need samples of every technique: without a share, the variance is infinite.
TEST(Exact, NonbalanceWithoutAShareIsInfinite) {
  StudyInput input;
  const Exact exact = solve(*makeProblem(input));
  const Densities cost{1e300, 1e-300};
  for (const char* name : {"variance", "second-moment-nonbalance"}) {
    const Prediction p = predict(*findStrategy(name), exact, &cost);
    EXPECT_EQ(p.fractions[0], 0) << name;
    EXPECT_TRUE(std::isinf(p.logVariance)) << name;
  }
  EXPECT_TRUE(std::isfinite(predict(*findStrategy("second-moment"), exact, &cost).logVariance));
}

// A diffuse part far from a lobe: m^2_1 = 1e80 comes from the horizon's edge, apart from the nodes, which must not be
// asked for its error. Values: composite Gauss-Legendre over theta and phi in 1280 x 1280 nodes, in logarithms.
TEST(Exact, SecondMomentAtTheEdgeLeavesTheOthersTheirError) {
  const json j{{"model", "ward"}, {"mode", "full"},      {"alpha", 0.17}, {"rho_d", 0.35},
               {"rho_s", 0.42},   {"theta_o_deg", 47.0}, {"R", 1.3},      {"joint", true}};
  const Exact exact = solve(*makeProblem(studyInputFromJson(j)));
  EXPECT_NEAR(exact.moments.integral / 0.541095818751177, 1, 1e-10);
  EXPECT_NEAR(exact.moments.variance[0] / 0.01090630666422, 1, 1e-10);
  EXPECT_NEAR(exact.moments.variance[1] / 0.01261113363292, 1, 1e-10);
  EXPECT_NEAR(exact.moments.logSecond[0], std::log(1.36463379030446e80), 1e-10);
  EXPECT_NEAR(exact.moments.logSecond[1], std::log(0.846850548291764), 1e-10);
  EXPECT_LT(exact.integralError, 1e-10);
  EXPECT_LT(exact.relativeError, 1e-8);
}

}  // namespace
}  // namespace wardmis
