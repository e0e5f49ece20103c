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

constexpr uint32_t kFirstKept = 4, kFirstTold = 8;  // samples
constexpr double kNormal95 = 1.6449;                // one-sided

std::array<float, 3> sumOf(const Pixel& p) {
  return {static_cast<float>(p.sum[0]), static_cast<float>(p.sum[1]), static_cast<float>(p.sum[2])};
}

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
  const uint32_t n = film.samples;
  const size_t pixels = film.pixels.size();
  const bool power = std::has_single_bit(n);
  std::vector<std::array<float, 3>> sums(pixels);
  tbb::parallel_for(size_t{0}, pixels, [&](size_t i) { sums[i] = sumOf(film.pixels[i]); });
  std::optional<EstimatedError> error;
  if (n >= kFirstTold && lastCount_ == (power ? n / 2 : n - n / 3)) {
    const int runs = power ? 2 : 3;
    const double each = double(runs) / n;  // over the samples of a run
    std::vector<double> errors(pixels);
    tbb::parallel_for(size_t{0}, pixels, [&](size_t i) {
      for (size_t c = 0; c < 3; ++c) {
        const double all = double(sums[i][c]), last = double(last_[i][c]),
                     before = runs == 3 ? double(before_[i][c]) : 0, mean = all / n;
        const double run[] = {(all - last) * each, (last - before) * each, before * each};
        double scatter = 0;
        for (int b = 0; b < runs; ++b) scatter += (run[b] - mean) * (run[b] - mean);
        // What it converges to is between its runs, and of them nearest to the pixels beside it: where one run has met
        // rare light, the mean would make little of the error.
        const auto [least, most] = std::minmax_element(run, run + runs);
        const double value =
            std::clamp(double(besides(sums, static_cast<size_t>(film.width), i, c)) / n, *least, *most);
        errors[i] += scatter / (runs * (runs - 1)) / (value * value + kRelMseEpsilon) / 3;
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
  if (power) {
    std::swap(before_, last_);
    last_ = std::move(sums);
    lastCount_ = n;
  }
  return error;
}

}  // namespace wardmis
