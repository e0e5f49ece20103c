// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/pixel_shares.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "film/film.h"
#include "math/rel_mse.h"

namespace wardmis {
namespace {

using Values = std::vector<float>;  // of each pixel

constexpr uint32_t kLeastSamples = 32, kUsual = 64, kOfUsual = 16;
constexpr std::array<size_t, 5> kRadii{1, 2, 3, 5, 8};
constexpr std::array kContrasts{1.0, 0.75};
constexpr double kLargestShare = 8;       // of the image's samples
constexpr double kLeastAfter = 1.0 / 16;  // of those that follow: a survey may have missed what is rare
// Gains are told as of independent samples. Sobol's lose some of it where they are not as many in all pixels: scenes
// begin to gain where so much is promised (docs/performance.md).
constexpr double kLeastGain = 1.12;

template <class T>
double sumOf(const std::vector<T>& v) {
  return std::accumulate(v.begin(), v.end(), 0.0);
}

// Means over the squares of side 2 r + 1 around each pixel, without it.
template <class T>
class Around {
 public:
  Around(const std::vector<T>& of, size_t width)
      : of_(of), width_(width), height_(of.size() / width), sums_((width + 1) * (height_ + 1)) {
    for (size_t y = 0; y < height_; ++y) {
      double row = 0;
      for (size_t x = 0; x < width_; ++x) {
        row += double(of[y * width_ + x]);
        sums_[(y + 1) * (width_ + 1) + x + 1] = sums_[y * (width_ + 1) + x + 1] + row;
      }
    }
  }
  double operator()(size_t x, size_t y, size_t radius) const {
    const size_t x0 = x - std::min(x, radius), x1 = std::min(width_, x + radius + 1);
    const size_t y0 = y - std::min(y, radius), y1 = std::min(height_, y + radius + 1);
    const auto at = [&](size_t u, size_t v) { return sums_[v * (width_ + 1) + u]; };
    const size_t count = (x1 - x0) * (y1 - y0) - 1;
    if (count == 0) return 0;
    const double sum = at(x1, y1) - at(x0, y1) - at(x1, y0) + at(x0, y0) - double(of_[y * width_ + x]);
    return std::max(0.0, sum / static_cast<double>(count));  // rounding may make less of it
  }

 private:
  const std::vector<T>& of_;
  size_t width_, height_;
  std::vector<double> sums_;  // from the corner to each pixel
};

using Costs = std::vector<uint32_t>;  // rays of each pixel

// The shares of each pixel, between `least` and kLargestShare, that cost on the whole what one for all costs.
Values sharesBy(const Around<float>& error, const Around<uint32_t>& cost, const Costs& costs, size_t width,
                size_t radius, double contrast, double least) {
  Values n(costs.size());
  tbb::parallel_for(size_t{0}, costs.size() / width, [&](size_t y) {
    for (size_t x = 0; x < width; ++x) {
      const double c = cost(x, y, radius);
      n[y * width + x] = c > 0 ? static_cast<float>(std::pow(error(x, y, radius) / c, 0.5 * contrast)) : 0;
    }
  });
  const double all = sumOf(costs), mean = sumOf(n) / static_cast<double>(n.size());
  if (!(mean > 0)) return Values(n.size(), 1.0f);
  double scale = 1 / mean;
  const auto share = [&](float v) { return std::clamp(double(v) * scale, least, kLargestShare); };
  for (int round = 0; round < 12; ++round) {
    double sum = 0;
    for (size_t i = 0; i < n.size(); ++i) sum += costs[i] * share(n[i]);
    scale *= all / sum;
  }
  for (float& v : n) v = static_cast<float>(share(v));
  return n;
}

// Error x time of even shares over that of shares n, of the pixels whose relative variances are `errors`.
double gainOf(const Values& n, const Values& errors, const Costs& costs, const std::vector<bool>& counts) {
  double even = 0, shared = 0, cost = 0;
  for (size_t i = 0; i < n.size(); ++i) {
    cost += costs[i] * double(n[i]);
    if (counts[i]) even += double(errors[i]), shared += double(errors[i] / n[i]);
  }
  return shared > 0 ? even / shared * sumOf(costs) / cost : 1;
}

}  // namespace

uint32_t PixelSurvey::samplesFor(uint32_t samples) {
  if (samples < kLeastSamples) return 0;
  // like the root of the samples, in a power of two
  return std::bit_floor(static_cast<uint32_t>(kOfUsual * std::sqrt(samples / double(kUsual))));
}

void PixelSurvey::half(const FilmBuffer& film) {
  half_.resize(film.pixels.size());
  const double n = film.samples;
  tbb::parallel_for(size_t{0}, half_.size(), [&](size_t i) {
    const Pixel& p = film.pixels[i];
    for (size_t c = 0; c < 3; ++c) {
      const double mean = p.sum[c] / n;
      half_[i].mean[c] = static_cast<float>(mean);
      half_[i].deviation[c] = static_cast<float>(std::sqrt(std::max(0.0, p.squares[c] / n - mean * mean)));
    }
  });
}

PixelShares PixelSurvey::shares(const FilmBuffer& film, uint32_t samples, double& gain) const {
  const size_t pixels = film.pixels.size(), width = static_cast<size_t>(film.width);
  const double each = 0.5 * film.samples;  // samples of a half
  std::array<Values, 2> of{Values(pixels), Values(pixels)};
  Values all(pixels);
  tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
    const Pixel& p = film.pixels[i];
    for (size_t c = 0; c < 3; ++c) {
      const double m = p.sum[c] / film.samples, relative = 1 / (m * m + kRelMseEpsilon) / 3;
      const double mean = double(half_[i].mean[c]),
                   variance = double(half_[i].deviation[c]) * double(half_[i].deviation[c]);
      const double otherMean = p.sum[c] / each - mean,
                   other = p.squares[c] / each - (variance + mean * mean) - otherMean * otherMean;
      of[0][i] += static_cast<float>(variance * each / (each - 1) * relative);
      of[1][i] += static_cast<float>(std::max(0.0, other) * each / (each - 1) * relative);
    }
    all[i] = 0.5f * (of[0][i] + of[1][i]);
  });
  Values sorted = all;
  const auto last = sorted.begin() + static_cast<ptrdiff_t>(keptOfTrimmed(pixels)) - 1;
  std::nth_element(sorted.begin(), last, sorted.end());
  std::vector<bool> counts(pixels);  // the metric leaves out the worst
  for (size_t i = 0; i < pixels; ++i) counts[i] = all[i] <= *last;

  const Around cost(film.rays, width);
  const double begun = double(film.samples) / samples, least = begun + (1 - begun) * kLeastAfter;
  gain = kLeastGain;
  size_t radius = 0;
  double contrast = 1;
  {
    const std::array by{Around(of[0], width), Around(of[1], width)};
    for (const size_t r : kRadii)
      for (const double c : kContrasts) {
        double promised = 0;
        for (size_t h = 0; h < 2; ++h)
          promised += 0.5 * gainOf(sharesBy(by[h], cost, film.rays, width, r, c, least), of[1 - h], film.rays, counts);
        if (promised > gain) gain = promised, radius = r, contrast = c;
      }
  }
  if (radius == 0) return gain = 1, PixelShares{};
  PixelShares shares{film.samples, sharesBy(Around(all, width), cost, film.rays, width, radius, contrast, least)};
  for (float& n : shares.after) n = static_cast<float>((double(n) - begun) / (1 - begun));
  return shares;
}

}  // namespace wardmis
