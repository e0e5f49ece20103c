// SPDX-License-Identifier: GPL-3.0-or-later
// How far an image is from what it converges to, told by its own samples alone.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "film/film.h"

namespace wardmis {

struct EstimatedError {
  double relMse = 0;  // relMseTrimmed of compareImages() (report/metrics.h), against what the image converges to
  double upper = 0;   // it is below this with 95 % confidence, as far as the scatter over the pixels tells
};

// The n samples of a pixel are cut into B runs of n_b, of means m_b: sum_b n_b (m_b - m)^2 / (n (B - 1)) is the
// variance of m where the samples are independent, and more where those of a run avoid each other, as Sobol's and
// stratified points do. Runs of 2^k samples are good points of their own, so an image is looked at where it has 2^k (B
// = 2) or 1.5 2^k (B = 3); where pixels have other numbers, their runs are as these have grown. What no sample has met
// yet is in no estimate.
class ErrorEstimate {
 public:
  // The next n after `samples` at which a film is to be looked at.
  static uint32_t next(uint32_t samples);

  // To be called at each of them; the first, which are too few to tell, give none.
  std::optional<EstimatedError> look(const FilmBuffer& film);

  // What a pixel had.
  struct Record {
    uint32_t samples = 0;
    std::array<float, 3> sum{};
  };

  static constexpr uint64_t kBytesPerPixel = 2 * sizeof(Record) + 3 * sizeof(float) + sizeof(double);  // at most

 private:
  std::vector<Record> before_, last_;  // of each pixel, at the last two powers of 2 or where it had twice as many
};

}  // namespace wardmis
