// SPDX-License-Identifier: GPL-3.0-or-later
// Walter's sampling as a whole: its density, the part below the horizon, and the albedo as the mean weight.
#include <gtest/gtest.h>

#include "golden.h"
#include "reference.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

Vec3<double> towards(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
double radians(double degrees) { return degrees * kPi<double> / 180; }

struct Lobe {
  double ax, ay, thetaDegrees, phi;
};
void PrintTo(const Lobe& l, std::ostream* out) {
  *out << "alpha " << l.ax << " " << l.ay << " theta_o " << l.thetaDegrees << " phi_o " << l.phi;
}

class WardSampling : public testing::TestWithParam<Lobe> {};
INSTANTIATE_TEST_SUITE_P(Lobes, WardSampling,
                         testing::Values(Lobe{0.05, 0.05, 0, 0}, Lobe{0.3, 0.3, 30, 1}, Lobe{1, 1, 60, -2},
                                         Lobe{0.01, 0.01, 60, 0.5}, Lobe{0.05, 0.3, 0, 0}, Lobe{0.3, 0.05, 60, 0.7},
                                         Lobe{0.2, 0.02, 75, 2.5}, Lobe{0.2, 0.2, 85, 0}, Lobe{0.5, 0.1, 89, 1.2},
                                         Lobe{0.1, 0.1, 89.9, 3}));

// False alarms: 1e-4 a lobe, 1e-3 in all, for other seeds; these are fixed.
TEST_P(WardSampling, FollowsItsDensity) {
  const Lobe l = GetParam();
  const Vec3<double> wo = towards(radians(l.thetaDegrees), l.phi);
  Random random(11);
  const auto sample = [&] { return wardSample(wo, l.ax, l.ay, random.square()); };
  const auto pdf = [&](double ax) {
    return [&, ax](Vec3<double> wi) { return ward(WardVariant::kWard, wi, wo, ax, l.ay).pdf; };
  };
  const test::Fit fit = chiSquareHemisphere(sample, pdf(l.ax), 100000, 20);
  EXPECT_GT(fit.p, 1e-4);
  EXPECT_LE(fit.mass, 1 + 1e-4);
  // and the test can tell: a lobe 5 % wider is rejected
  EXPECT_LT(chiSquareHemisphere(sample, pdf(1.05 * l.ax), 100000, 20).p, 1e-6);
}

// Mean weights of the golden file's 60 configurations, within 5 standard errors: 480 comparisons, 3e-4 false alarms.
template <class T>
void checkAlbedo(int count, double roundings) {
  int seed = 100, configurations = 0;
  for (const auto& c : golden()["albedo"]) {
    SCOPED_TRACE(c.dump());
    const Vec3<double> o = towards(radians(c["theta_o_deg"].get<double>()), radians(c["phi_o_deg"].get<double>()));
    const Vec3<T> wo{T(o.x), T(o.y), T(o.z)};
    const T ax = c["alpha_x"].get<T>(), ay = c["alpha_y"].get<T>();
    Random random(static_cast<uint64_t>(seed++));
    Estimate weights[3], below;
    for (int i = 0; i < count; ++i) {
      const Vec3<T> wi = wardSample(wo, ax, ay, random.square<T>());
      for (int v = 0; v < 3; ++v) weights[v].add(double(wardWeight(kVariants[v].type, wi, wo)));
      below.add(wi.z > 0 ? 0 : 1);
    }
    for (int v = 0; v < 3; ++v) {
      const double exact = c[kVariants[v].albedo].get<double>();
      EXPECT_NEAR(weights[v].mean(), exact, 5 * weights[v].error() + roundings * exact) << kVariants[v].albedo;
    }
    EXPECT_LE(weights[2].mean(), 1 + 5 * weights[2].error() + roundings);  // gmd keeps energy
    const double exact = c["P_below"].get<double>();
    EXPECT_NEAR(below.mean(), exact, 5 * std::sqrt(exact * (1 - exact) / count) + 1e-12);
    ++configurations;
  }
  EXPECT_EQ(configurations, 60);
}
TEST(Albedo, IsTheMeanWeightInDouble) { checkAlbedo<double>(40000, 1e-12); }
TEST(Albedo, IsTheMeanWeightInFloat) { checkAlbedo<float>(40000, 1e-5); }

TEST(Albedo, GmdIsAtMostOneInTheTable) {
  for (const auto& c : golden()["albedo"]) EXPECT_LE(c["ward-gmd"].get<double>(), 1);
}
TEST(Albedo, GmdIsAtMostOneAnywhere) {
  Random random(12);
  for (int i = 0; i < 200; ++i) {
    const Vec3<double> wo =
        towards(radians(i % 2 == 0 ? random.uniform(0, 90) : 90 - random.logUniform(1e-3, 10)), random.uniform(0, 7));
    const double ax = random.logUniform(1e-3, 10), ay = random.logUniform(1e-3, 10);
    Estimate weight;
    for (int k = 0; k < 2000; ++k)
      weight.add(wardWeight(WardVariant::kWardGmd, wardSample(wo, ax, ay, random.square()), wo));
    EXPECT_LE(weight.mean(), 1 + 5 * weight.error() + 1e-12);
  }
}

// The integral of the density over the hemisphere is 1 - P_below: by quadrature, samples only place the grid. What the
// quadrature may miss lies beyond the 4000 samples, and is less in wide lobes.
TEST(Density, IntegratesToWhatStaysAbove) {
  for (const auto& c : golden()["albedo"]) {
    SCOPED_TRACE(c.dump());
    const double ax = c["alpha_x"].get<double>(), ay = c["alpha_y"].get<double>();
    const Vec3<double> wo = towards(radians(c["theta_o_deg"].get<double>()), radians(c["phi_o_deg"].get<double>()));
    Random random(13);
    const auto sample = [&] { return wardSample(wo, ax, ay, random.square()); };
    const auto pdf = [&](Vec3<double> wi) { return ward(WardVariant::kWard, wi, wo, ax, ay).pdf; };
    EXPECT_NEAR(chiSquareHemisphere(sample, pdf, 0, 12).mass, 1 - c["P_below"].get<double>(),
                std::min(ax, ay) < 0.1 ? 2e-3 : 2e-5);
  }
}

}  // namespace
}  // namespace wardmis
