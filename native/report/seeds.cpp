// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/seeds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "math/number.h"

namespace wardmis {
namespace {

constexpr double kUnsureSlope = 1;  // width of an interval that says nothing
constexpr double kByTime = 0.5;     // a slope so much nearer to -1 against samples is one of the time

size_t blocksAcross(int pixels) { return static_cast<size_t>((pixels + kBlock - 1) / kBlock); }

// Means over blocks of a value per pixel.
std::vector<double> blockMeans(int width, int height, const std::function<double(size_t)>& value, bool squaredWeights) {
  const size_t across = blocksAcross(width);
  std::vector<double> sum(across * blocksAcross(height)), count(sum.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const size_t b = static_cast<size_t>(y / kBlock) * across + static_cast<size_t>(x / kBlock);
      sum[b] += value(static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x));
      count[b] += 1;
    }
  for (size_t b = 0; b < sum.size(); ++b) sum[b] /= squaredWeights ? count[b] * count[b] : count[b];
  return sum;
}

double grey(const std::vector<float>& rgb, size_t pixel) {
  return (double(rgb[3 * pixel]) + double(rgb[3 * pixel + 1]) + double(rgb[3 * pixel + 2])) / 3;
}

// Of the mean of three channels; as if they were one: they share their samples.
double greyVariance(const std::vector<float>& variance, size_t pixel) {
  double deviation = 0;
  for (size_t c = 0; c < 3; ++c) deviation += std::sqrt(double(variance[3 * pixel + c]));
  return deviation / 3 * (deviation / 3);
}

void spreadOverPixels(BiasTest& test, const std::vector<double>& z, int width, int height) {
  test.z.resize(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      test.z[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] = static_cast<float>(
          z[static_cast<size_t>(y / kBlock) * blocksAcross(width) + static_cast<size_t>(x / kBlock)]);
}

BiasTest testBias(const std::vector<RgbImage>& images, const Reference& reference, uint32_t spp, double exactness) {
  const double n = double(images.size());
  const RgbImage& r = reference.image;
  const int w = r.width, h = r.height;
  const size_t pixels = r.pixels();
  const std::vector<double> truth = blockMeans(
      w, h, [&](size_t i) { return grey(r.rgb, i); }, false);
  std::vector<double> own(truth.size());
  double ownImage = 0;
  if (reference.known()) {
    own = blockMeans(
        w, h, [&](size_t i) { return greyVariance(reference.variance, i); }, true);
    for (size_t i = 0; i < pixels; ++i) ownImage += greyVariance(reference.variance, i);
    ownImage /= double(pixels) * double(pixels);
  }
  // of the mean of all seeds, if each of their samples varied as those of the reference do; 0 where nobody knows
  const double samples = reference.spp > 0 ? double(reference.spp) / (double(spp) * n) : 0;
  std::vector<double> sum(truth.size()), squares(truth.size());
  double imageSum = 0, imageSquares = 0;
  for (const RgbImage& image : images) {
    const std::vector<double> means = blockMeans(
        w, h, [&](size_t i) { return grey(image.rgb, i); }, false);
    for (size_t b = 0; b < means.size(); ++b) {
      const double d = means[b] - truth[b];
      sum[b] += d, squares[b] += d * d;
    }
    double d = 0;
    for (size_t i = 0; i < pixels; ++i) d += grey(image.rgb, i) - grey(r.rgb, i);
    d /= double(pixels);
    imageSum += d, imageSquares += d * d;
  }
  // the seeds' spread and the reference's own, added: Student's t with the seeds' degrees of freedom, which is careful
  const auto tOf = [&](double s, double q, double extra, double value) {
    const double mean = s / n, variance = std::max(0.0, q / n - mean * mean) / (n - 1) + extra;
    return mean == 0 ? 0 : mean / std::sqrt(variance + square(exactness * value));
  };
  BiasTest test;
  test.chanceKnown = reference.known() && samples > 0;
  // too dark by more than the seeds' own spread explains, and by no more than the reference's does
  const auto isUnmet = [&](double s, double extra, double threshold) {
    return s < 0 && test.chanceKnown && extra > 0 && pOfNormal(s / n / std::sqrt(extra * (1 + samples))) >= threshold;
  };
  std::vector<double> z(truth.size());
  test.blocks = truth.size();
  test.threshold = sidak(kBiasLevel, test.blocks);
  for (size_t b = 0; b < truth.size(); ++b) {
    z[b] = tOf(sum[b], squares[b], own[b], truth[b]);
    const double p = pOfStudent(z[b], n - 1);
    test.smallestP = std::min(test.smallestP, p);
    if (p >= test.threshold) continue;
    ++test.failed;
    test.unmet += isUnmet(sum[b], own[b], test.threshold) ? 1 : 0;
  }
  double imageTruth = 0;
  for (size_t i = 0; i < pixels; ++i) imageTruth += grey(r.rgb, i) / double(pixels);
  test.imageZ = tOf(imageSum, imageSquares, ownImage, imageTruth);
  test.imageP = pOfStudent(test.imageZ, n - 1);
  test.imageUnmet = test.imageP < kBiasLevel && isUnmet(imageSum, ownImage, kBiasLevel);
  spreadOverPixels(test, z, w, h);
  return test;
}

}  // namespace

SeedStatistics seedStatistics(const std::vector<RgbImage>& images, const Reference& known, uint32_t spp,
                              double exactness) {
  const RgbImage& reference = known.image;
  const size_t values = reference.rgb.size();
  const double n = double(images.size());
  SeedStatistics s;
  std::vector<double> mean(values);
  for (const RgbImage& image : images)
    for (size_t i = 0; i < values; ++i) mean[i] += double(image.rgb[i]) / n;
  std::vector<double> second(values), fourth(values);
  std::vector<double> seedErrors;
  for (const RgbImage& image : images) {
    ImageError e = compareImages(image, reference);
    seedErrors.push_back(e.relMse);
    s.errors.push_back(std::move(e.relMsePixels));
    double sum = 0;
    for (size_t i = 0; i < values; ++i) {
      const double d = double(image.rgb[i]) - mean[i], d2 = d * d, r = double(reference.rgb[i]);
      second[i] += d2, fourth[i] += d2 * d2;
      sum += d2 / (r * r + kRelMseEpsilon);
    }
    s.spread.push_back(sum / double(values) * n / (n - 1));
  }
  s.mean = {reference.width, reference.height, std::vector<float>(values)};
  s.variance.resize(values);
  double weights = 0, kurtosis = 0;
  for (size_t i = 0; i < values; ++i) {
    s.mean.rgb[i] = static_cast<float>(mean[i]);
    s.variance[i] = static_cast<float>(second[i] / (n - 1));
    if (!(second[i] > 1e-12 * mean[i] * mean[i])) continue;
    const double r = double(reference.rgb[i]), weight = second[i] / (r * r + kRelMseEpsilon);
    weights += weight;
    kurtosis += weight * n * fourth[i] / (second[i] * second[i]);
  }
  // normal values have a mean sample kurtosis of 3 (n - 1)/(n + 1)
  if (weights > 0) s.tail.kurtosis = kurtosis / weights * (n + 1) / (n - 1);

  std::vector<double> perPixel(reference.pixels());
  for (const std::vector<float>& e : s.errors)
    for (size_t i = 0; i < perPixel.size(); ++i) perPixel[i] += double(e[i]);
  const double total = std::accumulate(perPixel.begin(), perPixel.end(), 0.0);
  const size_t top = (perPixel.size() + 999) / 1000;
  std::nth_element(perPixel.begin(), perPixel.begin() + static_cast<std::ptrdiff_t>(top), perPixel.end(),
                   std::greater<>());
  if (total > 0)
    s.tail.topShare =
        std::accumulate(perPixel.begin(), perPixel.begin() + static_cast<std::ptrdiff_t>(top), 0.0) / total;
  std::sort(seedErrors.begin(), seedErrors.end());
  if (const double median = seedErrors[seedErrors.size() / 2]; median > 0)
    s.tail.seedRatio = seedErrors.back() / median;
  s.bias = testBias(images, known, spp, exactness);
  return s;
}

BiasTest compareConverged(const Reference& a, const Reference& b) {
  const int w = a.image.width, h = a.image.height;
  BiasTest test;
  const std::vector<double> difference = blockMeans(
      w, h, [&](size_t i) { return grey(a.image.rgb, i) - grey(b.image.rgb, i); }, false);
  const std::vector<double> variance = blockMeans(
      w, h, [&](size_t i) { return greyVariance(a.variance, i) + greyVariance(b.variance, i); }, true);
  const std::vector<double> value = blockMeans(
      w, h, [&](size_t i) { return grey(a.image.rgb, i); }, false);
  std::vector<double> z(difference.size());
  test.blocks = difference.size();
  test.threshold = sidak(kBiasLevel, test.blocks);
  double sum = 0, squares = 0, all = 0;
  for (size_t k = 0; k < z.size(); ++k) {
    const double both = variance[k] + square(kParity * value[k]);
    z[k] = difference[k] == 0 ? 0 : difference[k] / std::sqrt(both);
    const double p = pOfNormal(z[k]);
    test.smallestP = std::min(test.smallestP, p);
    test.failed += p < test.threshold ? 1 : 0;
    sum += difference[k], squares += variance[k], all += value[k];
  }
  test.imageZ = sum == 0 ? 0 : sum / std::sqrt(squares + square(kParity * all));  // which all blocks may have alike
  test.imageP = pOfNormal(test.imageZ);
  spreadOverPixels(test, z, w, h);
  return test;
}

SlopeVerdict judgeSlope(const Interval& s, const std::optional<Interval>& bySamples, const SlopeFacts& facts) {
  const std::string found = fmt::format("{:.2f} [{:.2f}, {:.2f}]", s.value, s.low, s.high);
  if (s.high - s.low > kUnsureSlope) return {"none", "none", found + ": too unsure to say anything"};
  if (s.contains(-1)) return {"none", "none", found + ": as Monte Carlo estimates without bias have it"};
  const bool pilotInImage = facts.pilot && !facts.pilotApart;
  if (s.high < -1) {
    if (bySamples && bySamples->high - bySamples->low < kUnsureSlope &&
        std::abs(bySamples->value + 1) < kByTime * std::abs(s.value + 1))
      return {"steeper", "overhead",
              found + ": steeper against time than against samples, since " +
                  (facts.pilot ? "the pilot's time is spread over ever more"
                               : "the first samples take longer than those that follow")};
    if (!facts.independent)
      return {"steeper", "sampler",
              found + ": steeper, since the sampler's points are spread evenly" +
                  (pilotInImage ? " (and since the pilot, with other counts, is an ever smaller part)" : "")};
    if (pilotInImage)
      return {"steeper", "allocation",
              found + ": steeper, since the pilot, with other counts and time of its own, is an ever smaller part"};
    return {"steeper", "unclear", found + ": steeper than independent samples should be, and the cause is not found"};
  }
  if (facts.biased && facts.heavy)
    return {"shallower", "both",
            found + ": shallower; the mean of the seeds is not the reference's, and few samples carry the error"};
  if (facts.biased)
    return {"shallower", "bias", found + ": shallower, and the mean of the seeds is not the reference's: it is biased"};
  if (facts.heavy)
    return {"shallower", "heavy tail",
            found + ": shallower without a sign of bias: rare large samples carry the error (a heavy tail)"};
  if (facts.unclear)
    return {
        "shallower", "unclear",
        found + ": shallower; parts of the image differ from the reference, by chance or bias: more seeds would tell"};
  if (pilotInImage && bySamples && bySamples->low > -1)
    return {"shallower", "allocation",
            found +
                ": shallower, with no sign of bias or of a heavy tail: the samples of the pilot, an ever smaller "
                "part, do better than those that are shared out after it"};
  return {"shallower", "unclear", found + ": shallower, with no sign of bias or of a heavy tail"};
}

}  // namespace wardmis
