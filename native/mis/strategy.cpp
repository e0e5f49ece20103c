// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/strategy.h"

#include <Eigen/QR>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <limits>
#include <numeric>

namespace wardmis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kHuge = 1e290;  // above this, numbers are handled by their logarithm

using A = Allocation;
using W = Weights;
using K = Knowledge;
constexpr Strategy kStrategies[] = {
    {"equal", A::kEqual, W::kBalance, K::kGiven, "Def. 7; Veach and Guibas 1995"},
    {"variance", A::kVariance, W::kNonbalance, K::kGiven, "Def. 8 with the weights of Eq. 14; Sbert et al. 2016"},
    {"variance-balance", A::kVariance, W::kBalance, K::kGiven, "Def. 8 read as balance"},
    {"standard-deviation", A::kStandardDeviation, W::kNonbalance, K::kGiven, "Sbert et al. 2018"},
    {"standard-deviation-balance", A::kStandardDeviation, W::kBalance, K::kGiven, "Sbert et al. 2018"},
    {"second-moment", A::kSecondMoment, W::kBalance, K::kGiven, "Def. 9; Sbert et al. 2018"},
    {"second-moment-nonbalance", A::kSecondMoment, W::kNonbalance, K::kGiven, "Def. 9 with the weights of Eq. 14"},
    {"inverse-variance", A::kInverseVariance, W::kBalance, K::kGiven, "Sbert et al. 2018"},
    {"equalised", A::kEqualised, W::kBalance, K::kGiven, "Havran and Sbert 2014"},
    {"equalised-adaptive", A::kEqualised, W::kBalance, K::kProgressive, "Sbert and Havran 2017"},
    {"linear", A::kLinear, W::kBalance, K::kGiven, "Sbert and Szirmay-Kalos 2023"},
    {"second-order", A::kSecondOrder, W::kBalance, K::kGiven, "Lu et al. 2013"},
    {"representativity", A::kRepresentativity, W::kBalance, K::kGiven, "after Pajot et al. 2011"},
    {"power", A::kEqual, W::kPower, K::kGiven, "Veach and Guibas 1995"},
    {"cutoff", A::kEqual, W::kCutoff, K::kGiven, "Veach and Guibas 1995"},
    {"maximum", A::kEqual, W::kMaximum, K::kGiven, "Veach and Guibas 1995"},
    {"variance-aware", A::kEqual, W::kVarianceAware, K::kGiven, "Grittmann et al. 2019"},
    {"optimal", A::kEqual, W::kOptimal, K::kGiven, "Kondapaneni et al. 2019"},
    {"optimal-progressive", A::kEqual, W::kOptimal, K::kProgressive, "Kondapaneni et al. 2019"},
    {"optimal-direct", A::kEqual, W::kOptimal, K::kDirect, "Kondapaneni et al. 2019"},
    {"best", A::kBest, W::kBalance, K::kGiven, "the minimum, found numerically"},
    {"auto", A::kAuto, W::kBalance, K::kPilot, "ours"},
};

double square(double x) { return x * x; }
size_t at(int i) { return static_cast<size_t>(i); }

double mixture(const Densities& a, const Densities& p, int n) {
  double q = 0;
  for (int k = 0; k < n; ++k) q += a[at(k)] * p[at(k)];
  return q;
}

// (sum of values as logarithms) Adds exp(x) to a sum that is kept as exp(scale) * sum.
class LogSum {
 public:
  void add(double weight, double x) {
    if (!(weight > 0) || x == -kInfinity) return;  // a value that is not a number stays one
    if (!(x <= scale_))
      sum_ = sum_ * std::exp(scale_ - x) + weight, scale_ = x;
    else
      sum_ += weight * std::exp(x - scale_);
  }
  double log() const { return sum_ == 0 ? -kInfinity : scale_ + std::log(sum_); }

 private:
  double scale_ = -kInfinity, sum_ = 0;
};

// Scales to sum 1, with no fraction under the least; false where that makes no sense.
bool normalise(Densities& a, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    if (!(a[at(i)] >= 0) || std::isinf(a[at(i)])) return false;
    sum += a[at(i)];
  }
  if (!(sum > 0) || std::isinf(sum)) return false;
  for (int i = 0; i < n; ++i) a[at(i)] /= sum;
  return true;
}

