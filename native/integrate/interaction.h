// SPDX-License-Identifier: GPL-3.0-or-later
// Where a ray met a surface: position, shading frame, the surface's inputs resolved.
#pragma once

#include <bit>

#include "bsdf/surface.h"
#include "scene/accel.h"
#include "scene/needs.h"
#include "scene/texture.h"

namespace wardmis {

struct Interaction {
  Vec3f position;   // world
  Vec3f geometric;  // unit, on the side of wo
  Framef frame;     // z: shading normal; x: direction of the anisotropy
  Vec3f wo;         // world, unit, back along the ray
  Surface surface;
  Rgb emission{0, 0, 0};
  int material = 0;
  uint32_t placement = 0;

  // Start of a ray leaving towards the side of the geometric normal on which `direction` lies, beyond the rounding of
  // the position (Waechter and Binder 2019, "A fast and robust method for avoiding self-intersection").
  Vec3f leave(Vec3f direction) const {
    const Vec3f n = dot(geometric, direction) < 0 ? -geometric : geometric;
    const auto offset = [](float p, float d) {
      constexpr float kOrigin = 1.0f / 32, kFloat = 1.0f / 65536, kInt = 256;
      if (std::abs(p) < kOrigin) return p + kFloat * d;
      const int steps = static_cast<int>(kInt * d);
      return std::bit_cast<float>(std::bit_cast<int32_t>(p) + (p < 0 ? -steps : steps));
    };
    return {offset(position.x, n.x), offset(position.y, n.y), offset(position.z, n.z)};
  }
};

namespace detail {

template <class V>
V interpolate(const Array<V>& a, const uint32_t* i, float u, float v);
template <>
inline Vec3f interpolate(const Array<Vec3f>& a, const uint32_t* i, float u, float v) {
  return a[i[0]] * (1 - u - v) + a[i[1]] * u + a[i[2]] * v;
}
template <>
inline Vec2f interpolate(const Array<Vec2f>& a, const uint32_t* i, float u, float v) {
  const float w = 1 - u - v;
  return {a[i[0]].x * w + a[i[1]].x * u + a[i[2]].x * v, a[i[0]].y * w + a[i[1]].y * u + a[i[2]].y * v};
}

// World direction of the anisotropy before its rotation: of increasing u; without UVs, along the meridians of the
// object's z axis.
inline Vec3f tangent(const Placement& p, const Shape& s, const uint32_t* i, Vec3f position) {
  if (!s.part->uvs.empty()) {
    const Vec2f a = s.part->uvs[i[0]], b = s.part->uvs[i[1]], c = s.part->uvs[i[2]];
    const float du1 = b.x - a.x, dv1 = b.y - a.y, du2 = c.x - a.x, dv2 = c.y - a.y;
    const Vec3f e1 = s.positions[i[1]] - s.positions[i[0]], e2 = s.positions[i[2]] - s.positions[i[0]];
    const Vec3f t = (e1 * dv2 - e2 * dv1) * std::copysign(1.0f, du1 * dv2 - du2 * dv1);
    return p.flat ? t : p.toWorld.vector(t);
  }
  const Vec3f axis = p.toWorld.z, radial = position - p.toWorld.t;
  return cross(axis, radial);
}

}  // namespace detail

// ray: the one that hit. N: needs mask of the kernel.
template <uint32_t N>
Interaction interact(const Scene& scene, const Geometry& geometry, const Ray& ray, const Hit& hit) {
  const Placement& placement = geometry.placements[hit.placement];
  const Shape& shape = geometry.shapes[hit.shape];
  const Material& m = scene.materials[static_cast<size_t>(shape.material)];
  const uint32_t* i = shape.indices + 3 * size_t{hit.triangle};

  Interaction x;
  x.material = shape.material;
  x.placement = hit.placement;
  x.wo = -ray.direction;
  const Vec3f p =
      shape.positions[i[0]] * (1 - hit.u - hit.v) + shape.positions[i[1]] * hit.u + shape.positions[i[2]] * hit.v;
  x.position = placement.flat ? p : placement.toWorld.point(p);
  Vec3f ng = placement.flat ? hit.normal : placement.toWorld.normal(hit.normal);
  ng = normalize(ng);
  Vec3f ns = ng;
  if (!shape.part->normals.empty()) {
    // normals stay in the mesh's space, also where positions were moved
    const Vec3f n = placement.toWorld.normal(detail::interpolate(shape.part->normals, i, hit.u, hit.v));
    const float l2 = dot(n, n);
    if (l2 > 0) ns = n / std::sqrt(l2);
    if (dot(ns, ng) < 0) ns = -ns;
  }
  if (dot(ng, x.wo) < 0) ng = -ng, ns = -ns;
  // A shading normal that looks away from the viewer is bent until it does not (else the silhouette turns black).
  constexpr float kGrazing = 1e-3f;
  const float facing = dot(ns, x.wo);
  if (facing < kGrazing) ns = normalize(ns + x.wo * (kGrazing - facing));
  x.geometric = ng;

  // UVs are in the file only where a texture is looked up (the reader leaves the others out).
  const Vec2f uv = shape.part->uvs.empty() ? Vec2f{} : detail::interpolate(shape.part->uvs, i, hit.u, hit.v);
  const auto color = [&](const ColorInput& c) { return c.texture.texture >= 0 ? evaluate(scene, c, uv) : c.value; };
  const auto alpha = [&](const ScalarInput& c) {
    return c.texture.texture >= 0 ? evaluateAlpha(scene, c, uv) : c.value;
  };
  if constexpr ((N & kNeedsDiffuse) != 0) x.surface.diffuse = color(m.diffuse);
  if constexpr ((N & kNeedsSpecular) != 0) {
    x.surface.specular = color(m.specular);
    x.surface.ax = alpha(m.alphaX);
    x.surface.ay = alpha(m.alphaY);
    x.surface.variant = m.variant;
  }
  if (maxComponent(m.emission.value) > 0) x.emission = color(m.emission);

  if ((N & kNeedsSpecular) != 0 && x.surface.ax != x.surface.ay) {
    const Framef f = Framef::around(ns, detail::tangent(placement, shape, i, x.position));
    const float c = std::cos(m.rotation), s = std::sin(m.rotation);
    x.frame = {f.x * c + f.y * s, f.y * c - f.x * s, ns};
  } else {
    x.frame = Framef::around(ns);
  }
  return x;
}

}  // namespace wardmis
