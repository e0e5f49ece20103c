// SPDX-License-Identifier: GPL-3.0-or-later
// How an image's camera samples are shared between its pixels: as many for all, or more where they bring more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/random.h"

namespace wardmis {

struct FilmBuffer;

struct PixelShares {
  // The first samples, which all pixels have. Those that follow come in blocks of as many: a power of two, of which
  // each block is well spread.
  uint32_t even = 0;
  std::vector<float> after;  // of each pixel: samples for one of the image that follows; empty: one

  // Samples that a pixel has when the image has so many, which need not be a whole number: what is left of one sample,
  // or of a block, is as likely to be there as it is large.
  uint32_t count(size_t pixel, double samples) const {
    const double u = toUnit(mix(static_cast<uint32_t>(pixel)));
    if (after.empty() || samples <= even) return static_cast<uint32_t>(samples + u);
    return even * (1 + static_cast<uint32_t>((samples - even) * double(after[pixel]) / even + u));
  }
};

// Finds shares by an image's first samples: those of least sum of the pixels' errors, as the relMSE has them, in the
// time that as many samples for all take,
//
//   n_i = a sqrt(E_i / C_i)
//
// of E, the relative variance of a sample, v / (m^2 + epsilon), and C, its rays. Both are means over the pixels around,
// and not over the pixel itself: its own samples, which stay part of the image, have no say in how many follow, so that
// nothing is biased (but for one pixel's part in what is common to all). How far around, and how much of the contrast
// is kept, is what serves best when shares by one half of the samples are held against the errors of the other.
class PixelSurvey {
 public:
  // Of an image's `samples` those that a survey takes, an even number; 0: they are too few for one.
  static uint32_t samplesFor(uint32_t samples);

  // To be called after half of them,
  void half(const FilmBuffer& film);
  // and after all, of a film with its rays. samples: that the image is to have. gain: even shares' error x time over
  // that of these, as it is expected; 1 where even ones are as good, and returned.
  PixelShares shares(const FilmBuffer& film, uint32_t samples, double& gain) const;

  static constexpr uint64_t kBytesPerPixel = 13 * sizeof(float) + 3 * sizeof(double);  // at most

 private:
  // Of a pixel's samples. Not sums of squares, which floats do not hold where light is strong.
  struct Spread {
    std::array<float, 3> mean, deviation;
  };
  std::vector<Spread> half_;
};

}  // namespace wardmis
