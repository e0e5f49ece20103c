// SPDX-License-Identifier: GPL-3.0-or-later
// Operations that depend on the surface and the view: normal maps, bump, Fresnel, facing, changes of space.
#pragma once

#include "program/context.h"
#include "program/vectors.h"

namespace wardmis::surface {

// A normal from object to world space and back: by the inverse transposed and the transposed matrix. Unit, or 0.
inline Vec3f normalToWorld(const Affine& m, Vec3f n) {
  const Vec3f w = m.normal(n);
  return safeNormalize(m.determinant() < 0 ? -w : w);
}
inline Vec3f normalToObject(const Affine& m, Vec3f n) { return safeNormalize(vectors::transposed(m, n)); }

enum Space : uint32_t { kWorld, kObject, kCamera };
enum VectorType : uint32_t { kPoint, kVector, kNormal };

inline Vec3f toWorld(const Affine& m, VectorType type, Vec3f v, uint32_t version) {
  if (type == kPoint) return m.point(v);
  if (type == kNormal && version >= 4) return normalToWorld(m, v);
  return m.vector(v);
}
inline Vec3f fromWorld(const Affine& m, VectorType type, Vec3f v, uint32_t version) {
  if (type == kPoint) return vectors::inversePoint(m, v);
  if (type == kNormal && version >= 4) return normalToObject(m, v);
  return m.inverseVector(v);
}
inline Vec3f transform(const ShadingContext& c, VectorType type, Space from, Space to, Vec3f v, uint32_t version) {
  const bool nothing = from == to || (!c.isObject && from != kCamera && to != kCamera);
  if (!nothing) {
    if (from == kCamera) v = toWorld(c.camera, type, v, version);
    if (from == kObject && c.isObject) v = toWorld(c.toWorld, type, v, version);
    if (to == kCamera) v = fromWorld(c.camera, type, v, version);
    if (to == kObject && c.isObject) v = fromWorld(c.toWorld, type, v, version);
  }
  return type == kNormal && version == 3 ? safeNormalize(v) : v;
}

inline bool isUsable(Vec3f n) { return isFinite(n) && !isBlack(n); }

// Between the shading normal and n, as Cycles has it: not along the arc.
inline Vec3f strengthened(const ShadingContext& c, Vec3f n, float strength) {
  if (strength != 1) n = safeNormalize(c.normal + (n - c.normal) * std::max(strength, 0.0f));
  return isUsable(n) ? n : c.normal;
}
inline Vec3f decoded(Rgb color, bool invertGreen) {
  const Vec3f n{2 * (color.x - 0.5f), 2 * (color.y - 0.5f), 2 * (color.z - 0.5f)};
  return invertGreen ? Vec3f{n.x, -n.y, n.z} : n;
}

inline Vec3f normalMapTangent(const ShadingContext& c, const AttributeValue& tangents, Rgb color, float strength,
                              bool invertGreen, uint32_t version) {
  if (tangents.components == 0) return c.normal;
  Vec3f m = decoded(color, invertGreen);
  if (version >= 4) m = {m.x * strength, m.y * strength, 1 + (m.z - 1) * arithmetic::saturate(strength)};
  const Vec3f normal = version >= 5 ? safeNormalize(c.interpolatedNormal) : c.interpolatedNormal;
  const Vec3f tangent = tangents.xyz.value, bitangent = cross(normal, tangent) * tangents.w[0];
  Vec3f n = normalToWorld(c.toWorld, safeNormalize(tangent * m.x + bitangent * m.y + normal * m.z));
  if (c.backfacing) n = -n;
  return strengthened(c, n, version >= 4 ? 1 : strength);
}
inline Vec3f normalMapFixed(const ShadingContext& c, bool object, Rgb color, float strength, bool invertGreen,
                            bool flip) {
  Vec3f n = decoded(color, invertGreen);
  if (flip) n = {n.x, -n.y, -n.z};
  n = object ? normalToWorld(c.toWorld, n) : safeNormalize(n);
  return strengthened(c, c.backfacing ? -n : n, strength);
}

// n bent towards the true normal just so far that the view's reflection leaves the surface, as Cycles has it: in 3.4 by
// what comes out of either root, since 4.x by the side from which the view looks.
inline Vec3f visiblyReflecting(uint32_t version, Vec3f trueNormal, Vec3f incoming, Vec3f n) {
  const float iz = dot(incoming, trueNormal), least = std::min(0.9f * iz, 0.01f);
  if (dot(trueNormal, n * (2 * dot(n, incoming)) - incoming) >= least) return n;
  // In the plane of both normals, z the true one: the reflection's height 2 (n.i) n.z - i.z is to be `least`, which is
  // a quadratic equation for n.z^2.
  const Vec3f across = n - trueNormal * dot(n, trueNormal), x = dot(across, across) > 0 ? normalize(across) : n;
  const float ix = dot(incoming, x), a = ix * ix + iz * iz;
  const float b = arithmetic::squareRoot(ix * ix * (a - least * least)), c = iz * least + a;
  const float z2[2] = {0.5f / a * (c + b), 0.5f / a * (c - b)};
  const auto at = [&](float z) {
    return x * arithmetic::squareRoot(std::max(1 - z, 0.0f)) + trueNormal * arithmetic::squareRoot(std::max(z, 0.0f));
  };
  if (version >= 4) return at(z2[ix < 0 ? 0 : 1]);
  float best = 0;
  Vec3f found = trueNormal;
  bool any = false;
  const auto valid = [](float v) { return v > 1e-5f && v <= 1 + 1e-5f; };
  for (const float z : z2) {
    if (!valid(z)) continue;
    const Vec3f turned = at(z);
    const float height = 2 * dot(turned, incoming) * dot(turned, trueNormal) - iz;
    // of two that are above the surface the lower one, else the higher one
    const bool better = height >= 1e-5f && best >= 1e-5f ? height < best : height > best;
    if (!any || better) best = height, found = turned;
    any = true;
  }
  return found;
}

inline Vec3f bump(const ShadingContext& c, float h, float hx, float hy, float distance, float strength, Vec3f normal,
                  float width, uint32_t version) {
  const Vec3f dx = c.position.dx, dy = c.position.dy;
  const Vec3f rx = cross(dy, normal), ry = cross(normal, dx);
  const float det = dot(dx, rx);
  const Vec3f gradient = rx * (hx - h) + ry * (hy - h);
  strength = std::max(strength, 0.0f);
  Vec3f n = safeNormalize(normal * (width * std::abs(det)) - gradient * (det < 0 ? -distance : distance));
  n = isUsable(n) ? normalize(n * strength + normal * (1 - strength)) : normal;
  return version == 3 ? visiblyReflecting(version, c.trueNormal, c.incoming, n) : n;
}

inline Vec3f bent(const ShadingContext& c, Vec3f n) {
  n = safeNormalize(n);
  return isUsable(n) ? n : c.normal;
}

// In the world, of what is told along the tangent (x), the normal (y) and the bitangent (z) of the object.
inline Vec3f vectorDisplacement(const ShadingContext& c, const AttributeValue& tangents, Vec3f d) {
  const Vec3f normal = normalToObject(c.toWorld, c.normal),
              tangent = tangents.components == 0 ? Vec3f{} : tangents.xyz.value;
  const Vec3f bitangent = safeNormalize(cross(normal, tangent)) * tangents.w[0];
  return c.toWorld.vector(tangent * d.x + normal * d.y + bitangent * d.z);
}

// Reflectance of a dielectric for unpolarised light.
inline float fresnel(float cosine, float eta) {
  const float c = std::abs(cosine), g2 = eta * eta - 1 + c * c;
  if (!(g2 > 0)) return 1;
  const float g = std::sqrt(g2), a = (g - c) / (g + c), b = (c * (g + c) - 1) / (c * (g - c) + 1);
  return 0.5f * a * a * (1 + b * b);
}
inline float fresnelNode(const ShadingContext& c, float ior, Vec3f normal) {
  const float eta = std::max(ior, 1e-5f);
  return fresnel(dot(c.incoming, normal), c.backfacing ? 1 / eta : eta);
}
inline float layerFresnel(const ShadingContext& c, float blend, Vec3f normal) {
  const float eta = std::max(1 - blend, 1e-5f);
  return fresnel(dot(c.incoming, normal), c.backfacing ? eta : 1 / eta);
}
inline float layerFacing(const ShadingContext& c, float blend, Vec3f normal) {
  float f = std::abs(dot(c.incoming, normal));
  if (blend != 0.5f) {
    const float b = arithmetic::clamp(blend, 0, 1 - 1e-5f);
    f = std::pow(f, b < 0.5f ? 2 * b : 0.5f / (1 - b));
  }
  return 1 - f;
}

enum class Falloff { kQuadratic, kLinear, kConstant };
inline float lightFalloff(Falloff falloff, float strength, float smooth, float length, uint32_t version) {
  constexpr float kEndless = 3e38f;
  if (version >= 4 && length >= kEndless) return strength;
  if (falloff != Falloff::kQuadratic) strength *= length;
  if (falloff == Falloff::kConstant) strength *= length;
  const float squared = length * length;
  return smooth > 0 && std::isfinite(squared) ? strength * (squared / (smooth + squared)) : strength;
}

}  // namespace wardmis::surface
