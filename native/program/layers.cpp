// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/layers.h"

#include "program/surface.h"

namespace wardmis {

Rgb belowLayers(const ShadingContext& c, Principled layers, Vec3f normal, Vec3f coatNormal) {
  for (float* v : {&layers.coatWeight, &layers.coatRoughness, &layers.coatIor, &layers.sheenWeight,
                   &layers.sheenRoughness, &layers.coatTint.x, &layers.coatTint.y, &layers.coatTint.z,
                   &layers.sheenTint.x, &layers.sheenTint.y, &layers.sheenTint.z})
    if (!std::isfinite(*v)) *v = 0;
  const auto cosine = [&](Vec3f v) {
    const float l = length(v), d = dot(c.incoming, v) / l;
    return l > 0 && std::isfinite(d) ? std::clamp(d, -1.0f, 1.0f) : dot(c.incoming, c.normal);
  };
  const float share = std::clamp(layers.coatWeight, 0.0f, 1.0f);
  const Vec3f coat = c.onCurve ? coatNormal : surface::visiblyReflecting(4, c.trueNormal, c.incoming, coatNormal);
  const float base = cosine(normal), sheen = cosine(normal * (1 - share) + coatNormal * share);
  return expand(layers, {1, 1, 1}, {base, cosine(coat), sheen, base}, [](const Lobe&) {});
}

}  // namespace wardmis
