// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/problem.h"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/quadrature/tanh_sinh.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <cmath>
#include <limits>

#include "bsdf/phong.h"
#include "bsdf/ward.h"
#include "math/warp.h"
#include "study/peaks.h"
#include "study/slope_disk.h"

namespace wardmis {

namespace {

constexpr double kPid = kPi<double>, kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

double sinhDifference(double a, double b) { return 2 * std::cosh((a + b) / 2) * std::sinh((a - b) / 2); }

// What all cases share: from cos(theta_i) and the lobe's values to f and all densities.
class Case : public Problem {
 protected:
  explicit Case(const StudyInput& input)
      : Problem(input),
        planar_(input.mode == StudyMode::kPlanar),
        so_(sinDegrees(input.thetaO)),
        co_(cosDegrees(input.thetaO)) {}

  // fsCos: f_s cos(theta_i) for rho_s = 1; lobe: density of the lobe technique and its logarithm.
  double integrand(double ci, double fsCos) const {
    const double diffuse = input_.joint ? input_.rhoD * ci / kPid : 0;
    return (planar_ ? 2 * kPid : 1) * (input_.rhoS * fsCos + diffuse) * input_.R * ci;
  }
  double density(StudyTechnique t, double ci) const {  // of the techniques that are not the lobe
    return (planar_ ? 2 * kPid : 1) * (t == StudyTechnique::kCosine ? ci / kPid : 0.5 / kPid);
  }
  Point point(double ci, double fsCos, double logLobe, double measure) const {
    Point x;
    x.w = measure;
    x.f = integrand(ci, fsCos);
    for (size_t k = 0; k < input_.techniques.size(); ++k) {
      const StudyTechnique t = input_.techniques[k];
      x.logP[k] = t == StudyTechnique::kLobe ? logLobe : std::log(density(t, ci));
      x.p[k] = t == StudyTechnique::kLobe ? std::exp(logLobe) : density(t, ci);
    }
    return x;
  }
  void set(SampleBlock& block, size_t j, double ci, double fsCos, double lobe) const {
    const bool above = ci > 0;
    block.f[j] = above ? integrand(ci, fsCos) : 0;
    for (size_t k = 0; k < input_.techniques.size(); ++k) {
      const StudyTechnique t = input_.techniques[k];
      block.p[k][j] = !above ? 0 : t == StudyTechnique::kLobe ? lobe : density(t, ci);
    }
  }
  StudyTechnique technique(int i) const { return input_.techniques[static_cast<size_t>(i)]; }

  bool planar_;
  double so_, co_;
};

// ---- the full model -------------------------------------------------------------------------------------------------

// Hemisphere directions of the techniques that are not the lobe.
Vec3<double> sampleHemisphere(StudyTechnique t, Stream& random) {
  const Vec2<double> u = random.square();
  if (t == StudyTechnique::kCosine) return toCosineHemisphere(u);
  return toCone(u, 1.0);
}

class WardFull final : public Case {
 public:
  explicit WardFull(const StudyInput& input)
      : Case(input),
        variant_(wardVariant(input.brdf)),
        disk_(input.alphaX, input.alphaY, input.thetaO, input.phiO),
        logK_(-std::log(kPid * input.alphaX * input.alphaY)) {}

  // Polar coordinates of the slope disk, in two parts: the lobe, out to r = 12 (or, smoothly, to where the horizon
  // comes first), and from there on all scales evenly, r = sinh(c).
  std::vector<Chart> charts() const override {
    const double turn = disk_.isotropic() ? kPid : 2 * kPid, fold = disk_.isotropic() ? 2 : 1;
    const auto lobeEnd = [](const SlopeDisk::Ring& ring) {
      return 1 / std::pow(std::pow(ring.rMax, -4) + std::pow(12.0, -4), 0.25);
    };
    const std::vector<double> breaks = disk_.breaks(turn);
    return {{[=, this](double u, double v) {
               const SlopeDisk::Ring ring = disk_.ringAt(turn * v);
               const double end = lobeEnd(ring), r = end * u;
               // beyond the end by rounding alone where the horizon comes first
               const Slope s = disk_.slopeAt(ring, r, std::max(0.0, ring.rMax - end) + end * (1 - u));
               return at(s, fold * turn * end * r * s.perSlope);
             },
             2, breaks},
            {[=, this](double u, double v) {
               const SlopeDisk::Ring ring = disk_.ringAt(turn * v);
               const double c0 = std::asinh(std::min(lobeEnd(ring), ring.rMax)), c1 = std::asinh(ring.rMax);
               const double c = c0 + (c1 - c0) * u;
               const Slope s = disk_.slopeAt(ring, std::sinh(c), sinhDifference(c1, c));
               return at(s, fold * turn * (c1 - c0) * std::cosh(c) * std::sinh(c) * s.perSlope);
             },
             2, breaks}};
  }

