// SPDX-License-Identifier: GPL-3.0-or-later
// What is placed in the world, flattened for the renderer: shapes (a primitive of a mesh with one material) and
// placements (an instance of a mesh). A mesh that is used once is moved into world space and needs no transform.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "mis/technique.h"
#include "scene/scene.h"
#include "world/motion.h"
#include "world/strands.h"

namespace wardmis {

struct Shape {
  const MeshPart* part = nullptr;    // normals and uvs, in the mesh's space
  const Vec3f* positions = nullptr;  // world space if the placement is flat, else the mesh's
  size_t vertices = 0;
  const uint32_t* indices = nullptr;
  uint32_t triangles = 0;
  int material = 0;
  uint32_t emitterOffset = 0;  // emissive shapes: of the first triangle, from the placement's firstEmitter
  const std::vector<const Vec3f*>* motion = nullptr;  // positions at equal steps of the time; null: it keeps its shape
  // Of curves and spheres, instead of positions, indices and triangles.
  const Strands* strands = nullptr;
  const Primitive* primitive = nullptr;
};
inline bool isCurve(const Shape& s) { return s.strands != nullptr && s.strands->form != Form::kSpheres; }

using Corners = std::array<Vec3f, 3>;
Corners movedCorners(const Shape& s, const uint32_t* i, float time);
// Of a triangle, where s.positions are.
inline Corners cornersOf(const Shape& s, uint32_t triangle, float time) {
  const uint32_t* i = s.indices + 3 * size_t{triangle};
  if (s.motion != nullptr) [[unlikely]]
    return movedCorners(s, i, time);
  return {s.positions[i[0]], s.positions[i[1]], s.positions[i[2]]};
}

struct Placement {
  Affine toWorld;
  int mesh = 0;
  uint32_t firstShape = 0, shapes = 0;  // into Geometry::shapes
  bool holdout = false;                 // the camera sees a hole there
  bool shadowCatcher = false;           // the camera sees its shadows alone
  bool flat = false;                    // shapes' positions are in world space already
  ShadowTerminator terminator;
  uint8_t visibility = kSeenByAll;
  uint32_t firstEmitter = 0;  // of its emissive triangles
  const std::string* name = nullptr;
  const ObjectData* object = nullptr;   // null: as it is by default
  const MovingFrame* motion = nullptr;  // of toWorld; null: it stands

  // A triangle's corners as placed go round the other way than in the mesh, whose order says which side is the front.
  bool mirrors() const { return toWorld.determinant() < 0; }
  Placement at(float time) const {  // where it is then
    Placement p = *this;
    if (motion != nullptr) p.toWorld = motion->at(time);
    return p;
  }
};

// How far rounding may take a point of the triangle, as interpolated here and as a ray finds it, from its plane, whose
// unit normal is n: a few roundings of the coordinates that the normal sees. Neither a constant, which is beyond the
// far side of a scene of 1e-6 and nothing at 1e6, nor relative to the point, which may lie near the origin on a
// triangle that reaches far. Zero where nothing rounds, as on a floor at z = 0.
inline float clearance(const Placement& p, const Corners& corner, Vec3f n) {
  constexpr float kRoundings = 0x1p-19f;
  const auto reach = [](Vec3f a, Vec3f b, Vec3f c) {
    const auto most = [](float x, float y, float z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); };
    return Vec3f{most(a.x, b.x, c.x), most(a.y, b.y, c.y), most(a.z, b.z, c.z)};
  };
  const auto absolute = [](Vec3f v) { return Vec3f{std::abs(v.x), std::abs(v.y), std::abs(v.z)}; };
  Vec3f r = reach(corner[0], corner[1], corner[2]);
  if (!p.flat) {
    const Affine& m = p.toWorld;
    r = absolute(m.x) * r.x + absolute(m.y) * r.y + absolute(m.z) * r.z + absolute(m.t);
  }
  return kRoundings * dot(absolute(n), r);
}

// How the techniques of lobes are numbered: where there are enough, each class has numbers of its own on all surfaces.
struct LobeNumbers {
  LobeCounts first{}, count{};  // of each class, if byClass
  size_t most = 1;              // lobes of a surface, as far as each has a technique of its own
  bool byClass = false;

  size_t used() const { return byClass ? total(count) : most; }
};

struct Geometry {
  std::vector<Shape> shapes;
  std::vector<Placement> placements;
  std::vector<std::vector<Vec3f>> positions;    // of all shapes, each padded by one vertex
  std::deque<MovingFrame> frames;               // of placements that move
  std::deque<std::vector<const Vec3f*>> moved;  // of shapes that deform
  LobeNumbers lobes;                            // of the shapes' materials
  std::vector<std::unique_ptr<const Strands>> strands;
  uint64_t triangles = 0, segments = 0, spheres = 0;  // placed, instances counted
  Vec3f lower{0, 0, 0}, upper{0, 0, 0};               // bounds, world space

  // catchersAlone: of the shadow catchers; the other placements are there, and have no shapes.
  explicit Geometry(const Scene& scene, bool catchersAlone = false);
  Vec3f center() const { return (lower + upper) * 0.5f; }
  float radius() const { return std::max(length(upper - lower) * 0.5f, 1e-6f); }

  bool moves() const { return !frames.empty() || !moved.empty(); }

  // Of a triangle, in world space.
  static Corners corners(const Placement& p, const Shape& s, uint32_t triangle, float time = kMiddle) {
    Corners c = cornersOf(s, triangle, time);
    if (p.flat) return c;
    if (p.motion != nullptr) [[unlikely]] {
      const Affine m = p.motion->at(time);
      return {m.point(c[0]), m.point(c[1]), m.point(c[2])};
    }
    return {p.toWorld.point(c[0]), p.toWorld.point(c[1]), p.toWorld.point(c[2])};
  }
};

}  // namespace wardmis
