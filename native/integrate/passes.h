// SPDX-License-Identifier: GPL-3.0-or-later
// The film as the passes of docs/command.md.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "film/exr.h"
#include "film/film.h"
#include "mis/technique.h"

namespace wardmis {

struct PassInfo {
  std::string name;      // "Combined"
  std::string channels;  // "RGBA"
  std::string group;     // what --passes calls it
  // of DataPixel, of LightPixel: there only where it is asked for
  bool data = false, light = false;
};

// The pass of a technique's shares: "Allocation Lobe".
std::string allocationPass(const std::string& technique);

// All passes of a scene with these techniques; names: of all that the kernel knows, as Statistics has them.
std::vector<PassInfo> passesFor(TechniqueMask techniques, const std::vector<std::string>& names);
// And those of data and light.
std::vector<PassInfo> passesOnRequest();

// The chosen passes' channels, "<layer>.<pass>.<channel>". zUp: frame of the Normal pass (docs/scene-format.md).
// A pass is called as PassInfo says.
ExrImage toPasses(const FilmBuffer& film, const std::vector<PassInfo>& passes,
                  const std::vector<std::string>& techniqueNames, const std::string& layer, bool zUp);

// Each pixel as a square of `side`, of an image of that size, of which the last ones may lack a part.
ExrImage enlarged(const ExrImage& image, int side, int width, int height);

}  // namespace wardmis