// Fractions proportional to exp(x_i).
Densities fromLogarithms(const Densities& x, int n) {
  const double top = *std::max_element(x.begin(), x.begin() + n);
  Densities a{};
  for (int i = 0; i < n; ++i) a[at(i)] = std::isinf(top) ? (x[at(i)] == top ? 1 : 0) : std::exp(x[at(i)] - top);
  normalise(a, n);
  return a;
}

// Minimises `objective` over the simplex by line searches along which two techniques exchange samples, from several
// starts. In the logarithm of their ratio, so that fractions near 0 and 1 are found.
template <class F>
Densities minimiseOverSimplex(int n, const F& objective) {
  constexpr double kSpan = 36;  // fractions down to e^-36 = 2e-16
  const auto exchange = [&](Densities a, int i, int k, double logRatio) {
    const double both = a[at(i)] + a[at(k)];
    // each by its own formula, so that the small one keeps its digits
    a[at(i)] = both / (1 + std::exp(-logRatio)), a[at(k)] = both / (1 + std::exp(logRatio));
    return a;
  };
  Densities best = equalFractions(n);
  double bestValue = objective(best);
  std::vector<Densities> starts{best};
  if (n > 2)
    for (int i = 0; i < n; ++i) {
      Densities a{};
      std::fill_n(a.begin(), n, 0.02 / (n - 1));
      a[at(i)] = 0.98;
      starts.push_back(a);
    }
  for (Densities a : starts) {
    double value = objective(a);
    for (int round = 0; round < (n == 2 ? 1 : 12); ++round) {
      const double before = value;
      for (int i = 0; i < n; ++i)
        for (int k = i + 1; k < n; ++k) {
          const auto f = [&](double x) { return objective(exchange(a, i, k, x)); };
          constexpr int kSteps = 36;
          constexpr double kStep = 2 * kSpan / kSteps;
          double at0 = 0, low = kInfinity;
          if (round == 0) {
            for (int s = 0; s <= kSteps; ++s) {
              const double x = -kSpan + s * kStep, v = f(x);
              if (v < low) low = v, at0 = x;
            }
          } else {  // near where it was
            at0 = std::clamp(std::log(a[at(i)] / a[at(k)]), -kSpan, kSpan), low = f(at0);
          }
          const auto [x, v] =
              boost::math::tools::brent_find_minima(f, std::max(-kSpan, at0 - kStep), std::min(kSpan, at0 + kStep), 40);
          if (std::min(v, low) < value) {
            a = exchange(a, i, k, v < low ? x : at0);
            value = std::min(v, low);
          }
        }
      if (!(value < before * (1 - 1e-10))) break;
      if (std::abs(value / bestValue - 1) < 1e-8) break;  // where another start has been
    }
    if (value < bestValue) best = a, bestValue = value;
  }
  return best;
}

double meanCost(const Densities& a, const Densities* cost, int n) {
  double c = 0;
  for (int i = 0; i < n; ++i) c += a[at(i)] * (cost != nullptr ? (*cost)[at(i)] : 1.0);
  return c;
}

// What a search over fractions reads hundreds of times of each point, without what it does not read.
template <int N>
struct Node {
  double w, f;
  std::array<double, N> p;
};

template <int N>
class Nodes {
 public:
  explicit Nodes(const Points& points) : outside_(points.outside) {
    list_.reserve(points.list.size());
    for (const Point& x : points.list) {
      Node<N>& node = list_.emplace_back(Node<N>{x.w, x.f, {}});
      std::copy_n(x.p.begin(), N, node.p.begin());
    }
    h_.resize(list_.size());
  }

  // integral f^2/q - mu^2, as a sum of squares.
  double oneSampleVariance(const Densities& a, double mu) const {
    double outside = 0, sum = 0;
    for (int i = 0; i < N; ++i) outside += a[at(i)] * outside_[at(i)];
    for (const Node<N>& x : list_) {
      const double q = mixture(a, x);
      if (q > 0) sum += x.w * square(x.f / q - mu) * q;
    }
    return sum + outside * mu * mu;
  }

