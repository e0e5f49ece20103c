// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/exact.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_for_each.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "study/cubature.h"

namespace wardmis {

namespace {

using nlohmann::json;
size_t at(int i) { return static_cast<size_t>(i); }
double square(double x) { return x * x; }

double sum(const Densities& p, int n) {
  double s = 0;
  for (int k = 0; k < n; ++k) s += p[at(k)];
  return s;
}

// f, g p_i, g^2 p_i, f^2/q and the products of densities under 1/q, q = equal mixture.
Integrands moments(int n) {
  return {2 + 2 * n + n * n, [n](const Point& x, double* out) {
            const double s = sum(x.p, n), g = s > 0 ? x.f / s : 0;
            *out++ = x.f, *out++ = g * x.f;
            for (int i = 0; i < n; ++i) *out++ = g * x.p[at(i)], *out++ = g * g * x.p[at(i)];
            for (int i = 0; i < n; ++i)
              for (int k = 0; k < n; ++k) *out++ = s > 0 ? x.p[at(i)] * (x.p[at(k)] / s) : 0;
          }};
}

// f^2/p_i as far as it can be held
Integrands secondMoments(int n) {
  return {n, [n](const Point& x, double* out) {
            for (int i = 0; i < n; ++i) {
              const double log = x.f > 0 ? 2 * std::log(x.f) - x.logP[at(i)] : -1e300;
              out[i] = log < 600 ? std::exp(log) : 0;
            }
          }};
}

// Squared deviations from the means: what the variances are made of, which vanish where f and q are nearly
// proportional.
Integrands deviations(const Points& points, const IntegrandMoments& m) {
  const int n = points.techniques;
  std::vector<Densities> mixtures;
  for (int i = 0; i < n; ++i)
    for (double rest : {0.3, 1e-2, 1e-4, 1e-7, 1e-11}) {
      Densities a{};
      std::fill_n(a.begin(), n, rest / (n - 1));
      a[at(i)] = 1 - rest;
      mixtures.push_back(a);
    }
  return {2 * n + static_cast<int>(mixtures.size()), [n, m, mixtures](const Point& x, double* out) {
            const double s = sum(x.p, n), g = s > 0 ? x.f / s : 0;
            for (int i = 0; i < n; ++i) *out++ = square(g - m.mean[at(i)]) * x.p[at(i)];
            for (int i = 0; i < n; ++i) {
              const double ratio = x.f > 0 ? std::exp(std::log(x.f) - x.logP[at(i)]) : 0;
              *out++ = std::isinf(m.variancePrim[at(i)]) || !(x.p[at(i)] > 0) || ratio > 1e140
                           ? 0
                           : square(ratio - m.integral) * x.p[at(i)];
            }
            for (const Densities& a : mixtures) {
              double q = 0;
              for (int k = 0; k < n; ++k) q += a[at(k)] * x.p[at(k)];
              *out++ = q > 0 ? square(x.f / q - m.integral) * q : 0;
            }
          }};
}

// The heuristics that jump: their edges run through the cells, so that less must do.
Integrands jumps(int n) {
  return {4 * n, [n](const Point& x, double* out) {
            const Densities a = equalFractions(n);
            for (Weights rule : {Weights::kCutoff, Weights::kMaximum})
              for (int i = 0; i < n; ++i) {
                const double y = weightedValue(rule, i, n, x.f, x.p, a, {});
                *out++ = y * x.p[at(i)], *out++ = y * y * x.p[at(i)];
              }
          }};
}

// A number, or its decimal logarithm under another key where double cannot hold it.
void put(json& j, const std::string& key, double logValue) {
  constexpr double kLargest = 709.7;
  if (logValue < kLargest) {
    j[key] = std::exp(logValue);
  } else {
    j[key] = nullptr;
    j[key + "_log10"] = std::isinf(logValue) ? json() : json(logValue / std::log(10.0));
  }
}

json fractionsJson(const Densities& a, int n) {
  json j = json::array();
  for (int i = 0; i < n; ++i) j.push_back(a[at(i)]);
  return j;
}

}  // namespace

Exact solve(const Problem& problem, size_t effort) {
  const int n = problem.techniques();
  Cubature cubature(problem);
  cubature.refine(moments(n), 1e-11, effort);
  const auto atEdge = [&](int i) { return !std::isnan(problem.logSecondMomentAtEdge(i)); };
  bool edge = false;
  for (int i = 0; i < n; ++i) edge |= atEdge(i);
  if (!edge) cubature.refine(secondMoments(n), 1e-10, effort);

  Exact e;
  // Of the present nodes; infinite where a peak at the edge leaves the nodes nothing to say of.
  const auto measure = [&] {
    e.points = cubature.points();
    e.moments = momentsOf(e.points);
    for (int i = 0; i < n; ++i)
      if (atEdge(i)) e.moments.variancePrim[at(i)] = INFINITY;
  };
  measure();
  cubature.refine(deviations(e.points, e.moments), 1e-9, effort);
  const auto side = [n](const Point& x) {
    unsigned counted = 0;
    for (Weights rule : {Weights::kCutoff, Weights::kMaximum})
      for (int i = 0; i < n; ++i)
        counted = 2 * counted + (weightedValue(rule, i, n, 1, x.p, equalFractions(n), {}) > 0 ? 1 : 0);
    return counted;
  };
  const bool flat = problem.charts().front().dimensions == 1;
  const std::vector<double> jumpErrors =
      cubature.splitAtJumps(side, jumps(n), flat ? 1e-9 : 1e-8, std::min<size_t>(200, effort));
  measure();
  const Densities equal = equalFractions(n);
  const auto jumpError = [&](Weights rule, int first) {
    const Contributions c = contributions(rule, equal, e.points, e.moments);
    double sum = 0, error = 0;
    for (int i = 0; i < n; ++i) {
      const size_t k = at(first + 2 * i);
      sum += c.variance[at(i)], error += jumpErrors[k + 1] + 2 * std::abs(c.mean[at(i)]) * jumpErrors[k];
    }
    return sum > 0 ? error / sum : 0;
  };
  e.cutoffError = jumpError(Weights::kCutoff, 0), e.maximumError = jumpError(Weights::kMaximum, 2 * n);

  e.integralError = relativeError(e.points, [](const Point& x) { return x.f; });
  for (const Integrands& which : {moments(n), deviations(e.points, e.moments)})
    for (int k = 0; k < which.count; ++k) {
      std::vector<double> h(at(which.count));
      const double error = relativeError(e.points, [&](const Point& x) {
        which.evaluate(x, h.data());
        return h[at(k)];
      });
      e.relativeError = std::max(e.relativeError, error);
    }

  for (int i = 0; i < n; ++i)
    if (atEdge(i)) {
      const double log = problem.logSecondMomentAtEdge(i);
      e.moments.logSecond[at(i)] = log;
      e.moments.variancePrim[at(i)] = std::max(0.0, std::exp(log) - square(e.moments.integral));
    }
  e.diffusePart = problem.input().diffusePart();
  e.lobeNormalization = problem.lobeNormalization();

  return e;
}

Prediction predict(const Strategy& s, const Exact& e, const Densities* cost) {
  Prediction p;
  p.fractions = fractions(s.allocation, e.points, e.moments, cost);
  p.logVariance = logVariance(s.weights, p.fractions, e.points, e.moments);
  return p;
}

std::vector<Prediction> predictAll(const std::vector<const Strategy*>& list, const Exact& e, const Densities* cost) {
  const auto goal = [](const Strategy* s) {  // auto's is that of best
    return s->allocation == Allocation::kAuto ? Allocation::kBest : s->allocation;
  };
  std::map<Allocation, Densities> known;
  for (const Strategy* s : list) known[goal(s)];
  tbb::parallel_for_each(known, [&](auto& rule) { rule.second = fractions(rule.first, e.points, e.moments, cost); });
  std::vector<Prediction> all(list.size());
  tbb::parallel_for(size_t{0}, list.size(), [&](size_t i) {
    const Densities& a = known.at(goal(list[i]));
    all[i] = {a, logVariance(list[i]->weights, a, e.points, e.moments)};
  });
  return all;
}

json expectJson(const StudyInput& input, const Exact& e, int samples) {
  using A = Allocation;
  using W = Weights;
  const int n = e.points.techniques;
  const IntegrandMoments& m = e.moments;
  const bool two = n == 2;
  json j{{"arithmetic", "double"},
         {"L_o_integrand", m.integral},
         {"L_o", m.integral + e.diffusePart},
         {"max_rel_quadrature_error_estimate", e.relativeError}};
  if (input.mode == StudyMode::kPlanar)
    j["Z_p1_planar"] = e.lobeNormalization;
  else
    j["P_below_horizon_p1"] = e.points.outside[0];
  for (int i = 0; i < n; ++i) {
    if (two) {
      j[fmt::format("mu_{}_eq", i + 1)] = m.mean[at(i)];
      j[fmt::format("sigma2_{}_eq", i + 1)] = m.variance[at(i)];
      put(j, fmt::format("m2_{}", i + 1), m.logSecond[at(i)]);
    } else {
      j["mu_eq"].push_back(m.mean[at(i)]);
      j["sigma2_eq"].push_back(m.variance[at(i)]);
      j["m2"].push_back(m.second(i));
    }
  }

  const auto a = [&](A rule) { return fractions(rule, e.points, m); };
  const Densities equal = a(A::kEqual), sigma2 = a(A::kVariance), sigma = a(A::kStandardDeviation),
                  invM2 = a(A::kSecondMoment), best = a(A::kBest);
  json& f = j["fractions"] = {{"equal", fractionsJson(equal, n)},
                              {"sigma2", fractionsJson(sigma2, n)},
                              {"sigma", fractionsJson(sigma, n)},
                              {"inv_m2", fractionsJson(invM2, n)},
                              {"linear", fractionsJson(a(A::kLinear), n)},
                              {"inverse_variance", fractionsJson(a(A::kInverseVariance), n)},
                              {"representativity", fractionsJson(a(A::kRepresentativity), n)},
                              {"equalised_second_moments", fractionsJson(a(A::kEqualised), n)},
                              {"best_balance_numerical", fractionsJson(best, n)}};
  json& v = j["NVar"] = json::object();
  const auto variance = [&](const char* key, W weights, const Densities& fractions) {
    put(v, key, logVariance(weights, fractions, e.points, m));
  };
  variance("F_eq (Def 7)", W::kBalance, equal);
  variance("nonbalance sigma2 (Def 8, Eq 14 weights)", W::kNonbalance, sigma2);
  variance("balance sigma2 (Def 8 read as balance)", W::kBalance, sigma2);
  variance("nonbalance inv_m2 (Def 9 read with Eq 14 weights)", W::kNonbalance, invM2);
  variance("balance inv_m2 (Def 9)", W::kBalance, invM2);
  variance("nonbalance sigma (Sbert optimal)", W::kNonbalance, sigma);
  variance("balance sigma", W::kBalance, sigma);
  put(v, "one-sample balance equal", logVarianceOneSample(equal, e.points));
  put(v, "one-sample balance sigma2", logVarianceOneSample(sigma2, e.points));
  put(v, "one-sample balance inv_m2", logVarianceOneSample(invM2, e.points));
  variance("power2 equal", W::kPower, equal);
  variance("cutoff equal", W::kCutoff, equal);
  variance("maximum equal", W::kMaximum, equal);
  v["cutoff equal_relerr"] = e.cutoffError, v["maximum equal_relerr"] = e.maximumError;
  variance("variance-aware equal", W::kVarianceAware, equal);
  for (int i = 0; i < n; ++i)
    put(v, fmt::format("pure technique {}", i + 1),
        std::isinf(m.variancePrim[at(i)]) ? m.logSecond[at(i)] : std::log(m.variancePrim[at(i)]));
  variance("optimal weights equal", W::kOptimal, equal);
  variance("optimal weights inv_m2", W::kOptimal, invM2);
  if (two) {
    const Densities lu = a(A::kSecondOrder);
    f["lu2_clamp05"] = fractionsJson(lu, n);
    variance("balance lu2_clamp05", W::kBalance, lu);
    if (invM2[0] == 0 || invM2[1] == 0) {
      const double l1 = m.logSecond[0] / std::log(10.0), l2 = m.logSecond[1] / std::log(10.0);
      f["inv_m2_log10"] = {std::min(0.0, l2 - l1), std::min(0.0, l1 - l2)};
      for (size_t i = 0; i < 2; ++i)
        if (invM2[i] == 0) f["inv_m2"][i] = nullptr;
    }
  }
  variance("balance equalised_second_moments (Havran-Sbert)", W::kBalance, a(A::kEqualised));
  variance("balance linear (Sbert-Szirmay-Kalos)", W::kBalance, a(A::kLinear));
  variance("balance inverse variance", W::kBalance, a(A::kInverseVariance));
  variance("balance representativity", W::kBalance, a(A::kRepresentativity));
  variance("balance best fraction (numerical)", W::kBalance, best);

  if (two) {
    json& counts = j["integer_counts"][std::to_string(samples)] = json::object();
    const auto whole = [&](const char* key, W weights, const Densities& fractions) {
      const auto c = wholeCounts(fractions, n, samples);
      const Densities actual{double(c[0]) / samples, double(c[1]) / samples};
      counts[key] = {
          {"N1", c[0]}, {"N2", c[1]}, {"Var", std::exp(logVariance(weights, actual, e.points, m)) / samples}};
    };
    whole("balance equal", W::kBalance, equal);
    whole("nonbalance sigma2", W::kNonbalance, sigma2);
    whole("balance sigma2", W::kBalance, sigma2);
    whole("balance inv_m2", W::kBalance, invM2);
    whole("nonbalance sigma", W::kNonbalance, sigma);
  }
  return j;
}

}  // namespace wardmis
