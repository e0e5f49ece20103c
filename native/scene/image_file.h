// SPDX-License-Identifier: GPL-3.0-or-later
// Decodes the image files of a scene: PNG, JPEG, OpenEXR and Radiance HDR, told apart by their first bytes.
// Through the formats' own libraries: linking OpenImageIO costs every start of the command 0.25 s and the package 330 MB.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "scene/scene.h"

namespace wardmis {

// `srgb`: the values of an integer file (PNG, JPEG) are sRGB-encoded colours. Float files are linear.
// 8-bit files stay 8-bit; 16-bit files become linear floats.
// Throws Error(kScene) that names the image if the file is damaged, of another format, or larger than 2^28 values.
Image decodeImage(std::span<const std::byte> file, const std::string& name, bool srgb);

}  // namespace wardmis
