// SPDX-License-Identifier: GPL-3.0-or-later
// OpenImageIO, loaded when the first image wants it: its 250 libraries would cost every start of the command 0.3 s, and
// the packaged add-on 330 MB.
#pragma once

#include "image/oiio_interface.h"

namespace wardmis {

// Throws std::runtime_error that says why there is no OpenImageIO here.
const OiioInterface& oiio();

}  // namespace wardmis
