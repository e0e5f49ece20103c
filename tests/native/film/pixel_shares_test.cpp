// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/pixel_shares.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

#include "film/film.h"

namespace wardmis {
namespace {

constexpr int kSide = 48;
constexpr size_t kPixels = size_t{kSide} * kSide;

TEST(PixelShares, CountsWholeSamplesForAll) {
  const PixelShares shares;
  for (size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(shares.count(i, 0), 0u);
    EXPECT_EQ(shares.count(i, 7), 7u);
    EXPECT_EQ(shares.count(i, 1u << 24), 1u << 24);
  }
}

// What is left of a sample, or of a block, is there in as many pixels: 5 standard deviations of 2304 are .05.
TEST(PixelShares, CountsPartsOfSamplesInPartsOfThePixels) {
  PixelShares shares;
  const auto mean = [&](double samples) {
    double sum = 0;
    for (size_t i = 0; i < kPixels; ++i) sum += shares.count(i, samples);
    return sum / kPixels;
  };
  EXPECT_NEAR(mean(0.25), 0.25, 0.05);
  EXPECT_NEAR(mean(3.75), 3.75, 0.05);
  shares = {16, std::vector<float>(kPixels, 0.5f)};
  EXPECT_EQ(mean(8), 8);
  EXPECT_EQ(mean(16), 16);
  EXPECT_NEAR(mean(48), 32, 0.05);
  EXPECT_NEAR(mean(24), 20, 16 * 0.05);
  EXPECT_NEAR(mean(1000), 16 + 0.5 * 984, 16 * 0.05);
}

TEST(PixelShares, NoPixelLosesSamples) {
  const PixelShares shares{8, {0.0625f, 1, 7.5f}};
  for (size_t i = 0; i < 3; ++i)
    for (uint32_t n = 0, before = 0; n < 200; ++n) {
      const uint32_t now = shares.count(i, n);
      EXPECT_GE(now, before);
      if (n >= 8) {
        EXPECT_EQ(now % 8, 0u);
      }
      before = now;
    }
}

// A film of 16 samples as a survey sees it; sigma(x, y) of each pixel about a mean of 1, rays(x, y) of one sample.
using OfPixel = std::function<double(int, int)>;
PixelShares surveyed(const OfPixel& sigma, const OfPixel& rays, uint32_t samples, double& gain, unsigned seed = 1,
                     size_t changed = kPixels) {
  FilmBuffer film(kSide, kSide);
  PixelSurvey survey;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  film.rays.resize(kPixels);
  for (; film.samples < 16; ++film.samples) {
    if (film.samples == 8) survey.half(film);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const size_t i = static_cast<size_t>(y * kSide + x);
        const double other = i == changed ? 5 : 1;
        const auto v = static_cast<float>(1 + normal(random) * sigma(x, y) * other);
        film.pixels[i].add({v, v, v});
        film.rays[i] += static_cast<uint32_t>(rays(x, y) * other);
      }
  }
  return survey.shares(film, samples, gain);
}

OfPixel alike(double value) {
  return [=](int, int) { return value; };
}
// One value on the left, another on the right.
OfPixel halves(double left, double right) {
  return [=](int x, int) { return x < kSide / 2 ? left : right; };
}
double meanAfter(const PixelShares& s, int x0, int x1) {
  double sum = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = x0; x < x1; ++x) sum += double(s.after[static_cast<size_t>(y * kSide + x)]);
  return sum / (kSide * (x1 - x0));
}

TEST(PixelSurvey, LeavesEvenWhatIsEven) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    double gain = 0;
    EXPECT_TRUE(surveyed(alike(0.3), alike(5), 64, gain, seed).after.empty()) << gain;
    EXPECT_EQ(gain, 1);
  }
}

// Of standard deviations s and 4 s the best shares are 1 : 4 (.4 and 1.6 of all), whose gain is (1 + 16) / 2 / 2.5^2.
TEST(PixelSurvey, SharesByStandardDeviation) {
  double gain = 0;
  const PixelShares s = surveyed(halves(0.05, 0.2), alike(5), 256, gain);
  ASSERT_FALSE(s.after.empty());
  EXPECT_EQ(s.even, 16u);
  EXPECT_NEAR(gain, 17 / 2.0 / 6.25, 0.06);
  EXPECT_NEAR((meanAfter(s, 0, 20) * 240 + 16) / 256, 0.4, 0.05);
  EXPECT_NEAR((meanAfter(s, 28, kSide) * 240 + 16) / 256, 1.6, 0.05);
  EXPECT_NEAR(meanAfter(s, 0, kSide), 1, 0.005);
}

