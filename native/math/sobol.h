// SPDX-License-Identifier: GPL-3.0-or-later
// Sobol's sequence, five dimensions of it, and Owen's scrambling. All numbers have their bits reversed: the most
// significant one is the lowest.
#pragma once

#include <array>
#include <cstdint>

namespace wardmis {

constexpr uint32_t reverseBits(uint32_t x) {
#if defined(__clang__)
  return __builtin_bitreverse32(x);
#else
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
#endif
}

// Owen's nested uniform scramble (Laine and Karras 2011, constants of Vegdahl
// 2021).
constexpr uint32_t owenScrambleReversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Its second dimension: the Pascal matrix modulo 2 applied to the index. The first is the index itself.
constexpr uint32_t sobol1(uint32_t i) {
  i ^= (i >> 1) & 0x55555555u;
  i ^= (i >> 2) & 0x33333333u;
  i ^= (i >> 4) & 0x0f0f0f0fu;
  i ^= (i >> 8) & 0x00ff00ffu;
  i ^= (i >> 16) & 0x0000ffffu;
  return i;
}

// A further dimension: the sum modulo 2 of the directions of the index's bits, taken eight at a time from tables. From
// its primitive polynomial (degree, and the coefficients between the first and the last) and first direction numbers
// (Joe and Kuo 2008, "Constructing Sobol sequences with better two-dimensional projections").
class SobolDimension {
 public:
  constexpr SobolDimension(uint32_t degree, uint32_t coefficients, const std::array<uint32_t, 3>& first) {
    std::array<uint32_t, 32> m{}, direction{};
    for (uint32_t k = 0; k < 32; ++k) {
      if (k < degree) {
        m[k] = first[k];
      } else {
        m[k] = m[k - degree] ^ m[k - degree] << degree;
        for (uint32_t i = 1; i < degree; ++i)
          if ((coefficients >> (degree - 1 - i) & 1u) != 0) m[k] ^= m[k - i] << i;
      }
      direction[k] = reverseBits(m[k] << (31 - k));
    }
    for (uint32_t byte = 0; byte < 4; ++byte)
      for (uint32_t value = 0; value < 256; ++value)
        for (uint32_t bit = 0; bit < 8; ++bit)
          if ((value >> bit & 1u) != 0) table_[byte][value] ^= direction[8 * byte + bit];
  }
  constexpr uint32_t operator()(uint32_t i) const {
    return table_[0][i & 255u] ^ table_[1][i >> 8 & 255u] ^ table_[2][i >> 16 & 255u] ^ table_[3][i >> 24];
  }

 private:
  std::array<std::array<uint32_t, 256>, 4> table_{};
};
inline constexpr SobolDimension kSobol2(2, 1, {1, 3}), kSobol3(3, 1, {1, 3, 1}), kSobol4(3, 2, {1, 1, 1});

}  // namespace wardmis
