// SPDX-License-Identifier: GPL-3.0-or-later
// The variants by name, and the textbook formulas in long double: what the renderer's own forms are compared with.
#pragma once

#include <limits>

#include "bsdf/ward.h"

namespace wardmis::test {

struct Variant {
  WardVariant type;
  const char *point, *weight, *albedo;  // keys in golden.json
};
inline constexpr Variant kVariants[] = {{WardVariant::kWard, "ward", "weight_ward", "ward"},
                                        {WardVariant::kWardDur, "ward_dur", "weight_ward_dur", "ward-dur"},
                                        {WardVariant::kWardGmd, "ward_gmd", "weight_ward_gmd", "ward-gmd"}};

template <class T>
WardValue<T> ward(WardVariant v, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  switch (v) {
    case WardVariant::kWard:
      return wardEvaluate<WardVariant::kWard>(wi, wo, T(1) / ax, T(1) / ay);
    case WardVariant::kWardDur:
      return wardEvaluate<WardVariant::kWardDur>(wi, wo, T(1) / ax, T(1) / ay);
    case WardVariant::kWardGmd:
      break;
  }
  return wardEvaluate<WardVariant::kWardGmd>(wi, wo, T(1) / ax, T(1) / ay);
}

struct Reference {
  long double e, fCos, pdf, logPdf, weight;  // the exponent E, f_s cos(theta_i), Walter's density, f_s cos/pdf
};

template <class T>
Reference reference(WardVariant v, Vec3<T> wi, Vec3<T> wo, T ax, T ay) {
  using L = long double;
  if (!(wi.z > 0) || !(wo.z > 0)) return {0, 0, 0, -std::numeric_limits<L>::infinity(), 0};
  const L x = L(wi.x) + L(wo.x), y = L(wi.y) + L(wo.y), z = L(wi.z) + L(wo.z), h2 = x * x + y * y + z * z, ci = wi.z,
          co = wo.z;
  const L e = (x / z / L(ax)) * (x / z / L(ax)) + (y / z / L(ay)) * (y / z / L(ay));
  const L k = 1 / (kPi<L> * L(ax) * L(ay));
  const L f = v == WardVariant::kWard      ? k / 4 / std::sqrt(ci * co)
              : v == WardVariant::kWardDur ? k / 4 / (ci * co)
                                           : k * h2 / (z * z * z * z);
  const L p = k * h2 / (2 * z * z * z);  // both without the exponential
  return {e, f * ci * std::exp(-e), p * std::exp(-e), std::log(p) - e, f * ci / p};
}

}  // namespace wardmis::test
