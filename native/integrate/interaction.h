// SPDX-License-Identifier: GPL-3.0-or-later
// Where a ray met a surface: position, shading frame, the surface's inputs resolved.
#pragma once

#include "bsdf/surface.h"
#include "integrate/expand.h"
#include "integrate/lobe_surface.h"
#include "integrate/terminator.h"
#include "scene/inputs.h"
#include "world/accel.h"
#include "world/needs.h"
#include "world/shading.h"

namespace wardmis {

template <class S>
struct InteractionOf {
  Vec3f position;   // world
  Vec3f geometric;  // unit, on the side of wo
  Framef frame;     // z: shading normal; x: direction of the anisotropy
  Vec3f wo;         // world, unit, back along the ray
  S surface;
  Rgb emission{0, 0, 0};
  int material = 0;
  uint32_t placement = 0;
  PathState path;  // of the ray that came here
  float rayLength = 0;

  PrimitiveId primitive;  // that it is on, where rays that leave must not meet it and may not start beside it
  float clearance = 0;    // bound on the rounding of `position` and of an intersection there, along the normal
  SmoothFace smooth;

  // Start of a ray leaving towards the side of the geometric normal on which `direction` lies, so that it does not
  // meet the surface that it leaves.
  Vec3f leave(Vec3f direction) const {
    return position + geometric * (dot(geometric, direction) < 0 ? -clearance : clearance);
  }
};

using Interaction = InteractionOf<Surface>;
// The surface of a kernel with these needs.
template <uint32_t N, size_t K>
using SurfaceOf = std::conditional_t<(N & kNeedsLobes) != 0, LobeSurface<K>, Surface>;

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

// UVs are in the file only where they are looked up (the reader leaves the others out).
inline Vec2f uvAt(const Shape& s, const Hit& hit) {
  if (s.part->uvs.empty()) return {};
  if (s.strands == nullptr) return interpolate(s.part->uvs, s.indices + 3 * size_t{hit.triangle}, hit.u, hit.v);
  uint32_t ends[3];
  endsOf(*s.primitive, hit.triangle, ends);
  return interpolate(s.part->uvs, ends, hit.u, 0);
}

// World direction of the anisotropy before its rotation: of increasing u; without UVs, along the meridians of the
// object's z axis.
inline Vec3f tangent(const Placement& p, const Shape& s, const uint32_t* i, const Corners& corner, Vec3f position) {
  if (!s.part->uvs.empty()) {
    const Vec2f a = s.part->uvs[i[0]], b = s.part->uvs[i[1]], c = s.part->uvs[i[2]];
    const float du1 = b.x - a.x, dv1 = b.y - a.y, du2 = c.x - a.x, dv2 = c.y - a.y;
    const Vec3f e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const Vec3f t = (e1 * dv2 - e2 * dv1) * std::copysign(1.0f, du1 * dv2 - du2 * dv1);
    return p.flat ? t : p.toWorld.vector(t);
  }
  const Vec3f axis = p.toWorld.z, radial = position - p.toWorld.t;
  return cross(axis, radial);
}

// Of a shape that deforms, where the mesh's own are.
inline Vec3f movedNormal(const Shape& s, const uint32_t* i, float u, float v, float time) {
  const auto& steps = s.part->movedNormals;
  if (steps.empty()) return interpolate(s.part->normals, i, u, v);
  const auto [first, t] = stepAt(steps.size(), time);
  return interpolate(steps[first], i, u, v) * (1 - t) + interpolate(steps[first + 1], i, u, v) * t;
}

// A shading normal that looks away from the viewer is bent until it does not (else the silhouette turns black). One
// that looks into the surface is meant so: there is light where both it and the surface's own normal see it.
inline Vec3f bent(Vec3f ns, Vec3f ng, Vec3f wo) {
  constexpr float kGrazing = 1e-3f, kLevel = 1e-5f;  // whose sign is no rounding
  const float facing = dot(ns, wo);
  return facing < kGrazing && dot(ns, ng) > kLevel ? normalize(ns + wo * (kGrazing - facing)) : ns;
}

// The frame turned about its z.
inline Framef turned(const Framef& f, float angle) {
  const float c = std::cos(angle), s = std::sin(angle);
  return {f.x * c + f.y * s, f.y * c - f.x * s, f.z};
}

// The surface's inputs where the material has a program.
void resolve(const Scene& scene, const Material& material, const ShadedPoint& point, Vec2f uv, Surface& surface,
             Rgb& emission, Vec3f& normal);

// The lobes of any material, and its light. Leaves the frame in which they are told.
template <size_t K>
Framef resolveLobes(const Scene& scene, const Material& material, const ShadedPoint& point, Vec2f uv, Vec3f tangent,
                    const LobeNumbers& numbers, LobeSurface<K>& surface, Rgb& emission);

// The surface's inputs at the point, and the frame in which they are told. ns: its shading normal; point(): for
// programs; tangent(): direction of the anisotropy.
template <uint32_t N, size_t K, class Point, class Tangent>
void resolveSurface(const Scene& scene, const Material& m, Vec3f ns, Vec2f uv, Point&& point, Tangent&& tangent,
                    const LobeNumbers& lobes, InteractionOf<SurfaceOf<N, K>>& x) {
  if constexpr ((N & kNeedsLobes) != 0) {
    x.frame = resolveLobes<K>(scene, m, point(), uv, tangent(), lobes, x.surface, x.emission);
  } else {
    const auto color = [&](const ColorInput& c) { return c.texture.texture >= 0 ? evaluate(scene, c, uv) : c.value; };
    const auto reflectance = [&](const ColorInput& c) {
      return c.texture.texture >= 0 ? notNegative(evaluate(scene, c, uv)) : c.value;
    };
    const auto alpha = [&](const ScalarInput& c) {
      return c.texture.texture >= 0 ? evaluateAlpha(scene, c, uv) : c.value;
    };
    if (m.program) [[unlikely]] {
      resolve(scene, m, point(), uv, x.surface, x.emission, ns);
    } else {
      if constexpr ((N & kNeedsDiffuse) != 0) x.surface.diffuse = reflectance(m.diffuse);
      if constexpr ((N & kNeedsSpecular) != 0) {
        x.surface.specular = reflectance(m.specular);
        x.surface.ax = alpha(m.alphaX);
        x.surface.ay = alpha(m.alphaY);
      }
      if (!isBlack(m.emission.value)) x.emission = color(m.emission);
    }
    if constexpr ((N & kNeedsSpecular) != 0) x.surface.variant = m.variant;

    if ((N & kNeedsSpecular) != 0 && x.surface.ax != x.surface.ay) {
      x.frame = turned(Framef::around(ns, tangent()), m.rotation);
    } else {
      x.frame = Framef::around(ns);
    }
  }
}

// On a curve or a sphere.
template <uint32_t N, size_t K>
[[gnu::noinline]] void interactWithStrand(const Scene& scene, const LobeNumbers& lobes, const Placement& placement,
                                          const Shape& shape, const Ray& ray, const Hit& hit,
                                          InteractionOf<SurfaceOf<N, K>>& x) {
  const StrandPoint on = strandPoint(placement, shape, ray, hit);
  x.position = on.position;
  x.geometric = on.normal;
  x.primitive = {hit.placement, hit.shape, shape.strands->strandOf(hit.triangle)};
  const auto point = [&] {
    return ShadedPoint{placement, shape,     hit.triangle, hit.u,     hit.v,  x.position,
                       on.facing, on.normal, x.wo,         on.turned, x.path, hit.t};
  };
  resolveSurface<N, K>(
      scene, scene.materials[static_cast<size_t>(shape.material)], on.normal, uvAt(shape, hit), point,
      [&] { return on.along; }, lobes, x);
}

// placement: of the hit, where it is at the ray's time.
template <uint32_t N, size_t K>
InteractionOf<SurfaceOf<N, K>> interactWith(const Scene& scene, const LobeNumbers& lobes, const Placement& placement,
                                            const Shape& shape, const Ray& ray, const Hit& hit) {
  const Material& m = scene.materials[static_cast<size_t>(shape.material)];
  InteractionOf<SurfaceOf<N, K>> x;
  x.material = shape.material;
  x.placement = hit.placement;
  x.wo = -ray.direction;
  x.surface.terminator = terminatorAngle(placement.terminator.shading);
  x.path = ray.path;
  x.rayLength = hit.t;
  if (shape.strands != nullptr) [[unlikely]] {
    interactWithStrand<N, K>(scene, lobes, placement, shape, ray, hit, x);
    return x;
  }
  const uint32_t* i = shape.indices + 3 * size_t{hit.triangle};
  // from one corner: far from the origin, weights that do not quite sum to 1 would move the point
  const Corners corner = cornersOf(shape, hit.triangle, ray.path.time);
  const Vec3f a = corner[0];
  const Vec3f p = a + ((corner[1] - a) * hit.u + (corner[2] - a) * hit.v);
  x.position = placement.flat ? p : placement.toWorld.point(p);
  Vec3f ng = placement.flat ? hit.normal : placement.toWorld.normal(hit.normal);
  ng = normalize(ng);
  Vec3f ns = ng;
  if (!shape.part->normals.empty()) {
    const Array<Vec3f>& n = shape.part->normals;
    // normals stay in the mesh's space, also where positions were moved
    Vec3f own = interpolate(shape.part->normals, i, hit.u, hit.v);
    if (shape.motion != nullptr) [[unlikely]]
      own = movedNormal(shape, i, hit.u, hit.v, ray.path.time);
    const Vec3f world = placement.toWorld.normal(own);
    const float l2 = dot(world, world);
    if (l2 > 0) ns = world / std::sqrt(l2);
    constexpr float kFlat = 1 - 1e-6f;
    if (placement.terminator.geometry > 0 &&
        !(n[i[0]] == n[i[1]] && n[i[0]] == n[i[2]] && std::abs(dot(ns, ng)) > kFlat))
      x.smooth = {placement.terminator.geometry, hit.shape, hit.triangle, hit.u, hit.v};
  }
  const bool away = dot(ng, x.wo) < 0;
  if (away) ng = -ng, ns = -ns;
  x.geometric = ng;
  if (hit.shared) [[unlikely]]
    x.primitive = {hit.placement, hit.shape, hit.triangle};
  else
    x.clearance = clearance(placement, corner, ng);
  // closures see to that themselves, where they do
  if (!shape.part->normals.empty() && m.closures.empty()) ns = bent(ns, ng, x.wo);

  const auto point = [&] {
    const bool turned = away != placement.mirrors();
    return ShadedPoint{placement, shape, hit.triangle, hit.u, hit.v, x.position, ng, ns, x.wo, turned, x.path, hit.t};
  };
  resolveSurface<N, K>(
      scene, m, ns, uvAt(shape, hit), point, [&] { return tangent(placement, shape, i, corner, x.position); }, lobes,
      x);
  return x;
}

}  // namespace detail

// ray: the one that hit. N: needs mask of the kernel.
template <uint32_t N, size_t K = 3>
InteractionOf<SurfaceOf<N, K>> interact(const Scene& scene, const Geometry& geometry, const Ray& ray, const Hit& hit) {
  const Placement& placement = geometry.placements[hit.placement];
  const Shape& shape = geometry.shapes[hit.shape];
  if (placement.motion != nullptr) [[unlikely]] {
    auto x = detail::interactWith<N, K>(scene, geometry.lobes, placement.at(ray.path.time), shape, ray, hit);
    x.clearance *= 4;  // the transform has been interpolated twice, here and in Embree
    return x;
  }
  return detail::interactWith<N, K>(scene, geometry.lobes, placement, shape, ray, hit);
}

}  // namespace wardmis
