// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/terminator.h"

#include "integrate/interaction.h"
#include "program/arithmetic.h"

namespace wardmis {

Vec3f shadowOffset(const Geometry& geometry, const Placement& placement, const SmoothFace& face, Vec3f side,
                   float time) {
  const Shape& shape = geometry.shapes[face.shape];
  const uint32_t* i = shape.indices + 3 * size_t{face.triangle};
  const Corners p = cornersOf(shape, face.triangle, time);
  std::array<Vec3f, 3> n;  // where the corners are
  for (size_t k = 0; k < 3; ++k) {
    const Vec3f own = detail::movedNormal(shape, i, k == 1 ? 1 : 0, k == 2 ? 1 : 0, time);
    n[k] = safeNormalize(placement.flat ? placement.toWorld.normal(own) : own);
  }
  const float u = 1 - face.u - face.v, v = face.u, w = face.v;
  const Vec3f at = p[0] * u + p[1] * v + p[2] * w, mean = n[0] * u + n[1] * v + n[2] * w;
  const Vec3f along = placement.flat ? mean : placement.toWorld.vector(mean);

  // the parabola through the corners that is upright to their normals
  const float a = dot(n[2] - n[0], p[0] - p[2]), b = dot(n[2] - n[1], p[1] - p[2]), c = dot(n[1] - n[0], p[1] - p[0]);
  const float parabola = 0.5f * (a * u * (u - 1) + (a + b + c) * u * v + b * v * (v - 1));
  // and the corners' tangent planes, raised until none cuts the triangle; those of the other side from below
  const float s = dot(along, side) > 0 ? 1.0f : -1.0f;
  float least = 0;
  for (size_t k = 0; k < 3; ++k) {
    const Vec3f next = p[(k + 1) % 3] - p[k], last = p[(k + 2) % 3] - p[k];
    const float raised = std::max({s * dot(next, n[k]), s * dot(last, n[k]), 0.0f});
    const float height = std::max(s * dot(p[k] - at, n[k]) + raised, 0.0f);
    least = k == 0 ? height : std::min(least, height);
  }
  return along * (s * std::max(least, s * parabola));
}

}  // namespace wardmis
