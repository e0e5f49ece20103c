// SPDX-License-Identifier: GPL-3.0-or-later
// What is accumulated per pixel. Each pixel is written by one thread at a time and in the order of its samples, so that
// the image does not depend on the number of threads.
#pragma once

#include <array>
#include <vector>

#include "math/component.h"
#include "math/vec.h"

namespace wardmis {

struct Pixel {
  std::array<double, 3> sum{}, squares{};  // of the samples' radiance
  float alpha = 0;
  float depth = 1e10f;  // planar, of the first sample
  Vec3f normal{0, 0, 0};
  Rgb albedo{0, 0, 0};
  uint32_t visits = 0;  // first hits on the pixel's own surface

  void add(Rgb v) {
    const float c[3] = {v.x, v.y, v.z};
    for (size_t i = 0; i < 3; ++i) {
      sum[i] += double(c[i]);
      squares[i] += double(c[i]) * double(c[i]);
    }
  }
};

// A face of an object, as far as one allocation and one sequence of points can serve all of it.
struct PixelSurface {
  Vec3f normal{0, 0, 0};
  int material = -1;  // none: no surface
  uint32_t placement = ~0u;

  bool holds(const PixelSurface& b) const {
    constexpr float kSameFace = 0.9f;  // cos of the largest turn of the normal
    return material == b.material && placement == b.placement && dot(normal, b.normal) >= kSameFace;
  }
};

// What the camera meets first, for compositing: kept where a pass of it is wanted.
struct DataPixel {
  Vec3f position{0, 0, 0};                          // world; of the first sample, as the indices are
  float objectIndex = 0, materialIndex = 0;         // 0 where nothing was hit
  Vec3f uv{0, 0, 0};                                // sum over the samples of (u, v, 1)
  std::array<double, 3> emission{}, environment{};  // sums of what is seen of them without a surface between

  static void add(std::array<double, 3>& sum, Rgb v) {
    if (isFinite(v)) sum = {sum[0] + double(v.x), sum[1] + double(v.y), sum[2] + double(v.z)};
  }
};

// Light by the component of the surface that the camera meets first: sums of what arrives there directly, by way of
// other surfaces, and of its own colour. Kept where a pass of it is wanted.
struct LightPixel {
  using Sums = std::array<std::array<double, 3>, kComponents>;
  Sums direct{}, indirect{}, color{};
};

struct FilmBuffer {
  int width = 0, height = 0;  // of the border; row 0 is the bottom row
  std::vector<Pixel> pixels;
  size_t techniques = 0;               // that the renderer counts
  std::vector<uint32_t> sampleCounts;  // [pixel * techniques + technique]: samples that it took at first hits
  std::vector<PixelSurface> own;       // of each pixel: that of its first hit
  std::vector<uint32_t> elsewhere;     // of the samples, those on other surfaces than the pixel's own
  std::vector<DataPixel> data;         // of each pixel; empty where no pass wants it
  std::vector<LightPixel> light;       // likewise
  uint32_t samples = 0;                // camera samples that every pixel has

  FilmBuffer() = default;
  FilmBuffer(int w, int h, size_t techniqueCount = 0)
      : width(w),
        height(h),
        pixels(static_cast<size_t>(w) * static_cast<size_t>(h)),
        techniques(techniqueCount),
        sampleCounts(pixels.size() * techniqueCount),
        own(pixels.size()),
        elsewhere(sampleCounts.size()) {}
  Pixel& at(int x, int y) {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  const Pixel& at(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }

  Rgb mean(const Pixel& p) const {
    const double s = samples > 0 ? 1.0 / samples : 0;
    return {static_cast<float>(p.sum[0] * s), static_cast<float>(p.sum[1] * s), static_cast<float>(p.sum[2] * s)};
  }
  // Variance of the mean, from the samples as if they were independent; 0 with fewer than two samples.
  Rgb variance(const Pixel& p) const {
    if (samples < 2) return {0, 0, 0};
    const double n = samples;
    const auto one = [&](size_t i) {
      const double mean = p.sum[i] / n;
      return static_cast<float>(std::max(0.0, p.squares[i] / n - mean * mean) / (n - 1));
    };
    return {one(0), one(1), one(2)};
  }
};

}  // namespace wardmis
