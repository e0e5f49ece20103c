// SPDX-License-Identifier: GPL-3.0-or-later
// KHR_draco_mesh_compression: the vertices and triangles of one primitive.
#pragma once

#include "gltf/file.h"
#include "scene/scene.h"

namespace wardmis {

struct DracoPrimitive {
  Array<Vec3f> positions, normals;  // normals, uvs: empty if they are not there; not finite ones are 0
  Array<Vec2f> uvs;                 // as in the file, v down
  Array<uint32_t> indices;          // 3 per triangle
  size_t mended = 0;                // normals and uvs that were not finite
};

// Whether the command has come with Draco.
bool hasDraco();

// `extension`: of the primitive; uvs: the attribute to read for them, empty for none.
DracoPrimitive readDraco(const Json& extension, const std::string& uvs, Buffers& buffers);

}  // namespace wardmis