  double logOutside(int i) const override {
    return technique(i) == StudyTechnique::kLobe ? disk_.logBelow() : -kInfinity;
  }

  // f^2/p_1 dwi = f^2 (dwi/d(r^2) dpsi)^2 2 pi e^E: with y = E_max - E, e^E_max times a plain integral over y.
  double logSecondMomentAtEdge(int i) const override {
    if (technique(i) != StudyTechnique::kLobe || !input_.joint || !(input_.rhoD > 0)) return kNaN;
    const auto peak = [this](double psi) { return square(disk_.ringAt(psi).rMax); };
    double top = 0;
    for (int k = 0; k < 720; ++k) top = std::max(top, peak(k * kPid / 360));
    if (top < 30) return kNaN;
    boost::math::quadrature::tanh_sinh<double> quadrature(10);
    const auto rest = [&](double psi) {
      const SlopeDisk::Ring ring = disk_.ringAt(psi);
      const double eMax = square(ring.rMax);
      return quadrature.integrate(
          [&](double y) {
            const double r = std::sqrt(std::max(0.0, eMax - y));
            const Slope s = disk_.slopeAt(ring, r, y / (ring.rMax + r));
            if (!(s.ci > 0)) return 0.0;
            const double f = at(s, 1).f;
            return std::exp(-y) * square(f * s.perSlope) * (kPid / 2);
          },
          0.0, std::min(eMax, 200.0), 1e-10);
    };
    return logIntegralOfPeaks(peak, rest);
  }

  void sample(int i, Stream& random, SampleBlock& block, size_t first, size_t last) const override {
    const StudyTechnique t = technique(i);
    const Vec3<double> wo = disk_.wo();
    const double ax = input_.alphaX, ay = input_.alphaY, invAx = 1 / ax, invAy = 1 / ay;
    for (size_t j = first; j < last; ++j) {
      const Vec3<double> wi =
          t == StudyTechnique::kLobe ? wardSample(wo, ax, ay, random.square()) : sampleHemisphere(t, random);
      const WardValue<double> w = wardEvaluate(variant_, wi, wo, invAx, invAy);
      set(block, j, wi.z, w.fCos, w.pdf);
    }
  }

 private:
  using Slope = SlopeDisk::Slope;
  Point at(const Slope& s, double measure) const {
    const double logP = logK_ + std::log(0.5 * s.slope / s.hz) - s.e;
    const WardHalf<double> half(std::exp(logK_ - s.e), s.slope, s.hz);
    double fCos = 0;
    if (variant_ == WardVariant::kWard)
      fCos = half.fCos<WardVariant::kWard>(s.ci, co_);
    else if (variant_ == WardVariant::kWardDur)
      fCos = half.fCos<WardVariant::kWardDur>(s.ci, co_);
    else
      fCos = half.fCos<WardVariant::kWardGmd>(s.ci, co_);
    return point(s.ci, fCos, logP, measure);
  }

  WardVariant variant_;
  SlopeDisk disk_;
  double logK_;
};

class PhongFull final : public Case {
 public:
  explicit PhongFull(const StudyInput& input) : Case(input), m_(input.m), wo_{so_, 0, co_} {}

