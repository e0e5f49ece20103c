// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "image/image.h"

namespace wardmis {

// Halves both sides `halvings` times, and then until none is longer than `limit` (0: no limit), to one texel at least.
// A texel becomes the mean of the numbers of those that it covers, as they are stored: bytes are rounded to bytes, and
// what is sRGB is averaged so, as in Cycles. What is left over at the upper and right border is lost.
void shrink(Image& image, int halvings, int limit);

}  // namespace wardmis
