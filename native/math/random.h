// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers: a number depends on its keys alone (seed, pixel, dimension, index), never on who asks
// for it or when, so that an image does not depend on threads, tiles or passes.
#pragma once

#include <cstdint>

#include "math/vec.h"

namespace wardmis {

// A 32-bit mixing function with low bias (Wellons 2018, "lowbias32").
constexpr uint32_t mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x21f0aaadu;
  x ^= x >> 15;
  x *= 0xd35a2d97u;
  x ^= x >> 15;
  return x;
}
constexpr uint32_t combine(uint32_t key, uint32_t value) { return mix(key ^ (value * 0x9e3779b9u + 0x85ebca6bu)); }

// Bits to [0, 1): a multiple of 2^-24, so that 1 - u is exact.
constexpr float toUnit(uint32_t bits) { return static_cast<float>(bits >> 8) * 0x1p-24f; }

// A point of which x has 53 bits: enough to choose one of millions by it and to place a point on what was chosen by the
// rest. With the 24 bits of a float a choice among 2^21 would leave three for all that follows.
struct ChoicePoint {
  double x;
  float y;
};
// 64 bits to [0, 1): a multiple of 2^-53.
constexpr double toUnit(uint32_t high, uint32_t low) {
  return static_cast<double>(uint64_t{high} << 21 | low >> 11) * 0x1p-53;
}
// What is left of a choice, as a coordinate.
constexpr float toCoordinate(double u) { return std::min(static_cast<float>(u), 0x1.fffffep-1f); }

// The point of a jittered cell; (cell + jitter) may round up to the next cell, but never to 1.
constexpr float inCell(uint32_t cell, float jitter, uint32_t cells) {
  return std::min((static_cast<float>(cell) + jitter) / static_cast<float>(cells), 0x1.fffffep-1f);
}
constexpr double inCell(uint32_t cell, double jitter, uint32_t cells) {
  return std::min((cell + jitter) / cells, 0x1.fffffffffffffp-1);
}

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

