// SPDX-License-Identifier: GPL-3.0-or-later
// What is placed in the world, flattened for the renderer: shapes (a primitive of a mesh with one material) and
// placements (an instance of a mesh). A mesh that is used once is moved into world space and needs no transform.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace wardmis {

struct Shape {
  const MeshPart* part = nullptr;    // normals and uvs, in the mesh's space
  const Vec3f* positions = nullptr;  // world space if the placement is flat, else the mesh's
  size_t vertices = 0;
  const uint32_t* indices = nullptr;
  uint32_t triangles = 0;
  int material = 0;
  uint32_t emitterOffset = 0;  // emissive shapes: of the first triangle, from the placement's firstEmitter
};

struct Placement {
  Affine toWorld;
  int mesh = 0;
  uint32_t firstShape = 0, shapes = 0;  // into Geometry::shapes
  bool flat = false;                    // shapes' positions are in world space already
  uint8_t visibility = kSeenByAll;
  uint32_t firstEmitter = 0;  // of its emissive triangles
  const std::string* name = nullptr;
  const ObjectData* object = nullptr;  // null: as it is by default
};

struct Geometry {
  std::vector<Shape> shapes;
  std::vector<Placement> placements;
  std::vector<std::vector<Vec3f>> positions;  // of all shapes, each padded by one vertex
  uint64_t triangles = 0;                     // placed, instances counted
  Vec3f lower{0, 0, 0}, upper{0, 0, 0};       // bounds, world space

  explicit Geometry(const Scene& scene);
  Vec3f center() const { return (lower + upper) * 0.5f; }
  float radius() const { return std::max(length(upper - lower) * 0.5f, 1e-6f); }

  Vec3f corner(const Placement& p, const Shape& s, uint32_t triangle, int k) const {
    const Vec3f v = s.positions[s.indices[3 * size_t{triangle} + static_cast<size_t>(k)]];
    return p.flat ? v : p.toWorld.point(v);
  }
};

}  // namespace wardmis
