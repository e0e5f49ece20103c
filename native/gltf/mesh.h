// SPDX-License-Identifier: GPL-3.0-or-later
// `meshes`: triangles, with strips and fans converted and degenerate triangles dropped; curves and spheres.
#pragma once

#include <vector>

#include "gltf/accessor.h"
#include "gltf/left_out.h"
#include "gltf/material.h"
#include "scene/scene.h"

namespace wardmis {

// What a program reads of the vertices: names of the file's attributes in its order; empty where there is none.
struct ProgramVertices {
  std::vector<std::string> names;
  std::string generated;
};

class Meshes {
 public:
  Meshes(const Json& root, Accessors& accessors, Buffers& buffers, Materials& materials, LeftOut& leftOut);

  // The index in Scene::meshes of the mesh whose index stands at `use`; read when it is first used. -1: nothing to
  // render.
  int use(const Json& use);
  // From here on also where no material looks anything up by them.
  void keepUvs() { keepUvs_ = true; }
  void finish(Scene& scene);

 private:
  Mesh read(const Json& json);
  // decoded: the triangles' indices, where they do not come from an accessor.
  Array<uint32_t> triangles(const Json& primitive, const Array<Vec3f>& positions, const Json& position,
                            const Array<uint32_t>* decoded);
  // The segments of curves, or the spheres, of a primitive whose extension has a shape.
  Primitive strands(const Json& primitive, Form form, const Json& position, const MeshPart& part);
  void readProgramVertices(const ProgramVertices& wanted, const Json& attributes, MeshPart& part, size_t& bad);
  void readMotion(const Json& json, MeshPart& part);
  Array<Vec2f> turned(const Array<Vec2f>& uvs, const Json& place);
  Array<uint32_t> withoutDegenerate(const Json& place, Array<uint32_t> indices, std::span<const Vec3f> positions);

  JsonArray meshes_;
  Accessors& accessors_;
  Buffers& buffers_;
  Materials& materials_;
  LeftOut& leftOut_;
  std::vector<Mesh> read_;
  std::unordered_map<size_t, int> meshOf_;  // by index in the file
  bool keepUvs_ = false;
  uint64_t triangles_ = 0, degenerate_ = 0;
};

}  // namespace wardmis
