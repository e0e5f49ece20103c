// SPDX-License-Identifier: GPL-3.0-or-later
// Lobes of fibres (sheen.h) over the root of the view's cosine (fastest) and roughness, each from 0 to 1 in 31 even
// steps: the two numbers of the transformation, and the albedo; 0 where there is no lobe. Measured and fitted by
// tools/fibre_table.py.
#pragma once

#include <cstdint>

namespace wardmis::fibre {

inline constexpr int kSteps = 32;
extern const uint16_t kScale[kSteps * kSteps];  // times 65535
extern const int16_t kSkew[kSteps * kSteps];    // times 32767
extern const uint16_t kAlbedo[kSteps * kSteps];

}  // namespace wardmis::fibre
