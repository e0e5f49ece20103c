// SPDX-License-Identifier: GPL-3.0-or-later
// Of an area lamp a point samples what it sees, by the density that is told.
#include "world/area_lamp.h"

#include <gtest/gtest.h>

#include "../statistics.h"

namespace wardmis {
namespace {

using test::evenEdges;

constexpr float kPif = kPi<float>;

struct Case {
  const char* name;
  float sizeX, sizeY;
  Affine toWorld;
};
const Case kUpright{"upright", 1, 0.7f, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0}}};
const Case kSkew{"skew", 1, 0.7f, {{1, 0, 0}, {0.4f, 0.9f, 0}, {0, 0, 1}, {0, 0, 0}}};
const Case kSheared{"sheared", 1.6f, 1, {{1, 0.3f, 0.2f}, {0.5f, 0.8f, -0.1f}, {0.25f, -0.4f, 1.1f}, {0.3f, 0.1f, 0}}};

AreaLamp lampOf(const Case& c, bool ellipse, float degrees) {
  Light light;
  light.type = LightType::kArea;
  light.ellipse = ellipse;
  light.sizeX = c.sizeX, light.sizeY = c.sizeY;
  light.toWorld = c.toWorld;
  light.spread = degrees * kPif / 180;
  return AreaLamp(light);
}

// Counts of samples over the lamp's own coordinates against the density's integral, whatever part is sampled and how.
// 144 cases, p > 1e-5 each: false alarm rate 1.5e-3; the seed is fixed.
TEST(AreaLamp, SamplesHaveTheDensityThatIsTold) {
  test::Random random(11);
  int met = 0;
  for (const Case& c : {kUpright, kSkew, kSheared})
    for (const bool ellipse : {false, true})
      for (const float degrees : {0.1f, 2.0f, 10.0f, 45.0f, 110.0f, 180.0f})
        for (const Vec3f from : {Vec3f{0.02f, 0.03f, -0.05f}, Vec3f{0.1f, 0.2f, -0.6f}, Vec3f{0.6f, -0.3f, -0.9f},
                                 Vec3f{0.2f, 0.1f, -40}}) {
          const AreaLamp lamp = lampOf(c, ellipse, degrees);
          const Vec3f x = lamp.at(1, 0) - lamp.at(0, 0), y = lamp.at(0, 1) - lamp.at(0, 0), n = cross(x, y);
          const auto coordinates = [&](Vec3f p) {
            const Vec3f v = p - lamp.at(0, 0);
            return Vec2<double>{double(dot(v, cross(y, n)) / dot(n, n)), double(dot(v, cross(n, x)) / dot(n, n))};
          };
          std::vector<double> as, bs;
          const auto draw = [&]() -> std::optional<Vec2<double>> {
            const LampSample s = lamp.sample(from, random.square<float>());
            if (!(s.pdf > 0)) return std::nullopt;
            const float t = lamp.meet(from, s.direction);
            if (t > 0 && lamp.profile(-s.direction) > 0) {
              EXPECT_NEAR(lamp.pdf(from, s.direction, t) / s.pdf, 1, 0.02) << c.name << degrees << from.z;
            }
            return coordinates(from + s.direction * s.distance);
          };
          for (int i = 0; i < 2000; ++i)
            if (const auto v = draw()) as.push_back(v->x), bs.push_back(v->y);
          if (as.empty()) continue;
          ++met;
          // a little beyond what was seen, and never beyond the lamp
          const auto edges = [](std::vector<double> v) {
            const auto [lo, hi] = std::minmax_element(v.begin(), v.end());
            const double margin = 0.02 * (*hi - *lo);
            return evenEdges(std::max(-1.0, *lo - margin), std::min(1.0, *hi + margin), 10);
          };
          const auto density = [&](double a, double b) {
            const Vec3f to = lamp.at(static_cast<float>(a), static_cast<float>(b)) - from;
            const float t = length(to);
            const Vec3f d = to / t;
            if (!(lamp.meet(from, d) > 0)) return 0.0;
            return double(lamp.pdf(from, d, t) * lamp.cosine(-d) / (t * t) * length(n));
          };
          // by the midpoint rule: the density ends at the lamp's rim
          const auto mass = [&](double a0, double a1, double b0, double b1) {
            constexpr int kSteps = 60;
            double sum = 0;
            for (int i = 0; i < kSteps; ++i)
              for (int j = 0; j < kSteps; ++j)
                sum += density(a0 + (a1 - a0) * (i + 0.5) / kSteps, b0 + (b1 - b0) * (j + 0.5) / kSteps);
            return sum * (a1 - a0) * (b1 - b0) / (kSteps * kSteps);
          };
          const auto fit = test::chiSquareOfCells(draw, mass, 10000, edges(as), edges(bs));
          EXPECT_GT(fit.p, 1e-5) << c.name << ' ' << ellipse << ' ' << degrees << ' ' << from.z;
          EXPECT_LT(fit.mass, 1.01) << c.name << ' ' << ellipse << ' ' << degrees << ' ' << from.z;
        }
  EXPECT_GT(met, 90);
}

// Within the lamp's beam no sample is lost, at its rim some are, and out of it there is none, nor any density.
TEST(AreaLamp, IsSampledWhereItsLightCanComeFrom) {
  test::Random random(12);
  for (const Case& c : {kUpright, kSkew, kSheared})
    for (const bool ellipse : {false, true})
      for (const float degrees : {1.0f, 5.0f, 20.0f}) {
        const AreaLamp lamp = lampOf(c, ellipse, degrees);
        const Vec3f axis = normalize(c.toWorld.z);
        const float height = 0.5f;
        const auto useful = [&](Vec3f from) {
          int count = 0;
          for (int i = 0; i < 1000; ++i) {
            const LampSample s = lamp.sample(from, random.square<float>());
            count += s.pdf > 0 && lamp.profile(-s.direction) > 0;
          }
          return count;
        };
        const bool sheared = c.toWorld.z.x != 0;  // then a parallelogram is around an ellipse
        EXPECT_GE(useful(lamp.at(0, 0) - axis * height), sheared ? 350 : 1000) << c.name << ellipse << degrees;
        EXPECT_GE(useful(lamp.at(1, 0) - axis * height), 300) << c.name << ellipse << degrees;
        const Vec3f outside = lamp.at(1.9f, 0) - axis * height;
        EXPECT_EQ(useful(outside), 0) << c.name << ellipse << degrees;
        for (int i = 0; i < 100; ++i) {
          const Vec3f to =
              lamp.at(static_cast<float>(random.uniform(-0.5, 0.5)), static_cast<float>(random.uniform(-0.5, 0.5))) -
              outside;
          const Vec3f d = normalize(to);
          if (lamp.meet(outside, d) > 0) {
            EXPECT_EQ(lamp.pdf(outside, d, length(to)), 0) << c.name << degrees;
          }
        }
      }
}

}  // namespace
}  // namespace wardmis
