// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability_lobe.h"

#include <Eigen/Dense>
#include <boost/math/distributions/chi_squared.hpp>

#include "study/cubature.h"
#include "study/slope_disk.h"

namespace wardmis {

namespace {

using Extended = long double;

SlopeDisk diskOf(const StudyInput& in) { return SlopeDisk(in.alphaX, in.alphaY, in.thetaO, in.phiO); }

// wi of a slope. Its z comes from the distance to the horizon, where the reflection formula cancels.
Vec3<Extended> directionAt(const SlopeDisk& disk, const StudyInput& in, const SlopeDisk::Ring& ring, double r,
                           double psi, double left, double& perSlope) {
  const SlopeDisk::Slope s = disk.slopeAt(ring, r, left);
  perSlope = s.perSlope;
  const Extended sx = Extended(in.alphaX) * r * std::cos(Extended(psi)),
                 sy = Extended(in.alphaY) * r * std::sin(Extended(psi));
  const Vec3<double> wo = disk.wo();
  const Extended hz = Extended(s.ci) + wo.z;
  return {hz * sx - wo.x, hz * sy - wo.y, s.ci};
}
Vec3<Extended> extendedWo(const SlopeDisk& disk) {
  const Vec3<double> wo = disk.wo();
  return {wo.x, wo.y, wo.z};
}

// The lobe alone as a problem of the cubature's: f is f_s cos, p_0 the pdf, both of the functions under test.
class LobeProblem final : public Problem {
 public:
  LobeProblem(const StudyInput& input, const WardFunctions<Extended>& tested)
      : Problem(input), tested_(tested), disk_(diskOf(input)) {}

  std::vector<Chart> charts() const override {
    constexpr double kEnd = 12;  // what lies beyond is e^-144
    const double turn = 2 * kPi<double>;
    return {{[=, this](double u, double v) {
               const SlopeDisk::Ring ring = disk_.ringAt(turn * v);
               const double end = std::min(ring.rMax, kEnd), r = end * u;
               double perSlope = 0;
               const Vec3<Extended> wi =
                   directionAt(disk_, input_, ring, r, turn * v, (ring.rMax - end) + end * (1 - u), perSlope);
               const WardValue<Extended> value = tested_.evaluate(wardVariant(input_.brdf), wi, extendedWo(disk_),
                                                                  Extended(input_.alphaX), Extended(input_.alphaY));
               Point x;
               x.w = turn * end * r * perSlope;
               x.f = double(value.fCos), x.p[0] = double(value.pdf);
               return x;
             },
             2, disk_.breaks(turn)}};
  }
  double logOutside(int) const override { return disk_.logBelow(); }
  double logSecondMomentAtEdge(int) const override { return std::nan(""); }
  void sample(int, Stream&, SampleBlock&, size_t, size_t) const override {}  // chiSquareOfLobe has its own

