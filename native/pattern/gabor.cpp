// SPDX-License-Identifier: GPL-3.0-or-later
#include "pattern/gabor.h"

#include "math/number.h"
#include "pattern/cells.h"

namespace wardmis::pattern {
namespace {

constexpr int kKernels = 8;  // a cell
constexpr float kPiF = kPi<float>;

// C numbers of a kernel. Two of three coordinates turn these, where other hashes append to them.
template <int C, int D>
std::array<float, C> units(const Point<D>& k) {
  if constexpr (D == 3) {
    static_assert(C == 2);
    return {hashToUnit(k), hashToUnit(Point<3>{{k[2], k[0], k[1]}})};
  } else {
    return hashToUnits<C>(k);
  }
}

// The wave vector's direction: the base, turned at random by up to `isotropy` of half a turn (a kernel and its negative
// have the same wave).
Point<2> direction(const Point<2>& base, float isotropy, const Point<3>& key) {
  if (isotropy == 0) return base;
  const float angle = (hashToUnit(key) - 0.5f) * kPiF * isotropy, c = std::cos(angle), s = std::sin(angle);
  return {{c * base[0] - s * base[1], s * base[0] + c * base[1]}};
}
// NaN for the base along z (as in Cycles), whose azimuth is not defined, unless it is not turned.
Point<3> direction(const Point<3>& base, float isotropy, const Point<4>& key) {
  if (isotropy == 0) return base;
  const auto [u, v] = units<2>(key);
  const float theta = std::acos(base[2]) + u * kPiF * isotropy;
  const float across = std::sqrt(base[0] * base[0] + base[1] * base[1]);
  const float phi = (base[1] < 0 ? -1 : 1) * std::acos(base[0] / across) + v * kPiF * isotropy;
  return {{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}};
}

struct Phasor {
  float re = 0, im = 0;
};

// All kernels that reach p: Gaussians under a Hann window, times the wave (equation 6 of Lagae et al.), each with sign
// + or -.
template <int D>
Phasor sumOfKernels(const Point<D>& p, float frequency, float isotropy, const Point<D>& base) {
  const Point<D> corner = floor(p), local = p - corner;
  Phasor sum;
  for (int n = 0; n < Neighbours<D, 1>::kCount; n++) {
    const Offset<D> offset = Neighbours<D, 1>::offset(n);
    Point<D> cell, from, gap;
    for (int d = 0; d < D; d++) {
      const auto o = static_cast<float>(offset[d]);
      cell[d] = corner[d] + o;
      from[d] = local[d] - o;
      gap[d] = offset[d] < 0 ? local[d] : offset[d] > 0 ? 1 - local[d] : 0;
    }
    if (dot(gap, gap) >= 1) continue;  // the whole cell is out of reach
    const auto key = [&cell](int i, int k) { return append(cell, static_cast<float>(3 * i + k)); };
    std::array<std::array<float, kKernels>, D> ways;  // to p from the kernels' centres
    std::array<float, kKernels> squares{};
    for (int i = 0; i < kKernels; i++) {
      const std::array<float, D> center = units<D>(key(i, 1));
      for (int d = 0; d < D; d++) {
        ways[d][i] = from[d] - center[d];
        squares[i] += ways[d][i] * ways[d][i];
      }
    }
    for (int i = 0; i < kKernels; i++) {
      const float r2 = squares[i];
      if (r2 >= 1) continue;
      const float sign = hashToUnit(key(i, 2)) < 0.5f ? -1 : 1;
      const float envelope = sign * std::exp(-kPiF * r2) * (0.5f + 0.5f * std::cos(kPiF * r2));
      const float angle = 2 * kPiF * dot(nth<D>(ways, i), direction(base, isotropy, key(i, 0)) * frequency);
      sum.re += envelope * std::cos(angle);
      sum.im += envelope * std::sin(angle);
    }
  }
  return sum;
}

}  // namespace

GaborValue gabor(int dimensions, const GaborInputs& in, Vec3f p) {
  const float isotropy = 1 - limit(in.anisotropy, 0, 1);
  const float frequency = limit(in.frequency, 0.001f, 3.4e38f);
  const Vec3f q = p * in.scale;
  Phasor z;
  // The integral of the squared kernel, as if there were no window and the frequency infinite.
  float square = 0.25f;
  if (dimensions == 2) {
    const float angle = in.orientation2d;
    z = sumOfKernels(Point<2>{{q.x, q.y}}, frequency, isotropy, Point<2>{{std::cos(angle), std::sin(angle)}});
  } else {
    const Vec3f o = in.orientation3d / length(in.orientation3d);
    z = sumOfKernels(Point<3>{{q.x, q.y, q.z}}, frequency, isotropy, Point<3>{{o.x, o.y, o.z}});
    square = 0.1767766953f;
  }
  const float full = 6 * std::sqrt(kKernels * 0.5f * square);  // standard deviations, of which half the signs' share
  return {z.im / full * 0.5f + 0.5f, (std::atan2(z.im, z.re) + kPiF) / (2 * kPiF),
          std::sqrt(z.re * z.re + z.im * z.im) / full};
}

}  // namespace wardmis::pattern
