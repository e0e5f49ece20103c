// SPDX-License-Identifier: GPL-3.0-or-later
// Colours of black bodies and of single wavelengths, as light of linear Rec. 709.
#pragma once

#include "math/vec.h"

namespace wardmis::spectrum {

// Of temperature t in kelvin, of luminance 1; never negative.
Rgb blackbody(float t);
// Of light of one wavelength in nanometres.
Rgb wavelength(float nm);

}  // namespace wardmis::spectrum
