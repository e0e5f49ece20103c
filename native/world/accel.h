// SPDX-License-Identifier: GPL-3.0-or-later
// Ray queries. By Embree (3.13 and 4).
#pragma once

#include <cstdint>
#include <memory>

#include "program/context.h"
#include "world/geometry.h"

namespace wardmis {

// What a ray is for; it meets what is visible to that kind.
struct Ray {
  Vec3f origin, direction;  // unit
  // Not from 0: a ray that starts exactly in a surface's plane does not meet that surface.
  float tMin = 1e-15f, tMax = 3.4e38f;
  Visibility kind = kSeenByCamera;
  PathState path;  // for programs
  // What it does not meet: the curve or the sphere that it leaves, or the triangle with others in its place, and such a
  // one that it is aimed at.
  PrimitiveId left, aimed;
};

struct Hit {
  float t = 3.4e38f;
  // Barycentric weights of the second and third vertex; of a curve how far along its segment, and, of a ribbon, the
  // sine of the angle about it.
  float u = 0, v = 0;
  Vec3f normal{0, 0, 0};  // geometric, not normalised; space of the shape (world if the placement is flat)
  uint32_t placement = ~0u, shape = ~0u, triangle = 0;  // or segment, or sphere

  bool shared = false;  // another triangle lies in the same place

  bool valid() const { return placement != ~0u; }
};

class Accel {
 public:
  // Builds over `geometry`, which must outlive it. threads: 0 for all. Throws Error(kMemory) and Error(kScene).
  Accel(const Geometry& geometry, int threads);
  ~Accel();
  Accel(Accel&&) noexcept;

  Hit intersect(const Ray& ray) const;
  bool occluded(const Ray& ray) const;

  // Whether another triangle lies in the place of this one, or of a part of it. Rays leave it from where it is, and do
  // not meet it, but meet the other: as in Cycles, such a surface is in its own shadow.
  bool shared(PrimitiveId triangle) const;

  static const char* libraryVersion();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wardmis
