// SPDX-License-Identifier: GPL-3.0-or-later
#include "bsdf/batch.h"

#include "math/clones.h"

namespace wardmis {

WARDMIS_CLONES
void wardBatch(WardVariant variant, const WardArrays<float>& arrays, Vec3<float> wo, float invAx, float invAy) {
  wardLoop(variant, arrays, wo, invAx, invAy);
}

void wardBatch(WardVariant variant, const WardArrays<double>& arrays, Vec3<double> wo, double invAx, double invAy) {
  wardLoop(variant, arrays, wo, invAx, invAy);
}

}  // namespace wardmis
