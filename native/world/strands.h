// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and spheres as placed in the world: what Embree intersects, and what a hit on them looks like. As Cycles has
// them, light that leaves a curve does not meet the same curve again, nor a sphere itself.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace wardmis {

struct Placement;
struct Shape;
struct Ray;
struct Hit;

// A point with a radius, as Embree reads it.
struct alignas(16) ControlPoint {
  Vec3f position;
  float radius;
};

struct Strands {
  Form form;
  int pieces;
  bool inside;                       // is seen, of what is round
  std::vector<ControlPoint> points;  // in world space if the placement is flat; ends of splines stand twice
  std::vector<uint32_t> first;   // of each segment the first point that shapes it: of 4, of 2 (cones), of 1 (spheres)
  std::vector<uint32_t> strand;  // of each segment the curve that it is of; spheres: empty, each is its own

  // transform: into world space, all alike in its scale; null: the mesh's own.
  Strands(const MeshPart& part, const Primitive& primitive, const Affine* transform);

  uint32_t segments() const { return static_cast<uint32_t>(first.size()); }
  uint32_t strandOf(uint32_t segment) const { return strand.empty() ? segment : strand[segment]; }
  // A box that holds all of it.
  void growBox(Vec3f& lower, Vec3f& upper) const;
};

// A curve, a sphere or a triangle, for rays that leave it or are aimed at it, and do not meet it.
struct PrimitiveId {
  uint32_t placement = ~0u, shape = ~0u, index = ~0u;
  bool valid() const { return placement != ~0u; }
  bool operator==(const PrimitiveId&) const = default;
};

// Where a ray met one. World space; unit vectors.
struct StrandPoint {
  Vec3f position;
  Vec3f normal;  // of the surface, or of a ribbon as if it were round; towards the viewer
  Vec3f facing;  // the normal that a program is told as the true one: a ribbon's own, which is the viewer's direction
  Vec3f along;   // the curve's direction, not of unit length; 0 for spheres
  bool turned;   // seen from inside
};
StrandPoint strandPoint(const Placement& placement, const Shape& shape, const Ray& ray, const Hit& hit);

// The points of the mesh between which a segment lies, as the corners of a triangle without area.
inline void endsOf(const Primitive& primitive, uint32_t segment, uint32_t (&corners)[3]) {
  const uint32_t k = primitive.indices[segment];
  corners[0] = corners[2] = k;
  corners[1] = primitive.form == Form::kSpheres ? k : k + 1;
}

}  // namespace wardmis
