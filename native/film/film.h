// SPDX-License-Identifier: GPL-3.0-or-later
// What is accumulated per pixel. Each pixel is written by one thread at a time, and its sums do not depend on their
// order: the image depends neither on the number of threads nor on how its samples are shared out.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "film/pixel_shares.h"
#include "math/component.h"
#include "math/exact_sum.h"
#include "math/vec.h"

namespace wardmis {

// Sums over three channels.
using RgbSum = ExactSum<3>;
template <class Sum>
void addTo(Sum& sum, Vec3f v) {
  sum.add({double(v.x), double(v.y), double(v.z)});
}

struct Pixel {
  RgbSum sum, squares;  // of the samples' radiance
  UnitSum<1> alpha;
  UnitSum<3> normal, albedo;
  float depth = 1e10f;  // planar; through the pixel's centre

  void add(Rgb v) {
    const std::array<double, 3> c{double(v.x), double(v.y), double(v.z)};
    sum.add(c);
    squares.add({c[0] * c[0], c[1] * c[1], c[2] * c[2]});
  }
};

// What the camera meets first, for compositing: kept where a pass of it is wanted.
struct DataPixel {
  Vec3f position{0, 0, 0};                   // world; through the pixel's centre, as the indices are
  float objectIndex = 0, materialIndex = 0;  // 0 where nothing was hit
  RgbSum uv;                                 // over the samples of (u, v, 1)
  RgbSum emission, environment;              // of what is seen of them without a surface between

  static void add(RgbSum& sum, Rgb v) {
    if (isFinite(v)) addTo(sum, v);
  }
};

// Light by the component of the surface that the camera meets first: sums of what arrives there directly, by way of
// other surfaces, and of its own colour. Kept where a pass of it is wanted.
struct LightPixel {
  using Sums = std::array<RgbSum, kComponents>;
  Sums direct, indirect, color;
};

// Of a pixel where the camera may meet shadow catchers first. Their light is no part of the picture, but by how much it
// is less than where nothing but catchers is (as in Cycles): a quotient, so of what the samples bring sums are kept.
struct CatcherPixel {
  RgbSum light, alone;  // that catchers send, of Pixel::sum; and where they are alone
  RgbSum sky;           // that is seen, or would be behind catchers; of a film that is not transparent
  UnitSum<1> covered;   // samples, by what else than catchers they see
  uint32_t caught = 0;  // samples that see catchers
};

struct FilmBuffer {
  int width = 0, height = 0;  // of the border; row 0 is the bottom row
  std::vector<Pixel> pixels;
  size_t techniques = 0;               // that the renderer counts
  std::vector<uint32_t> sampleCounts;  // [pixel * techniques + technique]: samples that it took at first hits
  std::vector<uint32_t> rays;          // of each pixel; empty where no survey wants it
  std::vector<DataPixel> data;         // of each pixel; empty where no pass wants it
  std::vector<LightPixel> light;       // likewise
  std::vector<CatcherPixel> catchers;  // of each pixel; empty where there are none
  bool transparent = false;            // without the sky
  uint32_t first = 0;                  // of the image's camera samples, the first that is here
  uint32_t samples = 0;                // from there on, where pixels share them evenly; of a pixel: count()
  double partial = 0;                  // of one more, that so many of the pixels have
  PixelShares shares;                  // of the pixels

  FilmBuffer() = default;
  FilmBuffer(int w, int h, size_t techniqueCount = 0)
      : width(w),
        height(h),
        pixels(static_cast<size_t>(w) * static_cast<size_t>(h)),
        techniques(techniqueCount),
        sampleCounts(pixels.size() * techniqueCount) {}
  Pixel& at(int x, int y) {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }
  const Pixel& at(int x, int y) const {
    return pixels[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)];
  }

  // Samples that a pixel has.
  uint32_t count(size_t index) const {
    return shares.count(index, double(first) + samples + partial) - shares.count(index, first);
  }

  // p: one of `pixels`.
  uint32_t count(const Pixel& p) const { return count(static_cast<size_t>(&p - pixels.data())); }

  Rgb mean(const Pixel& p) const {
    const uint32_t n = count(p);
    const double s = n > 0 ? 1.0 / n : 0;
    return {static_cast<float>(p.sum[0] * s), static_cast<float>(p.sum[1] * s), static_cast<float>(p.sum[2] * s)};
  }
  // The picture: colour, which alpha is in already, and alpha.
  std::array<float, 4> combined(size_t index) const {
    const Pixel& p = pixels[index];
    const Rgb c = mean(p);
    const uint32_t n = count(p);
    const double alpha = n > 0 ? p.alpha[0] / n : 0;
    if (catchers.empty() || n == 0) return {c.x, c.y, c.z, static_cast<float>(alpha)};
    const CatcherPixel& k = catchers[index];
    const double covered = std::clamp(k.covered[0] / n, 0.0, 1.0);
    double lit = 1;
    if (k.caught > 0) {
      lit = 0;
      for (size_t i = 0; i < 3; ++i) lit += (k.alone[i] != 0 ? k.light[i] / k.alone[i] : 1) / 3;
      lit = 1 + std::clamp(alpha, 0.0, 1.0) * (lit - 1);
    }
    const double shown = covered + (1 - covered) * (1 - std::clamp(lit, 0.0, 1.0)), sky = transparent ? 0 : 1 - shown;
    const auto channel = [&](size_t i) { return static_cast<float>((p.sum[i] - k.light[i] + sky * k.sky[i]) / n); };
    return {channel(0), channel(1), channel(2), transparent ? static_cast<float>(shown) : 1.0f};
  }
  // Variance of the mean, from the samples as if they were independent; 0 with fewer than two samples, and no more than
  // a float holds.
  Rgb variance(const Pixel& p) const {
    const double n = count(p);
    if (n < 2) return {0, 0, 0};
    const auto one = [&](size_t i) {
      const double mean = p.sum[i] / n;
      constexpr double kMost = std::numeric_limits<float>::max();
      return static_cast<float>(std::clamp((p.squares[i] / n - mean * mean) / (n - 1), 0.0, kMost));
    };
    return {one(0), one(1), one(2)};
  }
};

}  // namespace wardmis
