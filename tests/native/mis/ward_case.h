// SPDX-License-Identifier: GPL-3.0-or-later
// The golden file's estimator problem: the specular part of L_o = integral f_s L_i cos under the sky L_i = R cos, by
// the lobe, the cosine and (in the three-technique cases) the uniform hemisphere. Directions in double, values in
// float, as the renderer has them.
#pragma once

#include <string>

#include "bsdf/ward.h"
#include "golden.h"
#include "mis/allocation.h"
#include "statistics.h"

namespace wardmis::test {

struct Sampled {
  float f;
  Fractions<3> p;
};

class WardCase {
 public:
  explicit WardCase(const nlohmann::json& c) : input(c["input"]), expect(c["expect"]) {
    const std::string model = input["model"];
    variant_ = model == "ward"       ? WardVariant::kWard
               : model == "ward-dur" ? WardVariant::kWardDur
                                     : WardVariant::kWardGmd;
    ax_ = input.contains("alpha_x") ? input["alpha_x"].get<double>() : input.value("alpha", 1.0);
    ay_ = input.contains("alpha_y") ? input["alpha_y"].get<double>() : ax_;
    const double degree = kPi<double> / 180, theta = input["theta_o_deg"].get<double>() * degree;
    const double phi = input.value("phi_o_deg", 0.0) * degree;
    wo_ = {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    scale_ = input["rho_s"].get<double>() * input["R"].get<double>();
    techniques = input.contains("techniques") ? 3 : 2;
    used = static_cast<TechniqueMask>((1 << techniques) - 1);
  }
  // Of the full model with the diffuse part apart: what this class samples.
  static bool is(const nlohmann::json& c) {
    const auto& in = c["input"];
    return in["model"].get<std::string>().starts_with("ward") && in["mode"] == "full" && !in.value("joint", false);
  }
  double alpha() const { return std::min(ax_, ay_); }

  Sampled sample(int technique, Random& random) const {
    const Vec2<double> u = random.square();
    if (technique == 0) return at(wardSample(wo_, ax_, ay_, u));
    if (technique == 1) {
      const double r = std::sqrt(u.x), phi = 2 * kPi<double> * u.y;
      return at({r * std::cos(phi), r * std::sin(phi), std::sqrt(1 - u.x)});
    }
    const double s = std::sqrt((2 - u.x) * u.x), phi = 2 * kPi<double> * u.y;
    return at({s * std::cos(phi), s * std::sin(phi), 1 - u.x});
  }

  nlohmann::json input, expect;
  int techniques;
  TechniqueMask used;

 private:
  Sampled at(Vec3<double> wi) const {
    if (!(wi.z > 0)) return {0, {}};
    const WardValue<double> w = wardEvaluate(variant_, wi, wo_, 1 / ax_, 1 / ay_);
    const double uniform = techniques == 3 ? 0.5 / kPi<double> : 0;
    return {static_cast<float>(w.fCos * scale_ * wi.z),
            {static_cast<float>(w.pdf), static_cast<float>(wi.z / kPi<double>), static_cast<float>(uniform)}};
  }

  WardVariant variant_;
  double ax_, ay_, scale_;
  Vec3<double> wo_;
};

// The exact moments of a case, as the pilot of one hit would hand them on.
inline Moments<3> exactMoments(const WardCase& c) {
  Moments<3> m;
  m.hits = 1;
  for (size_t i = 0; i < static_cast<size_t>(c.techniques); ++i) {
    const std::string n = std::to_string(i + 1);
    const bool three = c.techniques == 3;
    const double mean = three ? c.expect["mu_eq"][i].get<double>() : c.expect["mu_" + n + "_eq"].get<double>();
    const double sigma2 =
        three ? c.expect["sigma2_eq"][i].get<double>() : c.expect["sigma2_" + n + "_eq"].get<double>();
    m.shared.second[i] =
        static_cast<float>(three ? c.expect["m2"][i].get<double>() : c.expect["m2_" + n].get<double>());
    m.mean[i] = static_cast<float>(mean);
    m.square[i] = static_cast<float>(sigma2 + mean * mean);
    m.shared.integral += m.mean[i], m.shared.square += m.square[i];
  }
  return m;
}

// One estimate of the integral; the counts may be the actual ones of fractional n_i.
inline double estimate(const WardCase& c, const Mixture<3>& mixture, const std::array<int, 3>& counts, Random& random) {
  double sum = 0;
  for (int i = 0; i < c.techniques; ++i)
    for (int j = 0; j < counts[static_cast<size_t>(i)]; ++j) {
      const Sampled s = c.sample(i, random);
      if (s.f > 0) sum += double(s.f) * double(mixture.scale(i, s.p, c.used));
    }
  return sum;
}

}  // namespace wardmis::test
