// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/strands.h"

#include <cmath>

#include "world/accel.h"

namespace wardmis {
namespace {

// A spline, or a line, through points 1 and 2 of p (0 and 1 of a line), at u in [0, 1].
Vec3f curveAt(const ControlPoint* p, bool line, float u) {
  if (line) return p[0].position + (p[1].position - p[0].position) * u;
  const float u2 = u * u, u3 = u2 * u;
  return p[0].position * (-0.5f * u3 + u2 - 0.5f * u) + p[1].position * (1.5f * u3 - 2.5f * u2 + 1) +
         p[2].position * (-1.5f * u3 + 2 * u2 + 0.5f * u) + p[3].position * (0.5f * u3 - 0.5f * u2);
}
Vec3f derivativeAt(const ControlPoint* p, bool line, float u) {
  if (line) return p[1].position - p[0].position;
  const float u2 = u * u;
  return p[0].position * (-1.5f * u2 + 2 * u - 0.5f) + p[1].position * (4.5f * u2 - 5 * u) +
         p[2].position * (-4.5f * u2 + 4 * u + 0.5f) + p[3].position * (1.5f * u2 - u);
}

Vec3f unitOr(Vec3f v, Vec3f otherwise) {
  const float l = length(v);
  return l > 0 && std::isfinite(l) ? v / l : otherwise;
}

}  // namespace

Strands::Strands(const MeshPart& part, const Primitive& primitive, const Affine* transform)
    : form(primitive.form), pieces(primitive.pieces), inside(primitive.inside) {
  const float scale = transform != nullptr ? std::cbrt(std::abs(transform->determinant())) : 1;
  const auto add = [&](uint32_t i) {
    const Vec3f p = part.positions[i];
    points.push_back({transform != nullptr ? transform->point(p) : p, part.radii[i] * scale});
  };
  const Array<uint32_t>& indices = primitive.indices;
  const bool spline = form == Form::kRibbons || form == Form::kTubes;
  first.reserve(indices.size());
  points.reserve(indices.size() + (form == Form::kSpheres ? 0 : indices.size() / 8));
  if (form != Form::kSpheres) strand.reserve(indices.size());
  uint32_t count = 0;
  for (size_t s = 0; s < indices.size(); ++s) {
    const uint32_t k = indices[s];
    if (form == Form::kSpheres) {
      first.push_back(static_cast<uint32_t>(points.size()));
      add(k);
      continue;
    }
    const bool begins = s == 0 || k != indices[s - 1] + 1;
    const bool ends = s + 1 == indices.size() || indices[s + 1] != k + 1;
    if (begins) {
      if (spline) add(k);
      add(k);
      ++count;
    }
    first.push_back(static_cast<uint32_t>(points.size()) - (spline ? 2 : 1));
    strand.push_back(count - 1);
    add(k + 1);
    if (ends && spline) add(k + 1);
  }
}

void Strands::growBox(Vec3f& lower, Vec3f& upper) const {
  const auto grow = [&](Vec3f p, float r) {
    lower = {std::min(lower.x, p.x - r), std::min(lower.y, p.y - r), std::min(lower.z, p.z - r)};
    upper = {std::max(upper.x, p.x + r), std::max(upper.y, p.y + r), std::max(upper.z, p.z + r)};
  };
  for (const ControlPoint& p : points) grow(p.position, p.radius);
  if (form != Form::kRibbons && form != Form::kTubes) return;
  for (const uint32_t f : first) {  // a spline lies within its Bezier points
    const ControlPoint* p = &points[f];
    for (const int k : {1, 2}) {
      const float sixth = k == 1 ? 1 / 6.0f : -1 / 6.0f;
      const ControlPoint &a = p[k - 1], &b = p[k + 1];
      grow(p[k].position + (b.position - a.position) * sixth, std::abs(p[k].radius + (b.radius - a.radius) * sixth));
    }
  }
}

StrandPoint strandPoint(const Placement& placement, const Shape& shape, const Ray& ray, const Hit& hit) {
  const Strands& strands = *shape.strands;
  const ControlPoint* p = &strands.points[strands.first[hit.triangle]];
  const Affine& m = placement.toWorld;
  const auto inside = [&](Vec3f v) { return placement.flat ? v : m.inverseVector(v); };
  const Vec3f wo = -ray.direction;
  StrandPoint out{ray.origin + ray.direction * hit.t, wo, wo, {0, 0, 0}, false};
  if (strands.form == Form::kSpheres) {
    const Vec3f center = placement.flat ? p->position : m.point(p->position);
    out.normal = unitOr(out.position - center, wo);  // also where the placement makes an ellipsoid of it, as in Cycles
  } else {
    const bool line = strands.form == Form::kCones;
    const Vec3f along = derivativeAt(p, line, hit.u);
    Vec3f normal;
    if (strands.form == Form::kRibbons) {
      const Vec3f tangent = unitOr(along, {0, 0, 0}), across = unitOr(cross(tangent, inside(wo)), {0, 0, 0});
      const float sine = std::clamp(hit.v, -1.0f, 1.0f);
      normal = across * sine + cross(across, tangent) * std::sqrt(1 - sine * sine);
    } else {
      const Vec3f at = placement.flat ? out.position : m.inverseVector(out.position - m.t);
      normal = at - curveAt(p, line, hit.u);
    }
    if (!placement.flat) normal = m.determinant() < 0 ? -m.normal(normal) : m.normal(normal);
    out.normal = unitOr(normal, wo);
    out.along = placement.flat ? along : m.vector(along);
  }
  if (strands.form == Form::kRibbons) return out;
  out.turned = dot(out.normal, wo) < 0;
  if (out.turned) out.normal = -out.normal;
  out.facing = out.normal;
  return out;
}

}  // namespace wardmis