  // Polar coordinates (gamma, chi) about the mirror direction, out to the horizon and, since f_s ends there, in two
  // parts at gamma = 90 degrees.
  std::vector<Chart> charts() const override {
    std::vector<Chart> charts{{[this](double u, double v) {
                                 const double chi = kPid * v;
                                 return at(0, std::min(horizon(chi), kPid / 2), u, chi);
                               },
                               2}};
    if (so_ > 0)  // f_s = 0 there, but the other techniques' samples reach it
      charts.push_back({[this](double u, double v) {
                          const double chi = kPid / 2 * v;  // there the horizon lies beyond 90 degrees
                          return at(kPid / 2, horizon(chi), u, chi);
                        },
                        2});
    return charts;
  }

  // 1/pi times the integral of cos(horizon)^(m + 1), whose largest value is sin(theta_o)^(m + 1)
  double logOutside(int i) const override {
    if (technique(i) != StudyTechnique::kLobe || !(so_ > 0)) return -kInfinity;
    const double rest = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
        [this](double chi) { return std::pow(std::max(0.0, std::cos(horizon(chi))) / so_, m_ + 1); }, kPid / 2, kPid,
        20, 1e-13);
    return (m_ + 1) * std::log(so_) + std::log(rest / kPid);
  }

  double logSecondMomentAtEdge(int i) const override {
    if (technique(i) != StudyTechnique::kLobe || !input_.joint || !(input_.rhoD > 0)) return kNaN;
    return m_ >= (so_ > 0 ? 1 : 5) ? kInfinity : kNaN;  // integral of cos(gamma)^-m, times cos^4 at normal incidence
  }

  void sample(int i, Stream& random, SampleBlock& block, size_t first, size_t last) const override {
    const StudyTechnique t = technique(i);
    for (size_t j = first; j < last; ++j) {
      const Vec3<double> wi =
          t == StudyTechnique::kLobe ? phongSample(wo_, m_, random.square()) : sampleHemisphere(t, random);
      const PhongValue<double> v = phongEvaluate(phongCosGamma(wi, wo_), m_);
      set(block, j, wi.z, v.f * wi.z, v.pdf);
    }
  }

 private:
  // The gamma at which wi.z = cos(gamma) co + sin(gamma) so cos(chi) vanishes.
  double horizon(double chi) const { return std::atan2(co_, -so_ * std::cos(chi)); }

  Point at(double from, double to, double u, double chi) const {
    const double sigma = std::sqrt(2 / (m_ + 2)), c = std::asinh((to - from) / sigma);
    const double gamma = from + sigma * std::sinh(c * u), left = sigma * sinhDifference(c, c * u);
    const double edge = horizon(chi) - to;  // 0 where the horizon ends the part
    const double ci = std::hypot(co_, so_ * std::cos(chi)) * std::sin(left + edge);
    // the lobe's cosine: near its end, where it vanishes, from the distance to it
    const double cosGamma = to == kPid / 2 ? std::sin(left) : gamma > kPid / 2 ? 0 : std::cos(gamma);
    const PhongValue<double> v = phongEvaluate(cosGamma, m_);
    const double logLobe = cosGamma > 0 ? std::log((m_ + 1) / (2 * kPid)) + m_ * std::log(cosGamma) : -kInfinity;
    return point(ci, v.f * ci, logLobe,
                 2 * kPid * (from > 0 ? 0.5 : 1) * std::sin(gamma) * sigma * c * std::cosh(c * u));
  }

  double m_;
  Vec3<double> wo_;
};

// ---- the planar reduction -------------------------------------------------------------------------------------------

// In t = tan((theta_i - theta_o)/2), E = t^2/alpha^2, from theta_i = 0 to 90 degrees; t = alpha sinh(s).
class WardPlanar final : public Case {
 public:
  explicit WardPlanar(const StudyInput& input) : Case(input), variant_(wardVariant(input.brdf)), alpha_(input.alphaX) {
    const double half = input.thetaO * (kPid / 360);
    t0_ = -std::tan(half);
    t1_ = co_ / (1 + so_);  // tan(45 - theta_o/2)
    s0_ = std::asinh(t0_ / alpha_), s1_ = std::asinh(t1_ / alpha_);
    logZ_ = 0;
    logZ_ = std::log(integrateLobe());
  }

  std::vector<Chart> charts() const override {
    // in two parts, each graded towards its end
    return {{[this](double u, double) { return at(0, s0_, u); }, 1},
            {[this](double u, double) { return at(0, s1_, u); }, 1}};
  }
  double logOutside(int) const override { return -kInfinity; }
  double lobeNormalization() const override { return std::exp(logZ_); }

