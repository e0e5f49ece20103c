// SPDX-License-Identifier: GPL-3.0-or-later
// Operations that read where the program runs.
#pragma once

#include "program/operands.h"
#include "program/surface.h"

namespace wardmis::place {

inline Vec3f inCamera(const ShadingContext& c, Vec3f p) { return vectors::inversePoint(c.camera, p); }
// Where a point is seen: of a world, in its direction from the camera.
inline Vec3f asSeen(const ShadingContext& c, Vec3f p) { return inCamera(c, c.isObject ? p : p + c.camera.t); }

inline Vec3f window(const ShadingContext& c, Vec3f p) {
  const bool parallel = c.orthographic && !c.isObject;  // such rays differ by where they start
  const Vec3f q = !parallel                          ? asSeen(c, p)
                  : (c.path.kinds & kCameraRay) != 0 ? inCamera(c, c.rayOrigin)
                                                     : inCamera(c, p);
  const float x = c.orthographic ? q.x : arithmetic::divide(q.x, q.z);
  const float y = c.orthographic ? q.y : arithmetic::divide(q.y, q.z);
  const float* w = c.window;
  return {(x - w[0]) / (w[1] - w[0]), (y - w[2]) / (w[3] - w[2]), 0};
}

// The part of t orthogonal to the normal, unit; 0 where there is none.
inline Vec3f alongSurface(const ShadingContext& c, Vec3f t) {
  return cross(c.normal, safeNormalize(cross(t, c.normal)));
}
inline Vec3f radialTangent(const ShadingContext& c, uint32_t axis) {
  const Vec3f p = c.generated.value - Vec3f{0.5f, 0.5f, 0.5f};
  const Vec3f t = axis == 0 ? Vec3f{0, -p.z, p.y} : axis == 1 ? Vec3f{-p.z, 0, p.x} : Vec3f{-p.y, p.x, 0};
  return alongSurface(c, surface::normalToWorld(c.toWorld, t));
}
inline Vec3f uvTangent(const ShadingContext& c, const AttributeValue& tangents) {
  if (tangents.components == 0) return {0, 0, 0};
  return alongSurface(c, surface::normalToWorld(c.toWorld, tangents.xyz.value));
}

inline Vec3f attribute(const AttributeValue& a, uint32_t shift, float width) {
  const Vec3f v = a.xyz.at(shift, width);
  if (a.components == 0) return {0, 0, 0};
  return a.components == 1 ? Vec3f{v.x, v.x, v.x} : a.components == 2 ? Vec3f{v.x, v.y, 0} : v;
}
inline float attributeNumber(const AttributeValue& a, uint32_t shift, float width) {
  const Vec3f v = a.xyz.at(shift, width);
  return a.components == 0 ? 0 : a.components < 3 ? v.x : (v.x + v.y + v.z) * (1 / 3.0f);
}
inline float attributeAlpha(const AttributeValue& a, uint32_t shift, float width) {
  if (a.components < 4) return 1;
  return shift == 0 ? a.w[0] : a.w[0] + a.w[shift] * width;
}

inline float isKind(const ShadingContext& c, RayKind kind) { return (c.path.kinds & kind) != 0 ? 1 : 0; }

inline void read(Operation operation, const Operands& o, const ShadingContext& c) {
  using enum Operation;
  const auto shifted = [&](const Varying& v) { return v.at(o.word(0), o.number(1)); };
  const auto attributeOf = [&](int word) -> const AttributeValue& { return c.attributes[o.word(word)]; };
  switch (operation) {
    case kPosition:
      return o.set(shifted(c.position));
    case kNormal:
      return o.set(c.normal);
    case kTrueNormal:
      return o.set(c.trueNormal);
    case kObjectNormal:
      return o.set(c.isObject ? surface::normalToObject(c.toWorld, c.normal) : c.normal);
    case kIncoming:
      return o.set(c.incoming);
    case kDirection:
      return o.set(-c.incoming);
    case kReflection:
      return o.set(c.isObject ? c.normal * (2 * dot(c.normal, c.incoming)) - c.incoming : c.incoming);
    case kTangentRadial:
      return o.set(radialTangent(c, o.word(0)));
    case kTangentUv:
      return o.set(uvTangent(c, attributeOf(0)));
    case kUv:
      return o.set(attribute(attributeOf(0), o.word(1), o.number(2)));
    case kGenerated:
      return o.set(shifted(c.generated));
    case kObject: {
      const Vec3f p = shifted(c.position);
      return o.set(c.isObject ? vectors::inversePoint(c.toWorld, p) : p);
    }
    case kCamera:
      return o.set(asSeen(c, shifted(c.position)));
    case kWindow:
      return o.set(c.panoramic ? shifted(c.panorama) : window(c, shifted(c.position)));
    case kParametric:
      return o.set(shifted(c.parametric));
    case kBackfacing:
      return o.set(c.backfacing ? 1 : 0);
    case kAttribute:
      return o.set(attribute(attributeOf(0), o.word(1), o.number(2)));
    case kAttributeNumber:
      return o.set(attributeNumber(attributeOf(0), o.word(1), o.number(2)));
    case kAttributeAlpha:
      return o.set(attributeAlpha(attributeOf(0), o.word(1), o.number(2)));
    case kObjectLocation:
      return o.set(c.toWorld.t);
    case kObjectColor:
      return o.set(Vec3f{c.color[0], c.color[1], c.color[2]});
    case kObjectAlpha:
      return o.set(c.color[3]);
    case kObjectIndex:
      return o.set(c.index);
    case kObjectRandom:
      return o.set(c.random);
    case kMaterialIndex:
      return o.set(c.materialIndex);
    case kViewVector:
      return o.set(safeNormalize(inCamera(c, c.position.value)));
    case kViewDepth:
      return o.set(inCamera(c, c.position.value).z);
    case kViewDistance:
      return o.set(length(inCamera(c, c.position.value)));
    case kIsCameraRay:
      return o.set(isKind(c, kCameraRay));
    case kIsShadowRay:
      return o.set(isKind(c, kShadowRay));
    case kIsDiffuseRay:
      return o.set(isKind(c, kDiffuseRay));
    case kIsGlossyRay:
      return o.set(isKind(c, kGlossyRay));
    case kIsSingularRay:
      return o.set(isKind(c, kSingularRay));
    case kIsReflectionRay:
      return o.set(isKind(c, kReflectionRay));
    case kIsTransmissionRay:
      return o.set(isKind(c, kTransmissionRay));
    case kRayLength:
      return o.set(c.rayLength);
    case kRayDepth:
      return o.set(c.path.depth);
    case kDiffuseDepth:
      return o.set(c.path.diffuse);
    case kGlossyDepth:
      return o.set(c.path.glossy);
    case kTransparentDepth:
      return o.set(c.path.transparent);
    case kTransmissionDepth:
      return o.set(c.path.transmission);
    default:
      return;
  }
}

}  // namespace wardmis::place
