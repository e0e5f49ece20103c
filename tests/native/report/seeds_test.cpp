// SPDX-License-Identifier: GPL-3.0-or-later
// An honest estimator, a biased one and one of a heavy tail, as images of known distributions: each is told for what it
// is. Seeds are fixed.
#include "report/seeds.h"

#include <gtest/gtest.h>

#include <random>

namespace wardmis {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr size_t kSeeds = 16;

RgbImage truth() {
  RgbImage image{kWidth, kHeight, {}};
  for (int i = 0; i < kWidth * kHeight * 3; ++i) image.rgb.push_back(0.2f + 0.1f * static_cast<float>(i % 7));
  return image;
}

// Mean over `samples` of noise of mean 0.
template <class Noise>
std::vector<RgbImage> images(Noise noise, int samples, uint64_t seed, float shift = 0, int shiftedColumns = 0) {
  std::mt19937_64 random(seed);
  std::vector<RgbImage> all;
  for (size_t s = 0; s < kSeeds; ++s) {
    RgbImage image = truth();
    for (size_t i = 0; i < image.pixels(); ++i) {
      double e = 0;
      for (int k = 0; k < samples; ++k) e += noise(random) / samples;
      for (size_t c = 0; c < 3; ++c)
        image.rgb[3 * i + c] += static_cast<float>(e) + (static_cast<int>(i % kWidth) < shiftedColumns ? shift : 0);
    }
    all.push_back(std::move(image));
  }
  return all;
}

Reference exact() {
  Reference r;
  r.image = truth();
  return r;
}

double normalNoise(std::mt19937_64& random) { return std::normal_distribution<double>(0, 0.5)(random); }
// once in 20000 a sample of 200: mean 0.01, taken off
double rareNoise(std::mt19937_64& random) {
  return (std::uniform_real_distribution<double>()(random) < 5e-5 ? 200 : 0) - 0.01 + 0.05 * normalNoise(random);
}

TEST(Seeds, AnHonestEstimatorIsLeftAlone) {
  const SeedStatistics s = seedStatistics(images(normalNoise, 16, 1), exact(), 1);
  EXPECT_FALSE(s.biased()) << s.bias.smallestP;
  EXPECT_FALSE(s.tail.heavy()) << s.tail.kurtosis;
  EXPECT_NEAR(s.tail.kurtosis, 3, 0.1);
  double variance = 0;
  for (const float v : s.variance) variance += double(v) / double(s.variance.size());
  EXPECT_NEAR(variance, 0.25 / 16, 0.25 / 16 * 0.02);
}

TEST(Seeds, ABiasedOneIsCaught) {
  // 2 % of the light, in a strip of the image alone, well under the noise of any single pixel
  const SeedStatistics s = seedStatistics(images(normalNoise, 64, 2, 0.03f, 16), exact(), 1);
  EXPECT_TRUE(s.biased());
  EXPECT_GT(s.bias.failed, 0u);
  EXPECT_FALSE(s.tail.heavy()) << s.tail.kurtosis;
  EXPECT_GT(s.bias.z[0], 5);
  EXPECT_LT(std::abs(s.bias.z[kWidth - 1]), 7);
}

TEST(Seeds, AHeavyTailIsNoBias) {
  const SeedStatistics s = seedStatistics(images(rareNoise, 16, 3), exact(), 1);
  EXPECT_TRUE(s.tail.heavy()) << s.tail.kurtosis;
  EXPECT_FALSE(s.biased()) << s.bias.failed << " blocks, image z " << s.bias.imageZ;
  // and with a bias on top it is both
  const SeedStatistics both = seedStatistics(images(rareNoise, 16, 3, 0.05f, kWidth), exact(), 1);
  EXPECT_TRUE(both.tail.heavy());
  EXPECT_TRUE(both.biased()) << both.bias.imageZ;
}

// Where the reference tells which blocks may have missed something, the others count under a heavy tail too.
TEST(Seeds, ABiasUnderAHeavyTailIsCaught) {
  constexpr uint32_t kSpp = 64, kReferenceSpp = 1 << 16;
  const double variance = 200 * 200 * 5e-5 + 0.000625;  // of a sample of rareNoise
  Reference reference = exact();
  reference.setVariance(std::vector<float>(reference.image.rgb.size(), static_cast<float>(variance / kReferenceSpp)));
  reference.spp = kReferenceSpp;
  const SeedStatistics honest = seedStatistics(images(rareNoise, kSpp, 11), reference, kSpp);
  EXPECT_TRUE(honest.tail.heavy()) << honest.tail.kurtosis;
  EXPECT_FALSE(honest.biased()) << honest.bias.failed - honest.bias.unmet;
  for (const float shift : {0.1f, -0.1f}) {  // in the left quarter of the image
    const SeedStatistics s = seedStatistics(images(rareNoise, kSpp, 11, shift, kWidth / 4), reference, kSpp);
    EXPECT_TRUE(s.tail.heavy());
    EXPECT_TRUE(s.biased()) << shift << ": " << s.bias.failed << " failed, " << s.bias.unmet << " unmet";
  }
}

TEST(Seeds, TheReferencesOwnNoiseIsNoBias) {
  Reference noisy = exact();
  std::mt19937_64 random(4);
  for (size_t i = 0; i < noisy.image.pixels(); ++i) {
    const auto e = static_cast<float>(normalNoise(random) * 0.4);
    for (size_t c = 0; c < 3; ++c) noisy.image.rgb[3 * i + c] += e;
  }
  const std::vector<RgbImage> seeds = images(normalNoise, 64, 5);
  EXPECT_TRUE(seedStatistics(seeds, noisy, 1).biased()) << "taken for exact it is caught";
  noisy.setVariance(std::vector<float>(noisy.image.rgb.size(), 0.04f));
  EXPECT_FALSE(seedStatistics(seeds, noisy, 1).biased());
}

// A lamp that one block sees through a chink, one sample in 40 000 of a light of 4000: the reference has met it, and
// no seed has.
TEST(Seeds, RareLightThatNoSeedHasMetIsNotCalledBias) {
  constexpr float kLight = 0.1f;
  constexpr uint32_t kSpp = 16, kReferenceSpp = 1 << 16;
  Reference reference = exact();
  std::vector<float> variance(reference.image.rgb.size(), 0.25f / kReferenceSpp);
  for (int y = 0; y < kBlock; ++y)
    for (int x = 0; x < kBlock; ++x)
      for (int c = 0; c < 3; ++c) {
        const int i = 3 * (y * kWidth + x) + c;
        reference.image.rgb[static_cast<size_t>(i)] += kLight;
        variance[static_cast<size_t>(i)] = kLight * 4000 / kReferenceSpp;
      }
  reference.setVariance(variance);
  reference.spp = kReferenceSpp;
  const std::vector<RgbImage> seeds = images(normalNoise, kSpp, 8);
  const SeedStatistics s = seedStatistics(seeds, reference, kSpp);
  EXPECT_FALSE(s.tail.heavy()) << s.tail.kurtosis;
  EXPECT_EQ(s.bias.failed, 1u) << "the seeds are sure of it";
  EXPECT_EQ(s.bias.unmet, 1u);
  EXPECT_FALSE(s.biased());
  EXPECT_TRUE(s.unclear());
  // more light than the reference's is not missed
  Reference darker = reference;
  for (int y = 0; y < kBlock; ++y)
    for (int x = 0; x < kBlock; ++x)
      for (int c = 0; c < 3; ++c) darker.image.rgb[static_cast<size_t>(3 * (y * kWidth + x) + c)] -= 2 * kLight;
  EXPECT_TRUE(seedStatistics(seeds, darker, kSpp).biased());
  // of as many samples as the reference's they would have met it
  EXPECT_TRUE(seedStatistics(seeds, reference, kReferenceSpp).biased());
  // a light that does not scatter is not missed by chance
  reference.setVariance(std::vector<float>(variance.size(), 0.25f / kReferenceSpp));
  EXPECT_TRUE(seedStatistics(seeds, reference, kSpp).biased());
}

// What has the reference's own variance per sample and is too dark is caught as soon as without its help.
TEST(Seeds, ADarkerOneIsNotExcused) {
  Reference reference = exact();
  constexpr uint32_t kReferenceSpp = 1 << 12;
  reference.setVariance(std::vector<float>(reference.image.rgb.size(), 0.25f / kReferenceSpp));
  reference.spp = kReferenceSpp;
  const SeedStatistics strip = seedStatistics(images(normalNoise, 64, 2, -0.03f, 16), reference, 64);
  EXPECT_TRUE(strip.biased()) << strip.bias.failed << " blocks, " << strip.bias.unmet << " unmet";
  // by so little that the image alone shows it
  const SeedStatistics all = seedStatistics(images(normalNoise, 64, 2, -0.0015f, kWidth), reference, 64);
  EXPECT_EQ(all.bias.failed, 0u);
  EXPECT_TRUE(all.bias.imageBiased()) << all.bias.imageZ;
  // and where the reference is worth no more than a sample, it may be chance
  reference.setVariance(std::vector<float>(reference.image.rgb.size(), 25.0f / kReferenceSpp));
  const SeedStatistics unsure = seedStatistics(images(normalNoise, 64, 2, -0.01f, kWidth), reference, 64);
  EXPECT_TRUE(unsure.bias.imageUnmet) << unsure.bias.imageZ;
  EXPECT_TRUE(unsure.unclear());
}

TEST(Seeds, FalseAlarmsAreAsRareAsStated) {
  // 200 images without bias at a level of 2 x 0.001: more than 3 alarms in fewer than 1e-3 of all test seeds
  int alarms = 0;
  for (uint64_t k = 0; k < 200; ++k) alarms += seedStatistics(images(normalNoise, 1, 100 + k), exact(), 1).biased();
  EXPECT_LE(alarms, 3);
}

TEST(Seeds, ConvergedImagesAreCompared) {
  Reference a, b;
  a.image = images(normalNoise, 256, 6)[0], b.image = images(normalNoise, 256, 7)[0];
  a.variance.assign(a.image.rgb.size(), 0.25f / 256), b.variance = a.variance;
  EXPECT_FALSE(compareConverged(a, b).biased());
  for (float& v : b.image.rgb) v += 0.02f;
  EXPECT_TRUE(compareConverged(a, b).biased());
}

// An even background, exact but for the last digits of floats, and between two renderers' skies for 4 in 10^4, as
// Nishita's of the studio.
TEST(Seeds, RoundingIsNoBias) {
  Reference a, b;
  a.image = {16, 16, std::vector<float>(16 * 16 * 3, 0.0508760884f)};
  b.image = {16, 16, std::vector<float>(16 * 16 * 3, 0.0508761294f)};
  a.variance.assign(a.image.rgb.size(), 0.0f), b.variance = a.variance;
  EXPECT_FALSE(compareConverged(a, b).biased());
  EXPECT_FALSE(seedStatistics(std::vector<RgbImage>(8, a.image), b, 1).biased());
  for (float& v : b.image.rgb) v *= 1.0004f;
  EXPECT_FALSE(compareConverged(a, b).biased());
  EXPECT_TRUE(seedStatistics(std::vector<RgbImage>(8, a.image), b, 1).biased());
  EXPECT_FALSE(seedStatistics(std::vector<RgbImage>(8, a.image), b, 1, kParity).biased());
  for (float& v : b.image.rgb) v *= 1.002f;
  EXPECT_TRUE(compareConverged(a, b).biased());
  EXPECT_TRUE(seedStatistics(std::vector<RgbImage>(8, a.image), b, 1, kParity).biased());
}

TEST(Seeds, SlopesAreJudged) {
  const auto judge = [](double low, double high, const SlopeFacts& facts, std::optional<Interval> bySamples = {}) {
    return judgeSlope({(low + high) / 2, low, high}, bySamples, facts);
  };
  const auto cause = [&](auto... arguments) { return std::string(judge(arguments...).cause); };
  EXPECT_EQ(cause(-1.05, -0.97, SlopeFacts{.biased = true, .heavy = true}), "none");
  EXPECT_EQ(cause(-0.9, -0.8, SlopeFacts{.biased = true}), "bias");
  EXPECT_EQ(cause(-0.9, -0.8, SlopeFacts{.heavy = true}), "heavy tail");
  EXPECT_EQ(cause(-0.9, -0.8, SlopeFacts{.biased = true, .heavy = true}), "both");
  EXPECT_EQ(cause(-0.9, -0.8, SlopeFacts{}), "unclear");
  EXPECT_EQ(cause(-1.4, -1.2, SlopeFacts{.independent = false}), "sampler");
  EXPECT_EQ(cause(-1.4, -1.2, SlopeFacts{}), "unclear");
  // the pilot's equal counts do better than what is shared out after it, or worse
  const SlopeFacts pilot{.pilot = true}, apart{.pilot = true, .pilotApart = true};
  EXPECT_EQ(cause(-1.4, -1.2, pilot), "allocation");
  EXPECT_EQ(cause(-0.9, -0.8, pilot, Interval{-0.85, -0.9, -0.8}), "allocation");
  EXPECT_EQ(cause(-0.9, -0.8, pilot, Interval{-1, -1.1, -0.9}), "unclear") << "it is the time";
  EXPECT_EQ(cause(-0.9, -0.8, SlopeFacts{.unclear = true, .pilot = true}, Interval{-0.85, -0.9, -0.8}), "unclear");
  EXPECT_EQ(cause(-0.9, -0.8, apart, Interval{-0.85, -0.9, -0.8}), "unclear") << "it is not in the image";
  EXPECT_EQ(cause(-1.4, -1.2, apart), "unclear");
  // time that does not grow with the samples
  const Interval nearly{-1.02, -1.03, -1.01};
  EXPECT_EQ(cause(-1.4, -1.2, apart, nearly), "overhead");
  EXPECT_NE(judge(-1.4, -1.2, apart, nearly).text.find("pilot"), std::string::npos);
  EXPECT_EQ(cause(-1.4, -1.2, SlopeFacts{}, nearly), "overhead");
  EXPECT_EQ(judge(-1.4, -1.2, SlopeFacts{}, nearly).text.find("pilot"), std::string::npos) << "there is none";
}

}  // namespace
}  // namespace wardmis
