// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/light_visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "math/random.h"

namespace wardmis {
namespace {

constexpr size_t kCells = size_t{1} << 15;
constexpr float kPixels = 16, kMostAcross = 64;  // a cell is so many pixels wide, and the image at most so many cells

// Of the six directions along the axes the nearest one; 6: none.
uint32_t side(Vec3f n) {
  const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z), most = std::max({x, y, z});
  if (!(most > 0)) return 6;
  return x == most ? n.x > 0 : y == most ? 2 + (n.y > 0) : 4 + (n.z > 0);
}

}  // namespace

LightVisibility::LightVisibility(const Camera& camera, const Film& film)
    : eye_(camera.toWorld.t), orthographic_(camera.orthographic()), tallies_(kCells) {
  const float image = camera.panoramic() ? 2 * kPi<float> : camera.right - camera.left;
  const float width = image * std::max(kPixels / static_cast<float>(film.width), 1 / kMostAcross);
  width2_ = width * width;
}

size_t LightVisibility::cell(Vec3f p, Vec3f n) const {
  // Without functions of the C library, which would take as long as a lamp's sample.
  constexpr float kLeast = 1e-30f, kMost = 1e30f, kMostCells = 1 << 16;
  const Vec3f from = p - eye_;
  // the width is the power of two above width_ by the distance, so that cells of one width lie side by side
  const float square = width2_ * (orthographic_ ? 1 : dot(from, from));
  const auto bits = std::bit_cast<int32_t>(std::max(kLeast, std::min(square, kMost)));
  const int exponent = ((bits >> 23) - 127) >> 1;  // floor(log2(sqrt(square)))
  const auto scale = std::bit_cast<float>((127 - (exponent + 1)) << 23);
  uint32_t key = combine(static_cast<uint32_t>(exponent), side(n));
  for (const float x : {from.x, from.y, from.z})  // all above 0, so that rounding is downwards
    key = combine(key, static_cast<uint32_t>(std::max(0.0f, std::min(x * scale + kMostCells, 2 * kMostCells))));
  return key % kCells;
}

double LightVisibility::learn() {
  // Never 0: a light that the pilot has not seen may be seen. With one sample more, all of which are seen, a cell where
  // few were drawn is as if nothing was known.
  constexpr float kLeast = 0.05f;
  factors_.resize(kCells);
  double before = 0, after = 0;  // sums of the variances, by the light samples of each cell
  for (size_t c = 0; c < kCells; ++c) {
    const Tally& t = tallies_[c];
    double drawn = 0, seen = 0, kept = 0, square = 0;
    for (size_t i = 0; i < LightTree::kMostEntries; ++i) {
      const double all = t.drawn[i], its = t.seen[i];
      factors_[c][i] = std::max(kLeast, static_cast<float>((its + 1) / (all + 1)));
      const double factor = factors_[c][i];
      drawn += all, seen += its, kept += all * factor, square += its / factor;
    }
    if (!(drawn > 0)) continue;
    // entries are drawn with p_i, seen with v_i, then drawn with p_i f_i / sum p f: E = sum p v, E[X^2] = sum p v
    // before and sum p f sum p v / f after
    const double mean = seen / drawn;
    before += drawn * (mean - mean * mean);
    after += drawn * (kept / drawn * (square / drawn) - mean * mean);
  }
  return before > 0 ? after / before : 1;
}

}  // namespace wardmis