  double logSecondMomentAtEdge(int i) const override {
    if (technique(i) != StudyTechnique::kLobe || !input_.joint || !(input_.rhoD > 0)) return kNaN;
    const double e0 = square(t0_ / alpha_), e1 = square(t1_ / alpha_), top = std::max(e0, e1);
    if (top < 30) return kNaN;
    boost::math::quadrature::tanh_sinh<double> quadrature(12);
    double sum = 0;
    for (const auto& [end, eMax] : {std::pair{t0_, e0}, {t1_, e1}}) {
      if (top - eMax > 700 || end == 0) continue;
      const double sign = end < 0 ? -1 : 1;
      sum += std::exp(eMax - top) * quadrature.integrate(
                                        [&, end = end, eMax = eMax](double y) {
                                          const double r = std::sqrt(std::max(0.0, eMax - y)), t = sign * alpha_ * r;
                                          if (!(r > 0)) return 0.0;
                                          const double left =
                                              alpha_ * y / (std::sqrt(eMax) + r);  // distance to the end
                                          const Spot s = spotAt(t, end < 0 ? left : t - t0_, end < 0 ? t1_ - t : left);
                                          // f^2/p dx, p dx = exp(logLobe + E) e^-E dx
                                          const double f = value(s, 1).f, dx = s.perT * alpha_ / (2 * r);
                                          return std::exp(-y - logLobe(s) - s.e) * f * f * dx;
                                        },
                                        0.0, std::min(eMax, 200.0), 1e-11);
    }
    return top + std::log(sum);
  }

  // The lobe by rejection: its density over t is w(t) exp(-t^2/alpha^2) with w convex and increasing, which lies under
  // w(0) + k max(0, t), the chord of its upper part: a truncated Gaussian and a truncated Rayleigh.
  void sample(int i, Stream& random, SampleBlock& block, size_t first, size_t last) const override {
    const StudyTechnique technique = this->technique(i);
    const double a0 = t0_ / alpha_, a1 = t1_ / alpha_, w0 = w(0), k = (w(t1_) - w0) / t1_;
    const double erf0 = std::erf(a0), erf1 = std::erf(a1), rayleigh = -std::expm1(-a1 * a1);
    const double gaussMass = w0 * alpha_ * std::sqrt(kPid) / 2 * (erf1 - erf0),
                 mass = gaussMass + k * alpha_ * alpha_ / 2 * rayleigh;
    const auto lobe = [&] {
      while (true) {
        double t;
        if (random.uniform() * mass < gaussMass) {
          const double e = erf0 + (erf1 - erf0) * random.uniform();
          t = alpha_ * boost::math::erf_inv(std::clamp(e, -1 + 1e-16, 1 - 1e-16));
        } else {
          t = alpha_ * std::sqrt(-std::log1p(-rayleigh * random.uniform()));
        }
        if (t < t0_ || t > t1_) continue;
        if (random.uniform() * (w0 + k * std::max(0.0, t)) < w(t)) return t;
      }
    };
    for (size_t j = first; j < last; ++j) {
      double t;
      if (technique == StudyTechnique::kLobe) {
        t = lobe();
      } else {
        const double u = random.uniform(), x = technique == StudyTechnique::kCosine ? std::sqrt(u) : u;
        t = std::clamp(std::tan((std::acos(x) - std::atan2(so_, co_)) / 2), t0_, t1_);
      }
      const Spot s = spotAt(t, t - t0_, t1_ - t);
      set(block, j, s.ci, fCos(s), std::exp(logLobe(s)));
    }
  }

