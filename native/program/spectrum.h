// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of black bodies and of single wavelengths, as light of linear Rec. 709.
#pragma once

#include <cstdint>

#include "math/vec.h"

namespace wardmis::spectrum {

// Of temperature t in kelvin, of luminance 1; never negative. `version`: see rec709.h.
Rgb blackbody(float t, uint32_t version);
// Of light of one wavelength in nanometres.
Rgb wavelength(float nm, uint32_t version);

}  // namespace wardmis::spectrum