  // N Var with balance weights: sum_i a_i Var_{p_i}[f/q].
  double balanceVariance(const Densities& a) {
    std::array<double, N> mean{}, variance{};
    for (size_t j = 0; j < list_.size(); ++j) {
      const Node<N>& x = list_[j];
      const double q = mixture(a, x);
      h_[j] = q > 0 ? x.f / q : 0;
      for (int i = 0; i < N; ++i) mean[at(i)] += x.w * h_[j] * x.p[at(i)];
    }
    for (size_t j = 0; j < list_.size(); ++j)
      for (int i = 0; i < N; ++i) variance[at(i)] += list_[j].w * list_[j].p[at(i)] * square(h_[j] - mean[at(i)]);
    double sum = 0;
    for (int i = 0; i < N; ++i) sum += a[at(i)] * (variance[at(i)] + outside_[at(i)] * square(mean[at(i)]));
    return sum;
  }

 private:
  static double mixture(const Densities& a, const Node<N>& x) {
    double q = 0;
    for (int k = 0; k < N; ++k) q += a[at(k)] * x.p[at(k)];
    return q;
  }

  std::vector<Node<N>> list_;
  std::vector<double> h_;  // f/q
  Densities outside_;
};

// Calls f with the points as Nodes of their number of techniques.
template <int N = 1, class F>
auto withNodes(const Points& points, F&& f) {
  if constexpr (N < kMaxTechniques)
    if (points.techniques > N) return withNodes<N + 1>(points, f);
  Nodes<N> nodes(points);
  return f(nodes);
}

constexpr double kLeastLog = -667;  // ln 1e-290: fractions below this are known by their logarithm alone

// ln a_i. Of fractions below double's range those of Def. 9 follow from the moments; another one that is 0 is so.
Densities logFractions(const Densities& a, const IntegrandMoments& m) {
  const int n = m.techniques;
  Densities logA{};
  LogSum sum;
  for (int i = 0; i < n; ++i) sum.add(1, -m.logSecond[at(i)]);
  for (int i = 0; i < n; ++i) {
    logA[at(i)] = std::log(a[at(i)]);
    if (const double x = -m.logSecond[at(i)] - sum.log(); logA[at(i)] < kLeastLog && x < kLeastLog) logA[at(i)] = x;
  }
  return logA;
}

// The solution of A tau = b, A_ik = <p_i, p_k> and b_i = <f, p_i> under 1/q, with what lies outside the domain, where
// q = a_i p_i: o_i/a_i, of which both may underflow. Scaled so that the diagonal is 1: by sqrt(a_i), a technique with
// next to no samples would be lost, whose density is as good a control variate as any, unless it reaches where nothing
// else does. Of least length: techniques that duplicate each other make A singular.
Densities solveNormalEquations(const Points& points, const Densities& a, const Densities& logA) {
  const int n = points.techniques;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n), scale = Eigen::VectorXd::Zero(n);
  for (const Point& x : points.list) {
    const double q = mixture(a, x.p, n);
    if (!(q > 0)) continue;
    for (int i = 0; i < n; ++i) {
      b(i) += x.w * x.f * (x.p[at(i)] / q);
      for (int k = 0; k <= i; ++k) m(i, k) += x.w * x.p[at(i)] * (x.p[at(k)] / q);
    }
  }
  for (int i = 0; i < n; ++i) {
    if (const double log = points.logOutside[at(i)]; log > -kInfinity) m(i, i) += std::exp(log - logA[at(i)]);
    if (m(i, i) > 0) scale(i) = 1 / std::sqrt(m(i, i));  // infinite without samples that could see it: not usable
  }
  for (int i = 0; i < n; ++i) {
    b(i) *= scale(i);
    for (int k = 0; k <= i; ++k) {
      const bool usable = scale(i) > 0 && scale(k) > 0;
      m(i, k) = m(k, i) = usable ? (i == k ? 1 : m(i, k) * scale(i) * scale(k)) : 0;
    }
  }
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition;
  decomposition.setThreshold(1e-11);
  decomposition.compute(m);
  const Eigen::VectorXd solution = decomposition.solve(b);
  Densities tau{};
  for (int i = 0; i < n; ++i) tau[at(i)] = scale(i) * solution(i);
  return tau;
}
Densities solveNormalEquations(const Points& points, const Densities& a) {
  Densities logA{};
  for (int i = 0; i < points.techniques; ++i) logA[at(i)] = std::log(a[at(i)]);
  return solveNormalEquations(points, a, logA);
}

