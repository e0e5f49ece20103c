// SPDX-License-Identifier: GPL-3.0-or-later
// Ward at many directions wi under one wo: structure of arrays, so that evaluation is one vectorised loop.
#pragma once

#include "bsdf/ward.h"

namespace wardmis {

// Directions of the samples at one hit, and what each lobe of the surface says of them. Local frame; densities per
// solid angle.
template <class T, size_t Lobes, int Capacity>
struct LobeBatch {
  T x[Capacity], y[Capacity], z[Capacity];  // wi
  T fCos[Lobes][Capacity];                  // f cos for a weight of 1
  T pdf[Lobes][Capacity];

  Vec3<T> wi(int j) const { return {x[j], y[j], z[j]}; }
  void set(int j, Vec3<T> wi) { x[j] = wi.x, y[j] = wi.y, z[j] = wi.z; }
  WardValue<T> value(size_t lobe, int j) const { return {fCos[lobe][j], pdf[lobe][j]}; }
};

// n directions, and where to put wardEvaluate() of them. The arrays do not overlap.
template <class T>
struct WardArrays {
  int n;
  const T *x, *y, *z;
  T *fCos, *pdf;
};

// The loop, for the instructions of whoever it is inlined into.
template <WardVariant V, class T>
inline void wardLoop(const WardArrays<T> &arrays, Vec3<T> wo, T invAx, T invAy) {
  const T *__restrict x = arrays.x, *__restrict y = arrays.y, *__restrict z = arrays.z;
  T *__restrict fCos = arrays.fCos, *__restrict pdf = arrays.pdf;
  for (int j = 0; j < arrays.n; ++j) {
    const WardValue<T> w = wardEvaluate<V>({x[j], y[j], z[j]}, wo, invAx, invAy);
    fCos[j] = w.fCos;
    pdf[j] = w.pdf;
  }
}
template <class T>
inline void wardLoop(WardVariant variant, const WardArrays<T> &arrays, Vec3<T> wo, T invAx, T invAy) {
  switch (variant) {
    case WardVariant::kWard:
      return wardLoop<WardVariant::kWard>(arrays, wo, invAx, invAy);
    case WardVariant::kWardDur:
      return wardLoop<WardVariant::kWardDur>(arrays, wo, invAx, invAy);
    case WardVariant::kWardGmd:
      return wardLoop<WardVariant::kWardGmd>(arrays, wo, invAx, invAy);
  }
}

// The loop in the widest vectors of this processor (math/clones.h); the bits are the same in all of them, and those of
// wardEvaluate(). In double, whose exp is the standard library's, it is a plain loop.
void wardBatch(WardVariant variant, const WardArrays<float> &arrays, Vec3<float> wo, float invAx, float invAy);
void wardBatch(WardVariant variant, const WardArrays<double> &arrays, Vec3<double> wo, double invAx, double invAy);

}  // namespace wardmis
