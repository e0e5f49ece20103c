// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the image files of a scene: PNG, JPEG, OpenEXR and Radiance HDR, told apart by their first bytes.
// Through the formats' own libraries: linking OpenImageIO costs every start of the command 0.25 s and the package 330 MB.
#pragma once

#include <cstddef>
#include <span>

#include "scene/scene.h"

namespace wardmis {

// The pixels as the file has them, rows from the bottom. 8-bit files stay 8-bit; 16-bit files become floats in 0..1 that
// are still encoded as the file had them: `integers`.
struct FileImage {
  Image image;
  bool integers = false;
};

// Throws std::runtime_error saying what is wrong (the caller knows the image's name and place).
FileImage readImageFile(std::span<const std::byte> file);

}  // namespace wardmis
