// SPDX-License-Identifier: GPL-3.0-or-later
// Ward's lobe in polar coordinates of the microfacet's slope, in units of alpha: s = r (ax cos psi, ay sin psi), E =
// r^2. The directions above the surface are those out to the horizon, the circle |s - tan(theta_o) o| = 1/cos(theta_o),
// and dwi = 2 h_z/(1 + |s|^2) d^2s.
#pragma once

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <vector>

#include "math/number.h"
#include "math/vec.h"
#include "study/peaks.h"

namespace wardmis {

class SlopeDisk {
 public:
  SlopeDisk(double ax, double ay, double thetaDegrees, double phiDegrees)
      : isotropic_(ax == ay), ax_(ax), ay_(ay), so_(sinDegrees(thetaDegrees)), co_(cosDegrees(thetaDegrees)) {
    const double phi = std::remainder(phiDegrees, 360.0) * (kPi<double> / 180);
    cosPhi_ = isotropic_ ? 1 : std::cos(phi), sinPhi_ = isotropic_ ? 0 : std::sin(phi);
  }
  bool isotropic() const { return isotropic_; }
  Vec3<double> wo() const { return {so_ * cosPhi_, so_ * sinPhi_, co_}; }

  // A direction psi: its slope per r, and where the horizon lies.
  struct Ring {
    double g, rhoMax, rMax;
  };
  Ring ringAt(double psi) const {
    const double x = ax_ * std::cos(psi), y = ay_ * std::sin(psi), g = std::hypot(x, y);
    const double cosine = (x * cosPhi_ + y * sinPhi_) / g, t = so_ / co_ * cosine, root = std::sqrt(t * t + 1);
    const double rhoMax = t >= 0 ? t + root : 1 / (root - t);
    return {g, rhoMax, rhoMax / g};
  }

  // perSlope: dwi = perSlope r dr dpsi
  struct Slope {
    double e, slope, ci, hz, perSlope;  // e = E; slope = 1 + |s|^2
  };
  // left = rMax - r, given apart since it may be tiny
  Slope slopeAt(const Ring& ring, double r, double left) const {
    const double rho = ring.g * r, slope = 1 + rho * rho;
    const double ci = co_ * (ring.g * left) * (rho + 1 / ring.rhoMax) / slope;
    const double hz = ci + co_;
    return {r * r, slope, ci, hz, 2 * hz / slope * ax_ * ay_};
  }

  // ln of the probability that a sample of the lobe lies below the horizon, which may be 10^-100000.
  double logBelow() const {
    constexpr double kLeast = 1e-290;
    const double plain = below();
    if (plain > kLeast) return std::log(plain);
    return logIntegralOfPeaks([this](double psi) { return -square(ringAt(psi).rMax); }, [](double) { return 1.0; }) -
           std::log(2 * kPi<double>);
  }

  // In psi/turn, between the first cells of a quadrature: cells that grow from where the horizon's distance or the
  // ellipse's radius changes fast with psi.
  std::vector<double> breaks(double turn) const {
    constexpr double pi = kPi<double>;
    std::vector<double> breaks{0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1};
    const auto grade = [&](double psi, double width) {
      for (double w = width; w < 0.4; w *= 4)
        for (double side : {-w, w})
          for (double period : {-2 * pi, 0.0, 2 * pi})
            if (const double v = (psi + side + period) / turn; v > 0 && v < 1) breaks.push_back(v);
    };
    for (double half : {0.0, pi}) {
      const double across = std::atan2(-ax_ * cosPhi_, ay_ * sinPhi_) + half;  // of the plane of incidence
      grade(across, square(std::hypot(ax_ * std::cos(across), ay_ * std::sin(across))) /
                        (ax_ * ay_ * std::max(1.0, so_ / co_)));
      if (!isotropic_) grade(ax_ < ay_ ? half : half + pi / 2, std::min(ax_, ay_) / std::max(ax_, ay_));
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
  }

 private:
  // Between the breaks: over the whole turn, the quadrature would miss what happens within 1e-5 of it.
  double below() const {
    constexpr double turn = 2 * kPi<double>;
    const std::vector<double> v = breaks(turn);
    double sum = 0;
    for (size_t i = 0; i + 1 < v.size(); ++i)
      sum += boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
          [this](double x) { return std::exp(-square(ringAt(turn * x).rMax)); }, v[i], v[i + 1], 6, 1e-11);
    return sum;
  }

  bool isotropic_;
  double ax_, ay_, so_, co_, cosPhi_ = 1, sinPhi_ = 0;
};

}  // namespace wardmis