// One Newton step on V(a) = integral f^2/(a p_1 + (1-a) p_2) from a = 1/2, clamped.
Densities secondOrder(const Points& points) {
  const double first = -points.integrate([](const Point& x) {
    const double q = 0.5 * (x.p[0] + x.p[1]);
    return q > 0 ? square(x.f / q) * (x.p[0] - x.p[1]) : 0;
  });
  const double second = 2 * points.integrate([](const Point& x) {
    const double q = 0.5 * (x.p[0] + x.p[1]);
    return q > 0 ? square(x.f / q) * ((x.p[0] - x.p[1]) / q) * (x.p[0] - x.p[1]) : 0;
  });
  const double a = second > 0 ? std::clamp(0.5 - first / second, 0.05, 0.95) : 0.5;
  return {a, 1 - a};
}

}  // namespace

std::string_view name(Allocation a) {
  constexpr std::string_view names[] = {
      "equal",  "variance",     "standard-deviation", "second-moment", "inverse-variance", "equalised",
      "linear", "second-order", "representativity",   "best",          "albedo",           "auto"};
  return names[static_cast<int>(a)];
}
std::string_view name(Weights w) {
  constexpr std::string_view names[] = {"balance", "nonbalance",     "power",  "cutoff",
                                        "maximum", "variance-aware", "optimal"};
  return names[static_cast<int>(w)];
}

Densities equalFractions(int n) {
  Densities a{};
  std::fill_n(a.begin(), n, 1.0 / n);
  return a;
}

std::span<const Strategy> strategies() { return kStrategies; }

const Strategy* findStrategy(std::string_view name) {
  const auto it = std::find_if(std::begin(kStrategies), std::end(kStrategies), [&](auto& s) { return s.name == name; });
  return it != std::end(kStrategies) ? it : nullptr;
}

double IntegrandMoments::second(int i) const { return std::exp(logSecond[at(i)]); }

IntegrandMoments momentsOf(const Points& points) {
  IntegrandMoments m;
  const int n = m.techniques = points.techniques;
  std::array<LogSum, kMaxTechniques> second;
  for (const Point& x : points.list) {
    m.integral += x.w * x.f;
    const double sum = mixture(Densities{1, 1, 1, 1, 1, 1, 1, 1}, x.p, n);
    if (!(x.f > 0)) continue;
    for (int i = 0; i < n; ++i) {
      if (sum > 0) m.mean[at(i)] += x.w * x.f * (x.p[at(i)] / sum);
      second[at(i)].add(x.w, 2 * std::log(x.f) - x.logP[at(i)]);
    }
  }
  for (int i = 0; i < n; ++i) {
    m.logSecond[at(i)] = second[at(i)].log();
    m.variance[at(i)] = points.outside[at(i)] * square(m.mean[at(i)]);
    m.variancePrim[at(i)] =
        m.logSecond[at(i)] > std::log(kHuge) ? kInfinity : points.outside[at(i)] * square(m.integral);
  }
  for (const Point& x : points.list) {
    const double sum = mixture(Densities{1, 1, 1, 1, 1, 1, 1, 1}, x.p, n);
    for (int i = 0; i < n; ++i) {
      if (sum > 0) m.variance[at(i)] += x.w * square(x.f / sum - m.mean[at(i)]) * x.p[at(i)];
      if (std::isinf(m.variancePrim[at(i)])) continue;
      const double ratio = x.f > 0 ? std::exp(std::log(x.f) - x.logP[at(i)]) : 0;
      m.variancePrim[at(i)] += ratio > 1e8 * m.integral ? x.w * std::exp(2 * std::log(x.f) - x.logP[at(i)])
                                                        : x.w * square(ratio - m.integral) * x.p[at(i)];
    }
  }
  return m;
}

