// SPDX-License-Identifier: GPL-3.0-or-later
// The relative squared error of images, mean (x - r)^2 / (r^2 + epsilon), as it is measured against a reference and
// told by an image's own samples.
#pragma once

#include <cstddef>

namespace wardmis {

inline constexpr double kRelMseEpsilon = 0.01;

// Of so many pixels, those that the trimmed one has: all but the 0.1 % of most error, at least one.
constexpr size_t keptOfTrimmed(size_t pixels) { return pixels - (pixels + 999) / 1000; }

}  // namespace wardmis
