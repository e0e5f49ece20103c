// SPDX-License-Identifier: GPL-3.0-or-later
// `nodes` and `scenes`: the hierarchy, checked, and what it places in the world.
#pragma once

#include <vector>

#include "gltf/accessor.h"
#include "gltf/left_out.h"
#include "gltf/mesh.h"
#include "scene/scene.h"

namespace wardmis {

// Of what kinds of ray an object, a light or a world is seen: its "visibility".
uint8_t readVisibility(const Json& json);

// Fills the scene's instances, lights and camera. The film must have been read. needsCamera: throws if there is none,
// before meshes are read.
void readNodes(const Json& root, Accessors& accessors, Buffers& buffers, Materials& materials, Meshes& meshes,
               LeftOut& leftOut, bool needsCamera, Scene& scene);

}  // namespace wardmis