// Of costs 1 and 9 they are 3 : 1, in the same time: 10 / 2 = (3 + 9) a / 2.
TEST(PixelSurvey, SharesByCost) {
  double gain = 0;
  const PixelShares s = surveyed(alike(0.2), halves(2, 18), 256, gain);
  ASSERT_FALSE(s.after.empty());
  EXPECT_NEAR(gain, 20 / 16.0, 0.06);  // (1 + 1) (1 + 9) / (1 + 3)^2
  EXPECT_NEAR((meanAfter(s, 0, 20) * 240 + 16) / 256, 2.5, 0.2);
  EXPECT_NEAR((meanAfter(s, 28, kSide) * 240 + 16) / 256, 2.5 / 3, 0.07);
  EXPECT_NEAR(0.1 * meanAfter(s, 0, kSide / 2) + 0.9 * meanAfter(s, kSide / 2, kSide), 1, 0.005);
}

// What a pixel's own samples bring changes what its neighbours get, and not what it gets itself.
TEST(PixelSurvey, APixelHasNoSayInItsOwnShare) {
  double gain = 0;
  const size_t own = size_t{kSide} * 24 + 12;
  // stripes, so that only the nearest pixels are asked
  const OfPixel sigma = [](int x, int) { return x / 3 % 2 == 0 ? 0.02 : 0.2; }, rays = halves(3, 5);
  const PixelShares without = surveyed(sigma, rays, 256, gain, 1), with = surveyed(sigma, rays, 256, gain, 1, own);
  ASSERT_FALSE(without.after.empty() || with.after.empty());
  // against one far away, since all have less where some have more
  const auto share = [](const PixelShares& s, size_t i) { return (double(s.after[i]) * 240 + 16) / 256; };
  const auto changed = [&](size_t i) {
    constexpr size_t kFar = size_t{kSide} * 6 + 12;
    return share(with, i) / share(with, kFar) / (share(without, i) / share(without, kFar));
  };
  EXPECT_NEAR(changed(own), 1, 1e-3);
  EXPECT_GT(std::abs(changed(own + 1) - 1), 0.1);
}

// Light as strong as floats hold, and as faint.
TEST(PixelSurvey, HoldsExtremes) {
  for (double scale : {1e-30, 1e30}) {
    FilmBuffer film(8, 8);
    PixelSurvey survey;
    film.rays.assign(64, 16);
    for (; film.samples < 16; ++film.samples) {
      if (film.samples == 8) survey.half(film);
      for (size_t i = 0; i < 64; ++i) {
        const auto v = static_cast<float>(scale * (1 + (i + film.samples) % (i < 32 ? 1 : 7)));
        film.pixels[i].add({v, 0, -v});
      }
    }
    double gain = 0;
    const PixelShares s = survey.shares(film, 64, gain);
    EXPECT_TRUE(std::isfinite(gain));
    for (float n : s.after) EXPECT_TRUE(n > 0 && n < 16) << n;
    EXPECT_EQ(s.after.empty(), scale < 1);  // nothing is seen of the faint one
  }
}

TEST(PixelSurvey, TakesAQuarterAtMost) {
  EXPECT_EQ(PixelSurvey::samplesFor(31), 0u);
  for (uint32_t n = 32; n < 1u << 24; n += 1 + n / 7) {
    const uint32_t s = PixelSurvey::samplesFor(n);
    EXPECT_GE(s, 8u);
    EXPECT_LE(4 * s, n);
    EXPECT_EQ(s & (s - 1), 0u);
  }
  EXPECT_EQ(PixelSurvey::samplesFor(64), 16u);
}

TEST(PixelSurvey, OfBlackOrOnePixelIsEven) {
  double gain = 0;
  EXPECT_TRUE(surveyed(alike(0), alike(1), 64, gain).after.empty());
  FilmBuffer film(1, 1);
  PixelSurvey survey;
  film.rays = {64};
  for (; film.samples < 16; ++film.samples) {
    if (film.samples == 8) survey.half(film);
    film.pixels[0].add({float(film.samples), 0, 0});
  }
  EXPECT_TRUE(survey.shares(film, 64, gain).after.empty());
}

}  // namespace
}  // namespace wardmis
