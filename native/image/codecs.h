// SPDX-License-Identifier: GPL-3.0-or-later
// Draco, meshoptimizer and libwebp, loaded when the first mesh or image of a scene wants one of them. The packaged
// add-on needs none.
#pragma once

#include <string>

#include "image/codecs_interface.h"

namespace wardmis {

// All pointers are null where there is no module.
const CodecsInterface& codecs();

// Why a library of that name is not there, as part of a sentence.
std::string codecMissing(const char* library);

}  // namespace wardmis
