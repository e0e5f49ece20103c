// SPDX-License-Identifier: GPL-3.0-or-later
// Cameras and lights as the file describes them, placed by a node's world matrix.
#pragma once

#include <optional>

#include "gltf/json.h"
#include "gltf/material.h"
#include "scene/scene.h"

namespace wardmis {

// An entry of the extension's `lights`; nullopt if it emits nothing.
std::optional<Light> readLight(const Json& json, const Affine& toWorld, Materials& materials);
// An entry of KHR_lights_punctual's `lights`.
std::optional<Light> readPunctualLight(const Json& json, const Affine& toWorld);

// An entry of `cameras`, on the node `node` (for messages). A camera without the extension is fitted to the film's
// shape, keeping its height.
Camera readCamera(const Json& json, const Json& node, const Affine& toWorld, const Film& film);

}  // namespace wardmis
