// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability_numbers.h"

#include <limits>
#include <vector>

#include "math/warp.h"

namespace wardmis {

namespace {

using Extended = long double;

template <class T>
Vec3<Extended> extend(Vec3<T> v) {
  return {v.x, v.y, v.z};
}

template <class T>
std::vector<Vec3<T>> directions(const WardFunctions<T>& tested, Vec3<T> wo, T ax, T ay, int count, Stream& random) {
  const auto number = [&] { return T(std::floor(random.uniform() * 0x1p24) * 0x1p-24); };  // as the renderer's
  std::vector<Vec3<T>> list;
  for (int i = 0; i < count; ++i) {
    const T x = number(), y = number();
    list.push_back(tested.sample(wo, ax, ay, {x, y}));
    list.push_back(toCosineHemisphere<T>({y, x}));
  }
  constexpr T last = T(0x1.fffffep-1);
  for (T x : {T(0), last})
    for (T y : {T(0), T(0.25), last}) list.push_back(tested.sample(wo, ax, ay, {x, y}));
  const T s = std::hypot(wo.x, wo.y), ox = s > 0 ? wo.x / s : T(1), oy = s > 0 ? wo.y / s : T(0);
  list.push_back({0, 0, 1});
  list.push_back(wo);                    // back
  list.push_back({-wo.x, -wo.y, wo.z});  // mirror
  using Limits = std::numeric_limits<T>;
  for (T z :
       {T(0), -T(0), Limits::denorm_min(), Limits::min() / 4, Limits::min(), T(1e-30), T(1e-12), Limits::epsilon()})
    for (int sign : {-1, 1}) {
      list.push_back({T(sign) * ox, T(sign) * oy, z});   // forward, backward
      list.push_back({T(sign) * oy, T(-sign) * ox, z});  // across
    }
  return list;
}

}  // namespace

template <class T>
NumberErrors measureErrors(const WardFunctions<T>& tested, WardVariant variant, Vec3<double> exactWo, double ax,
                           double ay, int count, Stream random) {
  using Limits = std::numeric_limits<T>;
  constexpr Extended eps = Limits::epsilon(), smallest = Limits::min(), largest = Limits::max();
  const Extended vanishing = -std::log(Extended(smallest));  // E at which e^-E leaves the normal numbers
  const Vec3<T> wo{T(exactWo.x), T(exactWo.y), T(exactWo.z)};
  const T tx = T(ax), ty = T(ay);
  NumberErrors errors;
  bool beyond = false;  // the density is no T, and f_s cos need not be one either
  const auto judge = [&](size_t what, T value, Extended exact, Extended e, Extended roundings) {
    ++errors.values;
    if (std::isnan(value)) return void(++errors.nan);
    if (value < 0) return void(++errors.negative);
    // of values about the largest number, either is right
    if (beyond || exact > largest * (1 - roundings * eps)) return void(++errors.overflow);
    if (std::isinf(value)) return void(++errors.infinite);
    // where e^-E or the value is denormal, an error of the smallest normal number, times what stands before e^-E
    const bool under = e > vanishing - 1 || exact < smallest;
    const Extended slack =
        !under ? 0 : 2 * smallest * (exact > 0 ? std::max(Extended(1), std::exp(std::log(exact) + e)) : 1);
    if (exact > 0 && Extended(value) < smallest) ++errors.underflow;
    if (!(exact > 0)) {  // also e^-E, in long double
      if (Extended(value) > slack) errors.bounds[what] = std::numeric_limits<double>::infinity();
      return;
    }
    const Extended error = std::abs(Extended(value) - exact) / exact;
    if (!under) errors.relative[what] = std::max(errors.relative[what], double(error));
    errors.bounds[what] =
        std::max(errors.bounds[what], double(std::max(Extended(0), error - slack / exact) / (roundings * eps)));
  };
  for (const Vec3<T>& wi : directions(tested, wo, tx, ty, count, random)) {
    const WardValue<T> value = tested.evaluate(variant, wi, wo, tx, ty);
    const Vec3<Extended> i = extend(wi), o = extend(wo);
    const bool above = i.z > 0 && o.z > 0;
    const WardValue<Extended> exact = wardEvaluate<Extended>(variant, i, o, 1 / Extended(tx), 1 / Extended(ty));
    const Extended hz = i.z + o.z;
    const Extended e = above ? square((i.x + o.x) / hz / Extended(tx)) + square((i.y + o.y) / hz / Extended(ty)) : 0;
    const Extended roundings = 12 + 8 * std::min(e, Extended(1e6));
    // a cosine so small that its share of h_z is denormal, with the digits that it then has
    const Extended share = above ? i.z / hz : 1,
                   digits = share < smallest ? Limits::denorm_min() / share / eps : Extended(0);
    beyond = exact.pdf > largest * (1 - roundings * eps);
    judge(0, value.fCos, exact.fCos, e, roundings + digits);
    judge(1, value.pdf, exact.pdf, e, roundings);
    beyond = false;
    // the weight is asked for at samples: where the density is a number
    if (!above || exact.pdf > smallest)
      judge(2, tested.weight(variant, wi, wo), wardWeight<Extended>(variant, i, o), 0, 8 + digits);
  }
  return errors;
}

template NumberErrors measureErrors(const WardFunctions<float>&, WardVariant, Vec3<double>, double, double, int,
                                    Stream);
template NumberErrors measureErrors(const WardFunctions<double>&, WardVariant, Vec3<double>, double, double, int,
                                    Stream);

}  // namespace wardmis