// Owen's nested uniform scramble of a number given with its bits reversed (Laine and Karras 2011, constants of Vegdahl
// 2021).
constexpr uint32_t owenScrambleReversed(uint32_t x, uint32_t seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// Second dimension of Sobol's sequence, bits reversed: the Pascal matrix modulo 2 applied to the index.
constexpr uint32_t sobol1Reversed(uint32_t i) {
  i ^= (i >> 1) & 0x55555555u;
  i ^= (i >> 2) & 0x33333333u;
  i ^= (i >> 4) & 0x0f0f0f0fu;
  i ^= (i >> 8) & 0x00ff00ffu;
  i ^= (i >> 16) & 0x0000ffffu;
  return i;
}

// A stream of 53-bit numbers for studies without pixels (Steele, Lea and Flood 2014, "SplitMix"): as many streams as
// there are keys, so that trials do not depend on threads.
class Stream {
 public:
  Stream(uint64_t seed, uint64_t key) : state_(scramble(seed) ^ scramble(key * 0x9e3779b97f4a7c15ull + 1)) {}
  double uniform() {  // [0, 1)
    state_ += 0x9e3779b97f4a7c15ull;
    return static_cast<double>(scramble(state_) >> 11) * 0x1p-53;
  }
  Vec2<double> square() {
    const double x = uniform();
    return {x, uniform()};
  }

 private:
  static constexpr uint64_t scramble(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  uint64_t state_;
};

enum class SamplerType : uint8_t { kIndependent, kStratified, kSobol };

// Points in the unit square for one pixel. `dimension` names the use (see Dimension in integrate/), `index` counts the
// points of that use within the pixel.
class Sampler {
 public:
  // block: number of points that the stratified sampler spreads over its strata (the expected count of one use).
  Sampler(SamplerType type, uint64_t seed, uint32_t block)
      : type_(type),
        seed_(mix(static_cast<uint32_t>(seed)) ^ mix(static_cast<uint32_t>(seed >> 32) + 0x9e3779b9u)),
        block_(block < 1 ? 1 : block) {
    columns_ = static_cast<uint32_t>(std::sqrt(static_cast<double>(block_)));
    rows_ = (block_ + columns_ - 1) / columns_;
  }
  uint32_t pixelKey(uint32_t x, uint32_t y) const { return combine(combine(seed_, x), y); }

  Vec2f get2D(uint32_t pixelKey, uint32_t dimension, uint32_t index) const {
    return get<Vec2f>(pixelKey, dimension, index);
  }

  // The same point, with more bits in x.
  ChoicePoint getChoice(uint32_t pixelKey, uint32_t dimension, uint32_t index) const {
    return get<ChoicePoint>(pixelKey, dimension, index);
  }

  float get1D(uint32_t pixelKey, uint32_t dimension, uint32_t index) const {
    if (type_ == SamplerType::kSobol) return spread1D(pixelKey, dimension, index);
    const uint32_t key = combine(pixelKey, dimension);
    const float jitter = toUnit(combine(key, index));
    if (type_ == SamplerType::kIndependent) return jitter;
    const uint32_t cell = permute(index % block_, block_, combine(key ^ 0x02e5be93u, index / block_));
    return inCell(cell, jitter, block_);
  }

  // Evenly spread over the indices, whatever the sampler: the scrambled van der Corput sequence.
  static float spread1D(uint32_t pixelKey, uint32_t dimension, uint32_t index) {
    const uint32_t key = combine(pixelKey, dimension);
    const uint32_t i = reverseBits(owenScrambleReversed(reverseBits(index), key));
    return toUnit(reverseBits(owenScrambleReversed(i, mix(key ^ 0xa511e9b3u))));
  }

  // A random permutation of 0..n-1, evaluated at i (Kensler 2013, "Correlated multi-jittered sampling", listing 3;
  // there i + p may pass 2^32, and then two images coincide).
  static uint32_t permute(uint32_t i, uint32_t n, uint32_t p) {
    uint32_t w = n - 1;
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    do {
      i ^= p;
      i *= 0xe170893du;
      i ^= p >> 16;
      i ^= (i & w) >> 4;
      i ^= p >> 8;
      i *= 0x0929eb3fu;
      i ^= p >> 23;
      i ^= (i & w) >> 1;
      i *= 1 | p >> 27;
      i *= 0x6935fa69u;
      i ^= (i & w) >> 11;
      i *= 0x74dcb303u;
      i ^= (i & w) >> 2;
      i *= 0x9e501cc3u;
      i ^= (i & w) >> 2;
      i *= 0xc860a3dfu;
      i &= w;
      i ^= i >> 5;
    } while (i >= n);
    return (i + p % n) % n;
  }

 private:
  template <class Point>
  Point get(uint32_t pixelKey, uint32_t dimension, uint32_t index) const {
    using X = decltype(Point::x);
    const uint32_t key = combine(pixelKey, dimension);
    const auto x = [&](uint32_t bits) -> X {
      if constexpr (sizeof(X) == sizeof(double))
        return toUnit(bits, combine(mix(key + 0x7feb352du), index));  // bits of their own below the sequence's 32
      else
        return toUnit(bits);
    };
    if (type_ == SamplerType::kSobol) {
      // Burley 2020: shuffle the order, then scramble each coordinate of the (0,2)-sequence
      const uint32_t i = reverseBits(owenScrambleReversed(reverseBits(index), key));
      return {x(reverseBits(owenScrambleReversed(i, mix(key ^ 0xa511e9b3u)))),
              toUnit(reverseBits(owenScrambleReversed(sobol1Reversed(i), mix(key ^ 0x63d83595u))))};
    }
    const uint32_t h = combine(key, index);
    const Point jitter{x(h), toUnit(mix(h ^ 0x68bc21ebu))};
    if (type_ == SamplerType::kIndependent) return jitter;
    // jittered cells in random order; a new order for each block
    const uint32_t cells = columns_ * rows_;
    const uint32_t cell = permute(index % cells, cells, combine(key ^ 0x02e5be93u, index / cells));
    return {inCell(cell % columns_, jitter.x, columns_), inCell(cell / columns_, jitter.y, rows_)};
  }

  SamplerType type_;
  uint32_t seed_;
  uint32_t block_, columns_ = 1, rows_ = 1;
};

}  // namespace wardmis
