// SPDX-License-Identifier: GPL-3.0-or-later
// The images of a report: those of its page, and those beside it.
#pragma once

#include "film/exr.h"
#include "report/measured.h"
#include "report/pictures.h"

namespace wardmis {

// For the page's viewer: renders, errors, allocations and maps. `configurations`: those of report.json, in the order of
// `measured`.
std::vector<Picture> gallery(const Experiment& e, const std::vector<Measured>& measured,
                             const nlohmann::json& configurations);

// For images/: name and content of each configuration's mean, and of its error.
std::vector<std::pair<std::string, ExrImage>> imageFiles(const Experiment& e, const std::vector<Measured>& measured);

}  // namespace wardmis
