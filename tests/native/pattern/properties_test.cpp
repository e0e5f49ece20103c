// SPDX-License-Identifier: GPL-3.0-or-later
// What holds of the patterns whoever computes them: ranges, continuity, and an answer for every number.
#include <gtest/gtest.h>

#include <limits>

#include "pattern/brick.h"
#include "pattern/gabor.h"
#include "pattern/magic.h"
#include "pattern/noise.h"
#include "pattern/simple.h"
#include "pattern/voronoi.h"
#include "pattern/wave.h"
#include "statistics.h"

namespace wardmis::pattern {
namespace {

constexpr Version kVersions[] = {Version::kBlender3, Version::kBlender4, Version::kBlender5};
constexpr FractalType kFractals[] = {FractalType::kFbm, FractalType::kMultifractal, FractalType::kHybridMultifractal,
                                     FractalType::kRidgedMultifractal, FractalType::kHeteroTerrain};
constexpr VoronoiFeature kFeatures[] = {VoronoiFeature::kF1, VoronoiFeature::kF2, VoronoiFeature::kSmoothF1,
                                        VoronoiFeature::kDistanceToEdge, VoronoiFeature::kNSphereRadius};
constexpr VoronoiMetric kMetrics[] = {VoronoiMetric::kEuclidean, VoronoiMetric::kManhattan, VoronoiMetric::kChebychev,
                                      VoronoiMetric::kMinkowski};

struct Place {
  Vec3f p;
  float w;
};
Place somewhere(test::Random& random, double reach) {
  const auto one = [&] { return static_cast<float>(random.uniform(-reach, reach)); };
  const float x = one(), y = one(), z = one();
  return {{x, y, z}, one()};
}

// How many of the numbers that all patterns give there, with `v` for every input, are not finite.
int notFinite(const Place& at, float v) {
  const auto [p, w] = at;
  int n = 0;
  const auto see = [&n](auto... x) { n += (0 + ... + (std::isfinite(x) ? 0 : 1)); };
  see(checker(v, p), whiteNoise(3, p, w), gabor(2, {v, v, v, v, {}}, p).value,
      gabor(3, {v, v, v, v, {v, v, v}}, p).phase);
  for (int type = 0; type < 7; type++) see(gradient(static_cast<GradientType>(type), p));
  for (Version version : kVersions) {
    see(magic(version, 10, v, v, p).x);
    see(brick({.version = version, .offset = v, .squash = v}, {{}, {}, {}, v, v, v, v, v, v}, p).color.x);
    for (int profile = 0; profile < 3; profile++) {
      see(wave({version, WaveShape::kRings, WaveAxis::kAll, static_cast<WaveProfile>(profile)}, {v, v, v, v, v, v}, p));
    }
    for (int dimensions = 1; dimensions <= 4; dimensions++) {
      for (FractalType type : kFractals) {
        see(noiseColor({version, dimensions, type, true}, {v, v, v, v, v, v, v}, p, w).y);
        see(musgrave(type, dimensions, {v, v, v, v, v, v}, p, w));
      }
      for (VoronoiFeature feature : kFeatures) {
        for (VoronoiMetric metric : kMetrics) {
          const VoronoiValue r = voronoi({version, dimensions, feature, metric, true}, {v, v, v, v, v, v, v}, p, w);
          see(r.distance, r.color.x, r.position.x, r.w, r.radius);
        }
      }
    }
  }
  return n;
}

// Under UndefinedBehaviorSanitizer too. What is not finite may give anything, but within the time of what is.
TEST(Patterns, AnswerEveryNumber) {
  constexpr float kInf = std::numeric_limits<float>::infinity(), kMax = std::numeric_limits<float>::max();
  for (float x : {0.4f, -0.0f, 1e-45f, -2147483648.0f, 1e30f, kMax, -kInf, float{NAN}}) {
    for (float v : {0.0f, -1.0f, 1e-30f, 1e9f, kInf, float{NAN}}) notFinite({{x, 0.3f, x}, x}, v);
    if (std::abs(x) <= 1e30f) {
      EXPECT_TRUE(std::isfinite(noiseFactor({}, {.scale = 1}, {x, x, x}, x))) << x;
    }
    EXPECT_TRUE(std::isfinite(noiseFactor({.version = Version::kBlender3}, {.scale = 1}, {x, x, x}, x))) << x;
    EXPECT_TRUE(std::isfinite(whiteNoise(4, {x, x, x}, x))) << x;
    EXPECT_TRUE(std::isfinite(checker(1, {x, x, x}))) << x;
  }
  for (float x : {0.0f, 0.4f, -7.3f, 1000.1f}) {
    for (float v : {0.7f, 1.0f, 2.0f}) EXPECT_EQ(notFinite({{x, 0.3f, 2 * x}, x + 1}, v), 0) << x << " " << v;
  }
}

TEST(Patterns, StayInTheirRanges) {
  test::Random random(1);
  for (int i = 0; i < 2000; i++) {
    const auto [p, w] = somewhere(random, 20);
    const auto expectUnit = [&, p = p](float x, const char* what) {
      EXPECT_GE(x, 0) << what << " at " << p.x << " " << p.y << " " << p.z;
      EXPECT_LE(x, 1) << what << " at " << p.x << " " << p.y << " " << p.z;
    };
    for (int d = 1; d <= 4; d++) {
      const Rgb c = noiseColor({.dimensions = d}, {.detail = 4.5f, .distortion = 0.5f}, p, w),
                n = whiteNoiseColor(d, p, w);
      for (float x : {c.x, c.y, c.z}) expectUnit(x, "noise");
      for (float x : {n.x, n.y, n.z, whiteNoise(d, p, w)}) expectUnit(x, "white noise");
      for (Version v : kVersions) {
        const VoronoiValue r = voronoi({.version = v, .dimensions = d, .normalize = true}, {.detail = 2.5f}, p, w);
        for (float x : {r.color.x, r.color.y, r.color.z}) expectUnit(x, "Voronoi's colour");
        if (v != Version::kBlender3) expectUnit(r.distance, "Voronoi's distance");
      }
    }
    for (WaveProfile profile : {WaveProfile::kSine, WaveProfile::kSaw, WaveProfile::kTriangle}) {
      expectUnit(wave({.profile = profile}, {.distortion = 3}, p), "wave");
    }
    for (int type = 0; type < 7; type++) expectUnit(gradient(static_cast<GradientType>(type), p), "gradient");
    const BrickValue b = brick({}, {}, p);
    for (float x : {b.color.x, b.factor}) expectUnit(x, "brick");
    for (int d : {2, 3}) {
      const GaborValue g = gabor(d, {.anisotropy = 0.5f}, p);
      for (float x : {g.value, g.phase}) expectUnit(x, "Gabor noise");
    }
  }
}

// Gradient noise is 0 at the corners of its lattice, and its slope is bounded, across the cells' walls as within.
template <int D>
void expectSmooth(test::Random& random) {
  for (int i = 0; i < 2000; i++) {
    Point<D> corner, p, q;
    float distance = 0;
    for (int d = 0; d < D; d++) {
      corner[d] = static_cast<float>(random.integer(-50, 50));
      p[d] = corner[d] + static_cast<float>(random.uniform(-0.001, 0.001));
      if (d % 2 == i % 2) p[d] += static_cast<float>(random.uniform(0, 1));
      q[d] = p[d] + static_cast<float>(random.uniform(-0.001, 0.001));
      distance += std::abs(q[d] - p[d]);
    }
    EXPECT_EQ(signedNoise(Version::kBlender5, corner), 0);
    EXPECT_LE(std::abs(signedNoise(Version::kBlender5, q) - signedNoise(Version::kBlender5, p)), 8 * distance + 1e-5f);
  }
}
TEST(Perlin, IsSmooth) {
  test::Random random(2);
  expectSmooth<1>(random);
  expectSmooth<2>(random);
  expectSmooth<3>(random);
  expectSmooth<4>(random);
}

// The mean of the noise's value over the plane is that of its gradients, 0: 4 standard errors of 20000 points.
TEST(Perlin, HasMeanZero) {
  test::Random random(3);
  double sum = 0, squares = 0;
  constexpr int kPoints = 20000;
  for (int i = 0; i < kPoints; i++) {
    const auto [p, w] = somewhere(random, 1000);
    const double x = signedNoise(Version::kBlender5, Point<3>{{p.x, p.y, p.z}});
    sum += x;
    squares += x * x;
  }
  EXPECT_LE(std::abs(sum / kPoints), 4 * std::sqrt(squares) / kPoints);
}

// The position is that of the point whose distance is given, and no other feature contradicts it.
TEST(Voronoi, FeaturesAgree) {
  test::Random random(4);
  for (int i = 0; i < 200; i++) {
    const auto [p, w] = somewhere(random, 5);
    for (Version v : kVersions) {
      for (int d = 1; d <= 4; d++) {
        const VoronoiInputs in{.scale = 2};
        const auto of = [&, p = p, w = w](VoronoiFeature f) {
          return voronoi({.version = v, .dimensions = d, .feature = f}, in, p, w);
        };
        const VoronoiValue f1 = of(VoronoiFeature::kF1), f2 = of(VoronoiFeature::kF2);
        const auto away = [&, p = p, w = w](const VoronoiValue& r) {
          const float x = d > 1 ? r.position.x - p.x : 0, y = d > 1 ? r.position.y - p.y : 0;
          const float z = d > 2 ? r.position.z - p.z : 0, t = d == 1 || d == 4 ? r.w - w : 0;
          return 2 * std::sqrt(x * x + y * y + z * z + t * t);
        };
        EXPECT_NEAR(f1.distance, away(f1), 1e-4f);
        EXPECT_NEAR(f2.distance, away(f2), 1e-4f);
        EXPECT_LE(f1.distance, f2.distance);
        EXPECT_LE(of(VoronoiFeature::kSmoothF1).distance, f1.distance + 1e-5f);
        EXPECT_GE(of(VoronoiFeature::kDistanceToEdge).distance, 0);
      }
    }
  }
}

}  // namespace
}  // namespace wardmis::pattern
