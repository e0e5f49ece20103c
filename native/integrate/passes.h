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
  bool data = false;     // of DataPixel: there only where it is asked for
};

// The pass of a technique's shares: "Allocation Lobe".
std::string allocationPass(const std::string& technique);

// All passes of a scene with these techniques, those of data last; names: of all that the kernel knows, as Statistics
// has them.
std::vector<PassInfo> passesFor(TechniqueMask techniques, const std::vector<std::string>& names);

// The chosen passes' channels, "<layer>.<pass>.<channel>". zUp: frame of the Normal pass (docs/scene-format.md).
// A pass is called as PassInfo says.
ExrImage toPasses(const FilmBuffer& film, const std::vector<PassInfo>& passes,
                  const std::vector<std::string>& techniqueNames, const std::string& layer, bool zUp);

}  // namespace wardmis
