// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/interaction.h"

namespace wardmis::detail {

void resolve(const Scene& scene, const Material& m, const ShadedPoint& point, Vec2f uv, Interaction& x, Vec3f& normal) {
  Slots slots;
  runProgram(scene, point, slots);
  const Program& program = *m.program;
  const auto color = [&](const ColorInput& c) {
    return c.result >= 0 ? c.value * vectorOf(program, slots, c.result) : evaluate(scene, c, uv);
  };
  const auto reflectance = [&](const ColorInput& c) {
    const Rgb v = color(c);
    return Rgb{std::max(v.x, 0.0f), std::max(v.y, 0.0f), std::max(v.z, 0.0f)};
  };
  const auto alpha = [&](const ScalarInput& c) {
    return c.result >= 0 ? clampedAlpha(c.value * numberOf(program, slots, c.result)) : evaluateAlpha(scene, c, uv);
  };
  x.surface.diffuse = reflectance(m.diffuse);
  x.surface.specular = reflectance(m.specular);
  x.surface.ax = alpha(m.alphaX);
  x.surface.ay = alpha(m.alphaY);
  x.emission = color(m.emission);
  if (m.normal < 0) return;
  const Vec3f n = vectorOf(program, slots, m.normal);
  const float l = length(n);
  if (l > 0) normal = bent(n / l, point.geometric, point.wo);
}

}  // namespace wardmis::detail
