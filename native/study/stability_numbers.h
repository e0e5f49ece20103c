// SPDX-License-Identifier: GPL-3.0-or-later
// f, pdf and sampling weight in one number type against long double, at directions of every kind, denormal and exactly
// grazing ones included; and the counts of what should not occur.
#pragma once

#include <array>
#include <functional>

#include "bsdf/ward.h"
#include "math/random.h"

namespace wardmis {

// The renderer's functions in one number type.
template <class T>
struct WardFunctions {
  std::function<WardValue<T>(WardVariant, Vec3<T> wi, Vec3<T> wo, T ax, T ay)> evaluate;
  std::function<Vec3<T>(Vec3<T> wo, T ax, T ay, Vec2<T> u)> sample;
  std::function<T(WardVariant, Vec3<T> wi, Vec3<T> wo)> weight;

  static WardFunctions own() {
    return {[](WardVariant v, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
              return wardEvaluate<T>(v, wi, wo, T(1) / ax, T(1) / ay);
            },
            wardSample<T>, wardWeight<T>};
  }
};

struct NumberErrors {
  uint64_t values = 0, nan = 0, infinite = 0, negative = 0;  // infinite: where the exact value is finite
  // Right, and counted all the same: zero or denormal where the exact value is smaller than a normal number, or e^-E
  // is; infinite where it, or the density, is larger than the largest.
  uint64_t underflow = 0, overflow = 0;
  // The largest error of f, pdf, weight: relative, where nothing underflows, and in units of its bound, everywhere.
  std::array<double, 3> relative{}, bounds{};

  double worstRelative() const { return std::max({relative[0], relative[1], relative[2]}); }
  double worstBounds() const { return std::max({bounds[0], bounds[1], bounds[2]}); }
};

// At `count` directions drawn from each technique and some special ones; wo is rounded to T, but for its z.
template <class T>
NumberErrors measureErrors(const WardFunctions<T>& tested, WardVariant variant, Vec3<double> wo, double ax, double ay,
                           int count, Stream random);

extern template NumberErrors measureErrors(const WardFunctions<float>&, WardVariant, Vec3<double>, double, double, int,
                                           Stream);
extern template NumberErrors measureErrors(const WardFunctions<double>&, WardVariant, Vec3<double>, double, double, int,
                                           Stream);

}  // namespace wardmis