 private:
  const WardFunctions<Extended>& tested_;
  SlopeDisk disk_;
};

}  // namespace

void integrateLobe(const WardFunctions<Extended>& tested, const StudyInput& input, LobeReport& report) {
  const LobeProblem problem(input, tested);
  Cubature cubature(problem);
  cubature.refine({2, [](const Point& x, double* out) { out[0] = x.p[0], out[1] = x.f; }}, 1e-11, 300);
  const Points points = cubature.points();
  const auto pdf = [](const Point& x) { return x.p[0]; };
  const auto f = [](const Point& x) { return x.f; };
  report.mass = points.integrate(pdf), report.albedo = points.integrate(f);
  report.quadrature = std::max(relativeError(points, pdf), relativeError(points, f));
  report.below = std::exp(problem.logOutside(0));
}

namespace {

double chiSquareLevel(double statistic, int degrees) {
  // NaN from a broken density must not pass
  if (!(statistic >= 0) || std::isinf(statistic)) return 0;
  return boost::math::cdf(boost::math::complement(boost::math::chi_squared(std::max(1, degrees)), statistic));
}

// Means of smooth functions of (1 - e^-E, psi) over the samples above the horizon: a sampler that is a little too wide,
// too long or turned shifts them in every cell a little, which the many cells of the histogram do not show.
constexpr int kFeatures = 6;
using Features = Eigen::Matrix<double, kFeatures, 1>;
Features featuresAt(double w, double psi) {
  return Features{1, w, std::cos(psi), std::sin(psi), std::cos(2 * psi), std::sin(2 * psi)};
}

// Hotelling's statistic of the mean, whose expectation and covariance the density gives.
double levelOfMeans(const Features& sum, const Features& expected,
                    const Eigen::Matrix<double, kFeatures, kFeatures>& second, int count) {
  const Features off = sum / count - expected;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, kFeatures, kFeatures>> axes(
      second - expected * expected.transpose());
  double statistic = 0;
  int degrees = 0;
  for (int k = 0; k < kFeatures; ++k) {
    if (!(axes.eigenvalues()[k] * count > 5)) continue;  // a share of samples too small to be normal, or none
    statistic += count * square(axes.eigenvectors().col(k).dot(off)) / axes.eigenvalues()[k], ++degrees;
  }
  return chiSquareLevel(statistic, degrees);
}

}  // namespace

template <class T>
double chiSquareOfLobe(const WardFunctions<T>& tested, const WardFunctions<Extended>& density, const StudyInput& input,
                       int count, Stream random, double& largestWeight) {
  constexpr size_t kSide = 16, kNodes = 64;  // cells of each coordinate; azimuths of a cell's quadrature
  constexpr double turn = 2 * kPi<double>;
  const SlopeDisk disk = diskOf(input);
  const Vec3<double> o = disk.wo();
  const Vec3<T> wo{T(o.x), T(o.y), T(o.z)};
  const WardVariant variant = wardVariant(input.brdf);
  std::vector<double> observed(kSide * kSide, 0), expected(kSide * kSide, 0);
  double observedBelow = 0;
  Features seen = Features::Zero(), mean = Features::Zero();
  Eigen::Matrix<double, kFeatures, kFeatures> second = Eigen::Matrix<double, kFeatures, kFeatures>::Zero();
  for (int i = 0; i < count; ++i) {
    const double u = std::floor(random.uniform() * 0x1p24) * 0x1p-24,
                 v = std::floor(random.uniform() * 0x1p24) * 0x1p-24;
    const Vec3<T> wi = tested.sample(wo, T(input.alphaX), T(input.alphaY), {T(u), T(v)});
    if (!(wi.z > 0)) {
      ++observedBelow;
      continue;
    }
    largestWeight = std::max(largestWeight, double(tested.weight(variant, wi, wo)));
    const Extended hz = Extended(wi.z) + Extended(wo.z);
    const double x = double((Extended(wi.x) + Extended(wo.x)) / hz / input.alphaX);
    const double y = double((Extended(wi.y) + Extended(wo.y)) / hz / input.alphaY);
    const double e = -std::expm1(-(x * x + y * y)), psi = std::atan2(y, x) / turn;
    const auto cell = [](double c) { return std::min(kSide - 1, static_cast<size_t>(c * kSide)); };
    seen += featuresAt(e, turn * psi);
    ++observed[cell(psi < 0 ? psi + 1 : psi) * kSide + cell(e)];
  }
  // The density per cell, with 1 - e^-E from 0 to where the horizon is: three Gauss nodes.
  constexpr double kGauss[] = {-0.7745966692414834, 0, 0.7745966692414834}, kWeights[] = {5. / 18, 8. / 18, 5. / 18};
  double above = 0;
  for (size_t row = 0; row < kSide; ++row)
    for (size_t node = 0; node < kNodes; ++node) {
      const double psi = turn * (double(row) + (double(node) + 0.5) / kNodes) / kSide;
      const SlopeDisk::Ring ring = disk.ringAt(psi);
      const double horizon = -std::expm1(-square(ring.rMax));
      for (size_t column = 0; column < kSide; ++column) {
        const double from = double(column) / kSide, to = std::min((column + 1.0) / kSide, horizon);
        if (!(to > from)) break;
        double mass = 0;
        for (int k = 0; k < 3; ++k) {
          const double w = 0.5 * (from + to) + 0.5 * (to - from) * kGauss[k], r = std::sqrt(-std::log1p(-w));
          double perSlope = 0;
          const Vec3<Extended> wi = directionAt(disk, input, ring, r, psi, std::max(0.0, ring.rMax - r), perSlope);
          const Extended pdf = density.evaluate(variant, wi, extendedWo(disk), input.alphaX, input.alphaY).pdf;
          const double part = kWeights[k] * double(pdf) * perSlope / (2 * (1 - w));  // r dr = d(1 - e^-E)/(2 e^-E)
          const Features h = featuresAt(w, psi) * (part * (to - from) * turn / kSide / kNodes);
          mass += part, mean += h, second += h * featuresAt(w, psi).transpose();
        }
        mass *= (to - from) * turn / kSide / kNodes;
        expected[row * kSide + column] += mass, above += mass;
      }
    }
  // Cells that expect under 5 are pooled with what lies below the horizon.
  double statistic = 0, pooled = std::max(0.0, 1 - above) * count;
  int cells = 0;
  for (size_t k = 0; k < observed.size(); ++k) {
    const double n = expected[k] * count;
    if (n < 5)
      pooled += n, observedBelow += observed[k];
    else
      statistic += square(observed[k] - n) / n, ++cells;
  }
  if (pooled >= 5)
    statistic += square(observedBelow - pooled) / pooled, ++cells;
  else if (observedBelow > pooled + 30)
    return 0;
  return std::min(1.0, 2 * std::min(chiSquareLevel(statistic, cells - 1), levelOfMeans(seen, mean, second, count)));
}

template double chiSquareOfLobe(const WardFunctions<float>&, const WardFunctions<Extended>&, const StudyInput&, int,
                                Stream, double&);
template double chiSquareOfLobe(const WardFunctions<double>&, const WardFunctions<Extended>&, const StudyInput&, int,
                                Stream, double&);

}  // namespace wardmis
