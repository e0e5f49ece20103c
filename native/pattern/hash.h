// SPDX-License-Identifier: GPL-3.0-or-later
// The hash functions below all patterns: Jenkins's lookup3 (2006) of the bits of one to four numbers, and the PCG
// hashes of Jarzynski and Olano ("Hash Functions for GPU Rendering", JCGT 9(3), 2020), on integers.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "pattern/point.h"

namespace wardmis::pattern {

// lookup3 of N words, N = 1 to 4: the last of the three words of state.
template <size_t N>
constexpr uint32_t jenkins(const std::array<uint32_t, N>& key) {
  static_assert(N >= 1 && N <= 4);
  constexpr auto rot = [](uint32_t x, int k) { return std::rotl(x, k); };
  const auto word = [&](size_t i) { return i < N ? key[i] : 0; };
  const uint32_t start = 0xdeadbeefu + (static_cast<uint32_t>(N) << 2) + 13;
  uint32_t a = start + word(0), b = start + word(1), c = start + word(2);
  if constexpr (N == 4) {  // "mix"
    a = (a - c) ^ rot(c, 4), c += b;
    b = (b - a) ^ rot(a, 6), a += c;
    c = (c - b) ^ rot(b, 8), b += a;
    a = (a - c) ^ rot(c, 16), c += b;
    b = (b - a) ^ rot(a, 19), a += c;
    c = (c - b) ^ rot(b, 4), b += a;
    a += key[3];
  }
  c = (c ^ b) - rot(b, 14);  // "final"
  a = (a ^ c) - rot(c, 11);
  b = (b ^ a) - rot(a, 25);
  c = (c ^ b) - rot(b, 16);
  a = (a ^ c) - rot(c, 4);
  b = (b ^ a) - rot(a, 14);
  return (c ^ b) - rot(b, 24);
}

// The numbers of p, by their bits (so that 0 and -0 differ), to [0, 1].
template <int D>
constexpr float hashToUnit(const Point<D>& p) {
  std::array<uint32_t, D> key{};
  for (int d = 0; d < D; d++) key[d] = std::bit_cast<uint32_t>(p[d]);
  return static_cast<float>(jenkins(key)) * (1 / static_cast<float>(0xffffffffu));
}

// C numbers in [0, 1] of one point: its own hash, then those of the point with 1, 2, ... as one more coordinate. Of
// four coordinates, which leave no room for another, the order changes instead.
template <int C, int D>
constexpr std::array<float, C> hashToUnits(const Point<D>& p) {
  std::array<float, C> r{hashToUnit(p)};
  if constexpr (D < 4) {
    for (int i = 1; i < C; i++) r[i] = hashToUnit(append(p, static_cast<float>(i)));
  } else {
    const auto [x, y, z, w] = p.v;
    if constexpr (C == 4) {
      r[1] = hashToUnit(Point<4>{{w, x, y, z}});
      r[2] = hashToUnit(Point<4>{{z, w, x, y}});
      r[3] = hashToUnit(Point<4>{{y, z, w, x}});
    } else {
      if constexpr (C > 1) r[1] = hashToUnit(Point<4>{{z, x, w, y}});
      if constexpr (C > 2) r[2] = hashToUnit(Point<4>{{w, z, y, x}});
    }
  }
  return r;
}
template <int D>
constexpr Rgb hashToColor(const Point<D>& p) {
  const auto [r, g, b] = hashToUnits<3>(p);
  return {r, g, b};
}

// pcg2d, pcg3d and pcg4d, with the shift of signed numbers that Cycles has: D numbers in [0, 1].
template <size_t D>
constexpr std::array<float, D> pcgToUnits(const std::array<int, D>& key) {
  static_assert(D >= 2 && D <= 4);
  std::array<uint32_t, D> v{};
  for (size_t d = 0; d < D; d++) v[d] = static_cast<uint32_t>(key[d]) * 1664525u + 1013904223u;
  const auto stir = [&v] {
    if constexpr (D == 2) {
      v[0] += v[1] * 1664525u;
      v[1] += v[0] * 1664525u;
    } else if constexpr (D == 3) {
      v[0] += v[1] * v[2];
      v[1] += v[2] * v[0];
      v[2] += v[0] * v[1];
    } else {
      v[0] += v[1] * v[3];
      v[1] += v[2] * v[0];
      v[2] += v[0] * v[1];
      v[3] += v[1] * v[2];
    }
  };
  stir();
  for (uint32_t& x : v) x ^= static_cast<uint32_t>(static_cast<int32_t>(x) >> 16);
  stir();
  std::array<float, D> r{};
  for (size_t d = 0; d < D; d++) {
    r[d] = static_cast<float>(static_cast<int32_t>(v[d] & 0x7fffffffu)) * (1 / static_cast<float>(0x7fffffff));
  }
  return r;
}

}  // namespace wardmis::pattern
