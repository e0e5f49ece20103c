// SPDX-License-Identifier: GPL-3.0-or-later
// What each way to make a path brings to an image, with its weight and alone: the pyramid of techniques that Veach
// (1997, figure 10.2) shows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "math/vec.h"

namespace wardmis {

// Of paths with so many surfaces, `byCamera` of which the camera made, and a light the others. By the camera alone: an
// emitter is found from the last one, by a sample of the surface or of the lights.
class WayImages {
 public:
  static constexpr int kMostSurfaces = 8;

  WayImages(size_t pixels, int depth);

  int surfaces() const { return surfaces_; }  // of the longest paths that are noted
  size_t ways() const { return count(surfaces_); }
  static size_t index(int surfaces, int byCamera) { return count(surfaces - 1) + static_cast<size_t>(byCamera); }

  // What a sample brings with its weight; beyond the longest paths it is left out.
  void add(size_t pixel, int surfaces, int byCamera, Rgb value, double weight) {
    if (surfaces > surfaces_) return;
    const size_t at = index(surfaces, byCamera) * pixels_ + pixel;
    now_[at] += value;
    alone_[at] += value * static_cast<float>(1 / weight);
  }
  // Samples that were drawn, whatever they brought.
  void tried(size_t pixel, int surfaces, int byCamera, size_t samples) {
    if (surfaces <= surfaces_) tried_[index(surfaces, byCamera) * pixels_ + pixel] += static_cast<float>(samples);
  }
  // After each camera sample of all pixels, by one thread.
  void endSample();

  // Means over the samples, of a way.
  std::vector<Rgb> weighted(size_t way) const { return mean(sum_, way); }
  std::vector<Rgb> alone(size_t way) const { return mean(alone_, way); }
  // Of each pixel, the variance of one sample's luminance.
  std::vector<double> variance(size_t way) const;
  double tried(size_t way) const;  // for each pixel and sample

 private:
  static size_t count(int surfaces) {  // of ways with so many or fewer
    return static_cast<size_t>(surfaces * (surfaces + 3) / 2);
  }
  std::vector<Rgb> mean(const std::vector<Rgb>& sums, size_t way) const;

  size_t pixels_;
  int surfaces_;
  uint32_t samples_ = 0;
  std::vector<Rgb> now_, sum_, alone_;  // by way, then pixel; now_: of the sample at hand
  std::vector<double> squares_;
  std::vector<float> tried_;
};

}  // namespace wardmis
