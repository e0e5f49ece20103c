// SPDX-License-Identifier: GPL-3.0-or-later
// Where a program runs, as plain numbers. All in the frame that the scene is told in (Blender's, Z up); the matrices
// too. What Program::reads does not name need not be filled.
#pragma once

#include <array>
#include <cstdint>

#include "image/image.h"
#include "math/vec.h"
#include "program/program.h"

namespace wardmis {

// Kinds of the ray that sees the point. Bits.
enum RayKind : uint16_t {
  kCameraRay = 1,
  kShadowRay = 2,
  kDiffuseRay = 4,
  kGlossyRay = 8,
  kSingularRay = 16,
  kReflectionRay = 32,
  kTransmissionRay = 64
};

// How a path came to where it is: what Light Path tells, and how long it was.
struct PathState {
  uint16_t kinds = kCameraRay;  // of the current ray
  uint8_t depth = 0, diffuse = 0, glossy = 0, transmission = 0;
  uint16_t transparent = 0;
  float before = 0;   // length of the path before the current ray
  float time = 0.5f;  // of all of it: where in the shutter's opening, 0 to 1

  // After a ray of length t, going on by one of these kinds.
  PathState scattered(uint16_t by, float t) const {
    PathState next = *this;
    const auto count = [](uint8_t& n) { n = static_cast<uint8_t>(n + (n < 255)); };
    next.kinds = by;
    next.before += t;
    count(next.depth);
    count((by & kTransmissionRay) != 0 ? next.transmission : (by & kDiffuseRay) != 0 ? next.diffuse : next.glossy);
    return next;
  }
  // From there towards a light.
  PathState shadow() const {
    PathState next = *this;
    next.kinds = kShadowRay;
    next.depth = static_cast<uint8_t>(next.depth + (next.depth < 255));
    return next;
  }
  // Straight through a surface.
  PathState passed() const {
    PathState next = *this;
    next.transparent = static_cast<uint16_t>(next.transparent + (next.transparent < 65535));
    return next;
  }
};

// A quantity and its steps over one pixel.
struct Varying {
  Vec3f value, dx, dy;

  Vec3f at(uint32_t shift, float width) const {
    return shift == 0 ? value : shift == 1 ? value + dx * width : value + dy * width;
  }
};

struct AttributeValue {
  Varying xyz;             // of tangents: in object space
  float w[3] = {1, 1, 1};  // value and steps of the fourth component; of tangents: the sign
  uint8_t components = 0;  // 0: there is none
};

struct ShadingContext {
  Varying position;          // steps: two of a pixel's size, orthogonal to each other and to trueNormal
  Vec3f normal, trueNormal;  // unit, towards the viewer
  Vec3f incoming;            // unit, to the viewer
  bool backfacing = false;   // the triangle is
  bool onCurve = false;
  Varying parametric{};        // (1 - u - v, u, 0)
  Vec3f interpolatedNormal{};  // of the corners, in object space, neither turned to the viewer nor of unit length
  float materialIndex = 0;
  // kReadsAttributes
  std::array<AttributeValue, kMostAttributes> attributes;
  // kReadsGenerated: in object space where the mesh has no coordinates of its own
  Varying generated{};
  // kReadsObject
  bool isObject = true;  // a surface of one, or a light; else a world, whose position is the direction looked at
  Affine toWorld;
  float color[4] = {1, 1, 1, 1};
  float index = 0, random = 0;
  // kReadsCamera; looks along +z, y is up
  Vec3f rayOrigin{};  // of a world: where it is looked at from
  Affine camera;      // to world; unit axes
  bool orthographic = false, panoramic = false;
  float window[4] = {-1, 1, -1, 1};  // left, right, bottom, top of the frame, at distance 1 (or in metres)
  Varying panorama{};                // where a panoramic camera sees the point, in its window
  // kReadsRay
  PathState path;
  float rayLength = 0;
};

// The images that programs look up.
struct TextureAccess {
  const Texture* textures = nullptr;
  const Image* images = nullptr;
};

}  // namespace wardmis
