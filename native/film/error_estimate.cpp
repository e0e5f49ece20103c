// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/error_estimate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "math/rel_mse.h"

namespace wardmis {
namespace {

std::array<float, 3> sumOf(const Pixel& p) {
  return {static_cast<float>(p.sum[0]), static_cast<float>(p.sum[1]), static_cast<float>(p.sum[2])};
}

constexpr uint32_t kFirstKept = 4, kFirstTold = 8;  // samples
constexpr double kNormal95 = 1.6449;                // one-sided

// The median of the pixels beside one of an image of that width, of a channel.
float besides(const std::vector<std::array<float, 3>>& image, size_t width, size_t index, size_t channel) {
  const size_t height = image.size() / width, x = index % width, y = index / width;
  std::array<float, 8> values;
  size_t count = 0;
  for (size_t v = y - std::min<size_t>(y, 1); v <= std::min(height - 1, y + 1); ++v)
    for (size_t u = x - std::min<size_t>(x, 1); u <= std::min(width - 1, x + 1); ++u) {
      if (u == x && v == y) continue;
      const float value = image[v * width + u][channel];
      size_t at = count++;
      for (; at > 0 && values[at - 1] > value; --at) values[at] = values[at - 1];
      values[at] = value;
    }
  return count == 0 ? image[index][channel] : 0.5f * (values[(count - 1) / 2] + values[count / 2]);
}

}  // namespace

uint32_t ErrorEstimate::next(uint32_t samples) {
  if (samples < kFirstKept) return kFirstKept;
  if (samples < kFirstTold) return kFirstTold;
  const uint32_t power = std::bit_floor(samples), between = power + power / 2;
  return samples < between ? between : power <= (1u << 30) ? 2 * power : std::numeric_limits<uint32_t>::max();
}

std::optional<EstimatedError> ErrorEstimate::look(const FilmBuffer& film) {
  const size_t pixels = film.pixels.size();
  std::optional<EstimatedError> error;
  if (last_.empty()) {
    before_.resize(pixels), last_.resize(pixels);
  } else if (film.samples >= kFirstTold) {
    std::vector<std::array<float, 3>> means(pixels);
    tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
      const Rgb m = film.mean(film.pixels[i]);
      means[i] = {m.x, m.y, m.z};
    });
    std::vector<double> errors(pixels);
    tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
      const uint32_t n = film.count(i);
      const Record none, now{n, sumOf(film.pixels[i])};
      // its ends; of a pixel that has twice as many as at the last, before that is one run
      std::array<const Record*, 4> ends{&none, &before_[i], &last_[i], &now};
      if (n >= 2 * last_[i].samples) ends[1] = &none;
      for (size_t c = 0; c < 3; ++c) {
        const double mean = double(now.sum[c]) / n;
        double scatter = 0, least = std::numeric_limits<double>::infinity(), most = -least;
        int runs = 0;
        for (size_t b = 1; b < ends.size(); ++b) {
          const double length = double(ends[b]->samples) - ends[b - 1]->samples;
          if (!(length > 0)) continue;
          const double run = (double(ends[b]->sum[c]) - double(ends[b - 1]->sum[c])) / length;
          scatter += length * (run - mean) * (run - mean), ++runs;
          least = std::min(least, run), most = std::max(most, run);
        }
        if (runs < 2) continue;
        // What it converges to is between its runs, and of them nearest to the pixels beside it: where one run has met
        // rare light, the mean would make little of the error.
        const double value = std::clamp(double(besides(means, static_cast<size_t>(film.width), i, c)), least, most);
        errors[i] += scatter / (n * (runs - 1.0)) / (value * value + kRelMseEpsilon) / 3;
      }
    });
    const size_t kept = keptOfTrimmed(pixels);
    std::nth_element(errors.begin(), errors.begin() + static_cast<ptrdiff_t>(kept), errors.end());
    double sum = 0, squares = 0;
    for (size_t i = 0; i < kept; ++i) sum += errors[i], squares += errors[i] * errors[i];
    const double count = double(std::max<size_t>(1, kept)), mean = sum / count;
    const double standardError = kept > 1 ? std::sqrt(std::max(0.0, squares / count - mean * mean) / (count - 1))
                                          : std::numeric_limits<double>::infinity();
    error = {mean, mean + kNormal95 * standardError};
  }
  tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
    const uint32_t n = film.count(i);
    if (n >= 2 * last_[i].samples) before_[i] = last_[i], last_[i] = {n, sumOf(film.pixels[i])};
  });
  return error;
}

}  // namespace wardmis
