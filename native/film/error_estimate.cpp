// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/error_estimate.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace wardmis {
namespace {

constexpr uint32_t kFirstKept = 4, kFirstTold = 8;  // samples
constexpr double kEpsilon = 0.01;                   // of relMSE
constexpr double kNormal95 = 1.6449;                // one-sided
constexpr double kTrimmed = 0.001;                  // of the pixels

Rgb sumOf(const Pixel& p) {
  return {static_cast<float>(p.sum[0]), static_cast<float>(p.sum[1]), static_cast<float>(p.sum[2])};
}

// The median of the pixels beside one, of a channel's sum. values: for its own use.
double besides(const FilmBuffer& film, size_t index, size_t channel, std::vector<double>& values) {
  const int width = film.width, x = static_cast<int>(index % static_cast<size_t>(width)),
            y = static_cast<int>(index / static_cast<size_t>(width));
  values.clear();
  for (int v = std::max(0, y - 1); v <= std::min(film.height - 1, y + 1); ++v)
    for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u)
      if (u != x || v != y) values.push_back(film.at(u, v).sum[channel]);
  if (values.empty()) return film.pixels[index].sum[channel];
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
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
  const bool power = std::has_single_bit(n);
  std::optional<EstimatedError> error;
  if (n >= kFirstTold && lastCount_ == (power ? n / 2 : n - n / 3)) {
    const int runs = power ? 2 : 3;
    const double each = double(runs) / n;  // over the samples of a run
    std::vector<double> errors(film.pixels.size()), values;
    for (size_t i = 0; i < film.pixels.size(); ++i) {
      const Pixel& p = film.pixels[i];
      const std::array<std::array<double, 3>, 2> at{
          std::array{double(last_[i].x), double(last_[i].y), double(last_[i].z)},
          runs == 3 ? std::array{double(before_[i].x), double(before_[i].y), double(before_[i].z)}
                    : std::array<double, 3>{}};
      double pixel = 0;
      for (size_t c = 0; c < 3; ++c) {
        const double all = p.sum[c], mean = all / n;
        const double run[] = {(all - at[0][c]) * each, (at[0][c] - at[1][c]) * each, at[1][c] * each};
        double scatter = 0;
        for (int b = 0; b < runs; ++b) scatter += (run[b] - mean) * (run[b] - mean);
        // What it converges to is between its runs, and of them nearest to the pixels beside it: where one run has met
        // rare light, the mean would make little of the error.
        const auto [least, most] = std::minmax_element(run, run + runs);
        const double value = std::clamp(besides(film, i, c, values) / n, *least, *most);
        pixel += scatter / (runs * (runs - 1)) / (value * value + kEpsilon) / 3;
      }
      errors[i] = pixel;
    }
    const size_t kept = errors.size() - static_cast<size_t>(kTrimmed * double(errors.size()));
    std::nth_element(errors.begin(), errors.begin() + static_cast<ptrdiff_t>(kept - 1), errors.end());
    double sum = 0, squares = 0;
    for (size_t i = 0; i < kept; ++i) sum += errors[i], squares += errors[i] * errors[i];
    const double pixels = double(kept), mean = sum / pixels;
    const double standardError = pixels > 1 ? std::sqrt(std::max(0.0, squares / pixels - mean * mean) / (pixels - 1))
                                            : std::numeric_limits<double>::infinity();
    error = {mean, mean + kNormal95 * standardError};
  }
  if (power) {
    std::swap(before_, last_);
    last_.resize(film.pixels.size());
    for (size_t i = 0; i < film.pixels.size(); ++i) last_[i] = sumOf(film.pixels[i]);
    lastCount_ = n;
  }
  return error;
}

}  // namespace wardmis