 private:
  struct Spot {
    double t, e, ci, hz, perT;  // e = E; perT: |dx/dt|
  };
  // from0 = t - t0, to1 = t1 - t
  Spot spotAt(double t, double from0, double to1) const {
    const double slope = 1 + t * t, ci = co_ * to1 * (t + 1 / t1_) / slope;
    const double sine = so_ > 0 ? so_ * from0 * (-1 / t0_ - t) / slope : 2 * t / slope;
    return {t, square(t / alpha_), ci, ci + co_, 2 * std::max(0.0, sine) / slope};
  }
  double logLobe(const Spot& s) const {  // ln(P/Z)
    return -std::log(kPid * alpha_ * alpha_) + std::log(0.5 * (1 + s.t * s.t) / s.hz) - s.e - logZ_;
  }
  double w(double t) const { return (so_ + co_ * t) / (co_ - so_ * t) + t; }
  double fCos(const Spot& s) const {
    const WardHalf<double> half(std::exp(-s.e) / (kPid * alpha_ * alpha_), 1 + s.t * s.t, s.hz);
    if (variant_ == WardVariant::kWard) return half.fCos<WardVariant::kWard>(s.ci, co_);
    if (variant_ == WardVariant::kWardDur) return half.fCos<WardVariant::kWardDur>(s.ci, co_);
    return half.fCos<WardVariant::kWardGmd>(s.ci, co_);
  }
  Point value(const Spot& s, double measure) const { return point(s.ci, fCos(s), logLobe(s), measure); }

  // u from 0 (at s = from) to 1 (at s = to)
  Point at(double from, double to, double u) const {
    const double s = from + (to - from) * u, t = alpha_ * std::sinh(s);
    const double left = alpha_ * std::abs(sinhDifference(to, s));
    const Spot x = to < 0 ? spotAt(t, left, t1_ - t) : spotAt(t, t - t0_, left);
    return value(x, x.perT * alpha_ * std::cosh(s) * std::abs(to - from));
  }
  double integrateLobe() const {
    const auto dp = [this](double end) {
      return boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
          [&](double u) {
            const double s = end * u, t = alpha_ * std::sinh(s);
            const Spot x = spotAt(t, t - t0_, t1_ - t);
            return std::exp(logLobe(x)) * x.perT * alpha_ * std::cosh(s) * std::abs(end);
          },
          0.0, 1.0, 15, 1e-14);
    };
    return dp(s0_) + dp(s1_);
  }

  WardVariant variant_;
  double alpha_, t0_, t1_, s0_, s1_, logZ_;
};

// f_s = (m + 2)/(2 pi) x^m at normal incidence; x = 1 - y.
class PhongPlanar final : public Case {
 public:
  explicit PhongPlanar(const StudyInput& input) : Case(input), m_(input.m) {}

  std::vector<Chart> charts() const override {
    return {{[this](double u, double) {
               const double sigma = 1 / (m_ + 2), c = std::asinh(1 / sigma);
               const double x = sigma * sinhDifference(c, c * u);
               const PhongValue<double> v = phongEvaluate(x, m_);
               return point(x, v.f * x, std::log(m_ + 1) + m_ * std::log(x), sigma * c * std::cosh(c * u));
             },
             1}};
  }
  double logOutside(int) const override { return -kInfinity; }
  double logSecondMomentAtEdge(int i) const override {
    return technique(i) == StudyTechnique::kLobe && input_.joint && input_.rhoD > 0 && m_ >= 5 ? kInfinity : kNaN;
  }
  void sample(int i, Stream& random, SampleBlock& block, size_t first, size_t last) const override {
    const StudyTechnique t = technique(i);
    for (size_t j = first; j < last; ++j) {
      const double u = 1 - random.uniform();
      const double x = t == StudyTechnique::kLobe     ? std::pow(u, 1 / (m_ + 1))
                       : t == StudyTechnique::kCosine ? std::sqrt(u)
                                                      : u;
      const PhongValue<double> v = phongEvaluate(x, m_);
      set(block, j, x, v.f * x, 2 * kPid * v.pdf);
    }
  }

 private:
  double m_;
};

}  // namespace

std::unique_ptr<Problem> makeProblem(const StudyInput& input) {
  input.check();
  if (input.mode == StudyMode::kFull)
    return input.ward() ? std::unique_ptr<Problem>(std::make_unique<WardFull>(input))
                        : std::make_unique<PhongFull>(input);
  return input.ward() ? std::unique_ptr<Problem>(std::make_unique<WardPlanar>(input))
                      : std::make_unique<PhongPlanar>(input);
}

}  // namespace wardmis
