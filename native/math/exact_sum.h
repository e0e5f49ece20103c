// SPDX-License-Identifier: GPL-3.0-or-later
// Sums that are the same to the bit in whatever order, and in whatever parts, they are made.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace wardmis {

// Of C numbers each (Demmel and Nguyen 2015, "Parallel reproducible summation"). What is added is cut at fixed powers
// of two, 2^28 apart, into multiples of these. Sums are kept of two cuts, the highest that the largest number so far
// needs and the next: exact ones, for up to 2^24 numbers. What is dropped, less than 2^-29 of the largest, depends on
// the numbers alone. These are finite and below 2^950.
template <size_t C>
class ExactSum {
 public:
  ExactSum() { bound_.fill(kLeast); }

  void add(const std::array<double, C>& x) {
    bool below = true;
    for (size_t i = 0; i < C; ++i) below &= exponentOf(x[i]) < bound_[i];
    if (!below) [[unlikely]]
      for (size_t i = 0; i < C; ++i)
        if (exponentOf(x[i]) >= bound_[i]) raise(i, boundAbove(exponentOf(x[i])));
    for (size_t i = 0; i < C; ++i) {
      const double high = roundedBy(x[i], bound_[i]);
      high_[i] += high;
      low_[i] += roundedBy(x[i] - high, bound_[i] - kBits);
    }
  }
  ExactSum& operator+=(ExactSum b) {
    for (size_t i = 0; i < C; ++i) {
      const int bound = std::max(bound_[i], b.bound_[i]);
      raise(i, bound), b.raise(i, bound);
      high_[i] += b.high_[i], low_[i] += b.low_[i];
    }
    return *this;
  }
  double operator[](size_t i) const { return high_[i] + low_[i]; }
  bool operator==(const ExactSum&) const = default;

 private:
  // Bounds are exponents, as a double's bits have them: of the powers of two that numbers are below, of every 28th.
  static constexpr int kBits = 28, kMantissa = 52, kLeast = 42;

  static int exponentOf(double x) { return static_cast<int>(std::bit_cast<uint64_t>(x) >> kMantissa & 0x7ffu); }
  static int boundAbove(int exponent) { return (exponent - kLeast) / kBits * kBits + kBits + kLeast; }
  // A number below the bound, rounded to a multiple of 2^-27 of it: 1.5 times a power of two takes the bits below it.
  static double roundedBy(double x, int bound) {
    constexpr uint64_t kHalf = uint64_t{1} << (kMantissa - 1);
    const auto large = std::bit_cast<double>(static_cast<uint64_t>(bound + kMantissa - kBits + 1) << kMantissa | kHalf);
    return (x + large) - large;
  }
  void raise(size_t i, int bound) {
    if (bound == bound_[i]) return;
    low_[i] = bound - kBits == bound_[i] ? high_[i] : 0;
    high_[i] = 0;
    bound_[i] = static_cast<int16_t>(bound);
  }

  std::array<double, C> high_{}, low_{};
  std::array<int16_t, C> bound_;
  std::array<int16_t, (4 - C % 4) % 4> rest_{};  // that no byte is without a value: sums are written as they are
};

// The same of numbers about 1, of which multiples of 2^-24 do: exact while they add up to less than 2^28.
template <size_t C>
class UnitSum {
 public:
  void add(const std::array<double, C>& x) {
    for (size_t i = 0; i < C; ++i) sum_[i] += (x[i] + kRound) - kRound;
  }
  UnitSum& operator+=(const UnitSum& b) {
    for (size_t i = 0; i < C; ++i) sum_[i] += b.sum_[i];
    return *this;
  }
  double operator[](size_t i) const { return sum_[i]; }
  bool operator==(const UnitSum&) const = default;

 private:
  static constexpr double kRound = 0x1.8p28;

  std::array<double, C> sum_{};
};

}  // namespace wardmis
