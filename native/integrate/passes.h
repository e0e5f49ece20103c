// SPDX-License-Identifier: GPL-3.0-or-later
// The film as the passes of docs/command.md.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "film/exr.h"
#include "film/film.h"
#include "mis/moments.h"

namespace wardmis {

struct PassInfo {
  std::string name;      // "Combined"
  std::string channels;  // "RGBA"
  std::string group;     // what --passes calls it
};

// All passes of a scene with these techniques.
std::vector<PassInfo> passesFor(TechniqueMask techniques);

// The chosen passes' channels, "<layer>.<pass>.<channel>". zUp: frame of the Normal pass (docs/scene-format.md).
ExrImage toPasses(const FilmBuffer& film, const std::vector<PassInfo>& passes, const std::string& layer, bool zUp);

}  // namespace wardmis
