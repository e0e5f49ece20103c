// SPDX-License-Identifier: GPL-3.0-or-later
// Strict reader of GLB and glTF files with the WARDMIS_scene extension (docs/scene-format.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "scene/scene.h"

namespace wardmis {

inline constexpr int kLargestSide = 1 << 16;  // of a frame, in pixels

// Reads and checks a scene. Geometry is a view into the mapped file where its layout allows. Images and UVs that no
// material in use needs are not loaded (and listed in Scene::leftOut).
// Throws Error(kFile) if the file cannot be opened, Error(kScene) if anything in it is wrong, naming the JSON path.
// needsCamera: one without a camera is refused at once, before its meshes and images are read.
Scene readGlb(const std::filesystem::path& path, bool needsCamera = false);

// The same from memory (tests and fuzzing). `folder` is where relative URIs may point to; empty: nowhere.
Scene readGlb(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name);

}  // namespace wardmis
