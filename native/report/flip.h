// SPDX-License-Identifier: GPL-3.0-or-later
// FLIP for HDR images (Andersson et al. 2021) through its authors' program, where it is installed.
#pragma once

#include <optional>

#include "report/image.h"

namespace wardmis {

// Whether the program `flip` of the package flip-evaluator is on the PATH (another program has the same name).
bool flipInstalled();

// The mean over the image; none where it is not installed, or fails.
std::optional<double> flipError(const RgbImage& image, const RgbImage& reference);

}  // namespace wardmis
