// SPDX-License-Identifier: GPL-3.0-or-later
// What the last images of one configuration's seeds say together: their spread, whether their mean is the reference's,
// and whether few samples carry the error.
#pragma once

#include <functional>
#include <optional>

#include "report/experiment.h"
#include "report/resample.h"

namespace wardmis {

inline constexpr int kBlock = 8;             // pixels: side of the blocks that are tested for bias
inline constexpr double kBiasLevel = 0.001;  // chance of a false alarm over all blocks of an image, and over its mean
inline constexpr double kHeavyKurtosis = 6;  // of a pixel's values over the seeds; a normal distribution: 3
inline constexpr double kHeavySeeds = 3;     // largest over median error of a seed

// z-tests of the mean over seeds against the reference: blocks, each by Student's t over the seeds, Sidak over all of
// them; and the image as a whole.
// Seeds that have all missed a rare light agree with each other, and are sure of too dark a block. The reference has
// met it, and its variance says how dark so few samples could be: a block that is no darker tells nothing.
struct BiasTest {
  size_t blocks = 0, failed = 0;
  size_t unmet = 0;          // of the failed: not beyond what so few of the reference's samples would be off
  bool imageUnmet = false;   // the same of the image as a whole
  bool chanceKnown = false;  // whether the reference could tell that
  double smallestP = 1, threshold = 0, imageZ = 0, imageP = 1;
  std::vector<float> z;  // per pixel: of its block
  bool imageBiased() const { return imageP < kBiasLevel && !imageUnmet; }
  bool biased() const { return failed > unmet || imageBiased(); }
};

// How the squared error is spread. kurtosis: of a pixel's values over the seeds, pooled over pixels with the weight of
// their relative variance, corrected so that normal values give 3.
struct Tail {
  double topShare = 0;   // of the squared relative error in the worst 0.1 % of the pixels
  double seedRatio = 1;  // largest over median relMSE of a seed
  double kurtosis = 3;
  bool heavy() const { return kurtosis > kHeavyKurtosis || seedRatio > kHeavySeeds; }
};

struct SeedStatistics {
  RgbImage mean;
  std::vector<float> variance;             // per value, over the seeds
  std::vector<std::vector<float>> errors;  // of each seed, per pixel: relMSE against the reference
  std::vector<double> spread;  // of each seed: mean of (x - mean)^2 n/(n-1) / (r^2 + eps); their mean is the
                               // relative variance
  BiasTest bias;
  Tail tail;

  // Under a heavy tail a block that no large sample has met yet looks too dark and sure of it: where the reference does
  // not tell such blocks from others, the image alone counts.
  bool imageAlone() const { return tail.heavy() && !bias.chanceKnown; }
  bool biased() const { return imageAlone() ? bias.imageBiased() : bias.biased(); }
  // Something differs, but it may be chance or bias.
  bool unclear() const { return !biased() && (bias.failed > 0 || bias.imageP < kBiasLevel); }
};

// At least two images of the reference's size, of `spp` samples per pixel each. Throws as compareImages does.
// exactness: what is no difference, as a standard deviation of a value.
inline constexpr double kRounding = 1e-6;  // images are floats, and renderers add up in floats
// Two renderers compute skies and textures by formulas of their own, which agree to 2 in 10^4 (docs/nodes.md): where
// there is no noise, less is nothing that a picture would be used to tell.
inline constexpr double kParity = 2e-4;
SeedStatistics seedStatistics(const std::vector<RgbImage>& images, const Reference& reference, uint32_t spp,
                              double exactness = kRounding);

// The same test between two renderers' converged images, whose variances are known (normal, not Student's).
BiasTest compareConverged(const Reference& a, const Reference& b);

// Why a slope is not -1.
struct SlopeVerdict {
  const char* flag = "none";   // none, steeper, shallower
  const char* cause = "none";  // none, bias, heavy tail, both, sampler, overhead, allocation, unclear
  std::string text;
};
// What is known of the configuration whose slope it is.
struct SlopeFacts {
  bool biased = false, heavy = false;
  bool unclear = false;     // whether it is biased
  bool independent = true;  // the sampler's points are
  bool pilot = false;       // allocated after a pilot of equal counts,
  bool pilotApart = false;  // whose samples are no part of the image
};
// bySamples: the slope against samples instead of seconds.
SlopeVerdict judgeSlope(const Interval& slope, const std::optional<Interval>& bySamples, const SlopeFacts& facts);

}  // namespace wardmis
