// SPDX-License-Identifier: GPL-3.0-or-later
// The error as a picture.
#pragma once

#include "report/image.h"

namespace wardmis {

// Per-pixel relative error |x - r| / (|r| + 0.01) (mean over channels). EXR, by the name: the values as they are. Any
// other format that OpenImageIO writes: from 0 (black) to `scale` (pale yellow) through a map of even lightness, with a
// bar beneath that says what the colours mean. Returns what is to be noted, if anything.
std::string writeDifference(const std::filesystem::path& path, const RgbImage& image, const RgbImage& reference,
                            double scale);

}  // namespace wardmis
