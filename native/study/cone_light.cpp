// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/cone_light.h"

#include <cmath>

#include "math/warp.h"
#include "study/cubature.h"
#include "study/slope_disk.h"

namespace wardmis {

namespace {

using Extended = long double;

class ConeLight final : public Problem {
 public:
  ConeLight(const StudyInput& input, double halfAngle)
      : Problem(input), halfAngle_(halfAngle), oneMinusCos_(2 * square(std::sin(halfAngle / 2))) {
    wo_ = SlopeDisk(input.alphaX, input.alphaY, input.thetaO, input.phiO).wo();
    frame_ = Frame<double>::around(Vec3<double>{-wo_.x, -wo_.y, wo_.z});
    // what the other techniques miss the light by
    Cubature cubature(*this);
    const int n = techniques();
    cubature.refine({n,
                     [n](const Point& x, double* out) {
                       for (int i = 0; i < n; ++i) out[i] = x.p[static_cast<size_t>(i)];
                     }},
                    1e-11, 100);
    const Points points = cubature.points();
    for (size_t i = 0; i < static_cast<size_t>(n); ++i)
      outside_[i] = isLight(i) ? 0 : std::max(0.0, 1 - points.integrate([&](const Point& x) { return x.p[i]; }));
  }

  // Polar coordinates about the axis, all scales from the lobe's width to the light's evenly.
  std::vector<Chart> charts() const override {
    const double scale = std::min({1.0, input_.alphaX, input_.alphaY}) * wo_.z;
    const double end = std::asinh(halfAngle_ / scale);
    return {{[=, this](double u, double v) {
               const Extended gamma = std::min(halfAngle_, scale * std::sinh(end * u)), psi = 2 * kPi<Extended> * v;
               const Extended sine = std::sin(gamma);
               Point x = at({sine * std::cos(psi), sine * std::sin(psi), std::cos(gamma)}, true);
               x.w = 2 * kPi<double> * double(sine) * scale * end * std::cosh(end * u);
               return x;
             },
             2}};
  }
  double logOutside(int i) const override { return std::log(outside_[static_cast<size_t>(i)]); }
  double logSecondMomentAtEdge(int) const override { return std::nan(""); }

  void sample(int i, Stream& random, SampleBlock& block, size_t first, size_t last) const override {
    const StudyTechnique t = input_.techniques[static_cast<size_t>(i)];
    for (size_t j = first; j < last; ++j) {
      Vec3<double> local;
      if (t == StudyTechnique::kUniform) {
        local = toCone(random.square(), oneMinusCos_);
      } else {
        const Vec3<double> wi = t == StudyTechnique::kLobe
                                    ? wardSample(wo_, input_.alphaX, input_.alphaY, random.square())
                                    : toCosineHemisphere(random.square());
        local = frame_.toLocal(wi);
      }
      // 1 - cos of the angle to the axis, as the renderer has it for suns
      const double apart = 0.5 * (square(local.x) + square(local.y) + square(local.z - 1));
      const bool lit = t == StudyTechnique::kUniform || apart <= oneMinusCos_;
      const Point x = at({local.x, local.y, local.z}, lit);
      block.f[j] = x.f;
      // outside the light, the densities of the other techniques do not matter: f = 0
      for (size_t k = 0; k < input_.techniques.size(); ++k) block.p[k][j] = lit ? x.p[k] : 0;
    }
  }

 private:
  bool isLight(size_t k) const { return input_.techniques[k] == StudyTechnique::kUniform; }

  // A direction in the frame of the axis. In long double: in a lobe of 1e-6 double's rounding of it is above the
  // quadrature's tolerance.
  Point at(Vec3<Extended> local, bool lit) const {
    const Vec3<Extended> x{frame_.x.x, frame_.x.y, frame_.x.z}, y{frame_.y.x, frame_.y.y, frame_.y.z},
        z{frame_.z.x, frame_.z.y, frame_.z.z}, wo{wo_.x, wo_.y, wo_.z};
    const Vec3<Extended> wi = x * local.x + y * local.y + z * local.z;
    const WardValue<Extended> w = wardEvaluate<Extended>(wardVariant(input_.brdf), wi, wo, 1 / Extended(input_.alphaX),
                                                         1 / Extended(input_.alphaY));
    Point p;
    const double cosine = std::max(0.0, double(wi.z) / kPi<double>);
    p.f = lit ? (input_.rhoS * double(w.fCos) + (input_.joint ? input_.rhoD * cosine : 0)) * input_.R : 0;
    for (size_t k = 0; k < input_.techniques.size(); ++k) {
      const StudyTechnique t = input_.techniques[k];
      p.p[k] = t == StudyTechnique::kLobe     ? double(w.pdf)
               : t == StudyTechnique::kCosine ? cosine
                                              : 1 / (2 * kPi<double> * oneMinusCos_);
      p.logP[k] = t == StudyTechnique::kLobe ? double(std::log(w.pdf)) : std::log(p.p[k]);
    }
    return p;
  }

  double halfAngle_, oneMinusCos_;
  Vec3<double> wo_;
  Frame<double> frame_;
  Densities outside_{};
};

}  // namespace

std::unique_ptr<Problem> makeConeLight(const StudyInput& input, double halfAngle) {
  return std::make_unique<ConeLight>(input, halfAngle);
}

}  // namespace wardmis