Densities fractions(Allocation rule, const IntegrandMoments& m, const Densities* cost) {
  const int n = m.techniques;
  Densities a{}, x{};
  const auto c = [&](int i) { return cost != nullptr ? (*cost)[at(i)] : 1.0; };
  switch (rule) {
    case A::kVariance:
      for (int i = 0; i < n; ++i) a[at(i)] = m.variance[at(i)] / c(i);
      break;
    case A::kStandardDeviation:
      for (int i = 0; i < n; ++i) a[at(i)] = std::sqrt(m.variance[at(i)] / c(i));
      break;
    case A::kSecondMoment:
      for (int i = 0; i < n; ++i) {
        if (m.logSecond[at(i)] == -kInfinity) return equalFractions(n);
        x[at(i)] = -m.logSecond[at(i)] - std::log(c(i));
      }
      return fromLogarithms(x, n);
    case A::kInverseVariance:
      for (int i = 0; i < n; ++i) {
        if (!(m.variancePrim[at(i)] > 0)) return equalFractions(n);
        x[at(i)] = std::isinf(m.variancePrim[at(i)]) ? -m.logSecond[at(i)] : -std::log(m.variancePrim[at(i)]);
        x[at(i)] -= std::log(c(i));
      }
      return fromLogarithms(x, n);
    case A::kRepresentativity:
      for (int i = 0; i < n; ++i) a[at(i)] = m.mean[at(i)] / std::sqrt(c(i));
      break;
    case A::kEqualised:
      for (int i = 0; i < n; ++i) a[at(i)] = std::sqrt(m.square[at(i)] / c(i));
      break;
    default:
      break;
  }
  return normalise(a, n) ? a : equalFractions(n);
}

Densities fractions(Allocation rule, const Points& points, const IntegrandMoments& m, const Densities* cost) {
  const int n = points.techniques;
  Densities a{};
  switch (rule) {
    case A::kEqualised:
      return withNodes(points, [&](const auto& nodes) {
        return minimiseOverSimplex(n, [&](const Densities& f) {
          return (nodes.oneSampleVariance(f, m.integral) + (cost != nullptr ? square(m.integral) : 0)) *
                 meanCost(f, cost, n);
        });
      });
    case A::kBest:
    case A::kAuto:
      return withNodes(points, [&](auto& nodes) {
        return minimiseOverSimplex(n,
                                   [&](const Densities& f) { return nodes.balanceVariance(f) * meanCost(f, cost, n); });
      });
    case A::kSecondOrder:
      if (n != 2) return equalFractions(n);
      a = secondOrder(points);
      break;
    case A::kLinear: {
      a = solveNormalEquations(points, equalFractions(n));
      for (int i = 0; i < n; ++i) a[at(i)] = std::max(0.0, a[at(i)]);
      break;
    }
    default:
      return fractions(rule, m, cost);
  }
  if (cost != nullptr)
    for (int i = 0; i < n; ++i) a[at(i)] /= std::sqrt((*cost)[at(i)]);
  return normalise(a, n) ? a : equalFractions(n);
}

double weightedValue(Weights rule, int i, int n, double f, const Densities& p, const Densities& a, const Densities& v) {
  const double own = a[at(i)] * p[at(i)];
  switch (rule) {
    case W::kBalance: {
      const double q = mixture(a, p, n);
      return q > 0 ? a[at(i)] * (f / q) : 0;
    }
    case W::kNonbalance: {
      double sum = 0;
      for (int k = 0; k < n; ++k) sum += p[at(k)];
      return sum > 0 ? f / sum : 0;
    }
    case W::kPower: {  // by ratios: squares overflow and underflow
      if (!(own > 0)) return 0;
      double sum = 0;
      for (int k = 0; k < n; ++k) sum += square(a[at(k)] * p[at(k)] / own);
      return f / (sum * p[at(i)]);
    }
    case W::kCutoff:
    case W::kMaximum: {
      const double ratio = rule == W::kCutoff ? kCutoffRatio : kTieRatio<double>;
      double top = 0, sum = 0;
      for (int k = 0; k < n; ++k) top = std::max(top, a[at(k)] * p[at(k)]);
      if (!(own > 0) || own < ratio * top) return 0;
      for (int k = 0; k < n; ++k)
        if (a[at(k)] * p[at(k)] >= ratio * top) sum += a[at(k)] * p[at(k)];
      return a[at(i)] * (f / sum);
    }
    case W::kVarianceAware: {
      double sum = 0;
      for (int k = 0; k < n; ++k) sum += v[at(k)] * a[at(k)] * p[at(k)];
      return sum > 0 ? v[at(i)] * a[at(i)] * (f / sum) : 0;
    }
    case W::kOptimal:
      break;  // no function of a and p alone
  }
  return 0;
}

Densities varianceAwareFactors(const IntegrandMoments& m) {
  Densities v{};
  for (int i = 0; i < m.techniques; ++i) {
    const double variance = m.variancePrim[at(i)];
    v[at(i)] = std::isinf(variance) ? 1 : std::min(1e12, 1 + square(m.integral) / variance);
    if (!(variance > 0)) v[at(i)] = 1e12;
  }
  return v;
}

