// SPDX-License-Identifier: GPL-3.0-or-later
// Counter-based random numbers: a number depends on its keys alone (seed, pixel, dimension, index), never on who asks
// for it or when, so that an image does not depend on threads, tiles or passes.
#pragma once

#include <cstdint>

#include "math/sobol.h"
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

// Points in the unit square for one pixel. `dimension` names the use (see Dimensions in integrate/), `index` counts the
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
    return toUnit(reverseBits(owenScrambleReversed(shuffled(key, index), mix(key ^ 0xa511e9b3u))));
  }

  // The numbers of one visit to a surface, and of the film point that led to it. Sobol's are dimensions of one sequence
  // in one order, each scrambled by itself: where a film point decides which surface is met, and the number for the
  // counts which technique has a point, the points are still evenly spread over those visits that have them.
  class Visit {
   public:
    // first: the first dimension of the vertex; index: of the visit, within the pixel.
    Visit(const Sampler& sampler, uint32_t pixelKey, uint32_t first, uint32_t index)
        : sampler_(sampler), pixelKey_(pixelKey), index_(index) {
      if (isSobol()) sobol0_ = shuffled(combine(pixelKey, first), index), sobol1_ = sobol1(sobol0_);
    }
    // In the pixel.
    Vec2f film(uint32_t dimension) const {
      if (!isSobol()) return sampler_.get2D(pixelKey_, dimension, index_);
      return scrambled<Vec2f>(combine(pixelKey_, dimension), index_, kSobol3(sobol0_), kSobol4(sobol0_));
    }
    // By which the samples are shared out.
    float counts(uint32_t dimension) const {
      if (!isSobol()) return spread1D(pixelKey_, dimension, index_);
      return toUnit(reverseBits(owenScrambleReversed(kSobol2(sobol0_), combine(pixelKey_, dimension))));
    }
    // The m-th point of a technique. Sobol's come in pairs of mirror images, before they are scrambled: along each axis
    // the one lies in the gaps that the other, of all visits, leaves.
    template <class Point>
    Point point(uint32_t dimension, uint32_t m) const {
      if (!isSobol()) return sampler_.get<Point>(keyOf(m), dimension, index_);
      const uint32_t mirror = (m & 1u) != 0 ? ~0u : 0;
      return scrambled<Point>(combine(keyOf(m >> 1), dimension), index_, sobol0_ ^ mirror, sobol1_ ^ mirror);
    }
    // And a number for a choice beside it.
    float choice(uint32_t dimension, uint32_t m) const { return sampler_.get1D(keyOf(m), dimension, index_); }

   private:
    bool isSobol() const { return sampler_.type_ == SamplerType::kSobol; }
    uint32_t keyOf(uint32_t m) const { return m == 0 ? pixelKey_ : combine(pixelKey_, ~m); }

    const Sampler& sampler_;
    uint32_t pixelKey_, index_, sobol0_ = 0, sobol1_ = 0;
  };

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
  // The index's place in an order of its own for each key; blocks of 2^k stay blocks.
  static uint32_t shuffled(uint32_t key, uint32_t index) {
    return reverseBits(owenScrambleReversed(reverseBits(index), key));
  }
  // Bits to the first coordinate; a double has bits of its own below these 32.
  template <class Point>
  static auto first(uint32_t key, uint32_t index, uint32_t bits) -> decltype(Point::x) {
    if constexpr (sizeof(Point::x) == sizeof(double))
      return toUnit(bits, combine(mix(key + 0x7feb352du), index));
    else
      return toUnit(bits);
  }
  // The point of two dimensions, their bits reversed.
  template <class Point>
  static Point scrambled(uint32_t key, uint32_t index, uint32_t x, uint32_t y) {
    return {first<Point>(key, index, reverseBits(owenScrambleReversed(x, mix(key ^ 0xa511e9b3u)))),
            toUnit(reverseBits(owenScrambleReversed(y, mix(key ^ 0x63d83595u))))};
  }

  template <class Point>
  Point get(uint32_t pixelKey, uint32_t dimension, uint32_t index) const {
    const uint32_t key = combine(pixelKey, dimension);
    if (type_ == SamplerType::kSobol) {  // Burley 2020: shuffle the order, then scramble each coordinate
      const uint32_t i = shuffled(key, index);
      return scrambled<Point>(key, index, i, sobol1(i));
    }
    const uint32_t h = combine(key, index);
    const Point jitter{first<Point>(key, index, h), toUnit(mix(h ^ 0x68bc21ebu))};
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
