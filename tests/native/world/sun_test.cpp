// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/sun.h"

#include <gtest/gtest.h>

#include "math/random.h"

namespace wardmis {
namespace {

// Samples of a sun, cone or disk, narrow or wide, give what faces it the irradiance that it is told, and at() knows
// their densities.
TEST(Sun, GivesItsIrradiance) {
  const Vec3f towards = normalize(Vec3f{0.3f, -0.5f, 0.7f});
  for (const bool flat : {false, true})
    for (const float angle : {1e-3f, 0.0093f, 0.5f, 2.0f, 3.0f}) {
      const Sun sun(towards, angle, flat);
      const Rgb radiance = sun.radiance({3, 2, 1});
      ASSERT_FALSE(sun.delta());
      Stream random(7, static_cast<uint64_t>(1e6f * angle));
      double sum = 0;
      constexpr int kSamples = 40000;
      for (int k = 0; k < kSamples; ++k) {
        const auto u = random.square();
        const Sun::Sample s = sun.sample({static_cast<float>(u.x), static_cast<float>(u.y)});
        const Sun::Sample back = sun.at(s.direction);
        if (back.pdf > 0) {  // the rim is lost by rounding
          EXPECT_NEAR(back.pdf / s.pdf, 1, 1e-3) << angle;
          EXPECT_NEAR(back.cos3 / s.cos3, 1, 1e-3) << angle;
        }
        sum += double(radiance.y / s.cos3 / s.pdf * dot(s.direction, towards));
      }
      EXPECT_NEAR(sum / kSamples, 2, 0.02) << angle << flat;
      EXPECT_EQ(sun.at(-towards).pdf, 0);
    }
  EXPECT_TRUE(Sun(towards, 0, false).delta());
  EXPECT_EQ(Sun(towards, 0, true).radiance({3, 2, 1}).x, 3);
}

}  // namespace
}  // namespace wardmis