Densities optimalTau(const Points& points, const Densities& a) { return solveNormalEquations(points, a); }

Contributions contributions(Weights rule, const Densities& a, const Points& points, const IntegrandMoments& m) {
  const int n = points.techniques;
  const Densities v = rule == W::kVarianceAware ? varianceAwareFactors(m) : Densities{};
  const bool optimal = rule == W::kOptimal;
  const Densities logA = optimal ? logFractions(a, m) : Densities{};
  const Densities tau = optimal ? solveNormalEquations(points, a, logA) : Densities{};
  const auto y = [&](int i, const Point& x) {
    if (!optimal) return weightedValue(rule, i, n, x.f, x.p, a, v);
    const double q = mixture(a, x.p, n);
    return q > 0 ? a[at(i)] * ((x.f - mixture(tau, x.p, n)) / q) : 0;
  };
  // One walk over the points, which are large; the second is over y_i and w p_i alone.
  struct Term {
    double y, wp;
  };
  const size_t size = points.list.size();
  std::vector<Term> terms(size * at(n));
  Contributions c;
  for (size_t k = 0; k < size; ++k) {
    const Point& x = points.list[k];
    for (int i = 0; i < n; ++i) {
      const double p = x.p[at(i)], value = a[at(i)] > 0 && p > 0 ? y(i, x) : 0;
      terms[at(i) * size + k] = {value, x.w * p};
      c.mean[at(i)] += x.w * (value * p);
    }
  }
  for (int i = 0; i < n; ++i) {
    if (optimal && logA[at(i)] < kLeastLog) {
      if (tau[at(i)] != 0) c.rare[at(i)] = square(tau[at(i)]) * std::exp(points.logOutside[at(i)] - logA[at(i)]);
      continue;
    }
    if (!(a[at(i)] > 0)) continue;
    const double outside = points.outside[at(i)], there = optimal ? -tau[at(i)] : 0;
    const double mean = c.mean[at(i)] += outside * there;
    double variance = outside * square(there - mean), fourth = variance * square(there - mean);
    for (const Term& t : std::span(terms).subspan(at(i) * size, size)) {
      const double d2 = square(t.y - mean), weighted = t.wp * d2;
      variance += weighted, fourth += weighted * d2;
    }
    c.variance[at(i)] = variance, c.fourth[at(i)] = fourth;
  }
  return c;
}

double logVariance(Weights rule, const Densities& a, const Points& points, const IntegrandMoments& m) {
  return logVariance(rule, a, m, rule == W::kNonbalance ? Contributions{} : contributions(rule, a, points, m));
}

double logVariance(Weights rule, const Densities& a, const IntegrandMoments& m, const Contributions& c) {
  const int n = m.techniques;
  const Densities& variance = rule == W::kNonbalance ? m.variance : c.variance;
  const Densities logA = logFractions(a, m);
  LogSum sum;
  for (int i = 0; i < n; ++i) {
    if (!(variance[at(i)] == 0)) sum.add(1, std::log(variance[at(i)]) - logA[at(i)]);
    if (!(c.rare[at(i)] == 0)) sum.add(1, std::log(c.rare[at(i)]));
  }
  return sum.log();
}

double logVarianceOneSample(const Densities& a, const Points& points) {
  const double mu = points.integrate([](const Point& x) { return x.f; });
  return std::log(withNodes(points, [&](const auto& nodes) { return nodes.oneSampleVariance(a, mu); }));
}

std::array<int, kMaxTechniques> wholeCounts(const Densities& a, int techniques, int n) {
  std::array<int, kMaxTechniques> counts{};
  std::vector<std::pair<double, int>> rest;
  int given = 0;
  for (int i = 0; i < techniques; ++i) {
    const double exact = a[at(i)] * n;
    counts[at(i)] = static_cast<int>(exact);
    given += counts[at(i)];
    rest.emplace_back(exact - counts[at(i)], -i);
  }
  std::sort(rest.rbegin(), rest.rend());
  for (size_t k = 0; given < n; k = (k + 1) % rest.size(), ++given) ++counts[at(-rest[k].second)];
  for (int i = 0; i < techniques; ++i)
    while (counts[at(i)] < 1) {
      --*std::max_element(counts.begin(), counts.begin() + techniques);
      ++counts[at(i)];
    }
  return counts;
}

}  // namespace wardmis
