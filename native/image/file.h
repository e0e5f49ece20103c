// SPDX-License-Identifier: GPL-3.0-or-later
// Reads the image files of a scene, told apart by their first bytes: PNG, JPEG and OpenEXR, which every copy of the
// command must read, through their own libraries, all others through OpenImageIO where the command comes with it.
#pragma once

#include <cstddef>
#include <span>

#include "image/image.h"

namespace wardmis {

// The pixels as the file has them, rows from the bottom. 8-bit files stay 8-bit; 16-bit files become floats in 0..1
// that are still encoded as the file had them: `integers`.
struct FileImage {
  Image image;
  bool integers = false;
};

// Throws std::runtime_error saying what is wrong (the caller knows the image's name and place).
FileImage readImageFile(std::span<const std::byte> file);

}  // namespace wardmis
