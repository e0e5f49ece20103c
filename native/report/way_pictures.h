// SPDX-License-Identifier: GPL-3.0-or-later
// What each way to make a path brings, for the report: numbers, and the pyramid of small images.
#pragma once

#include <nlohmann/json.hpp>

#include "integrate/way_survey.h"
#include "report/pictures.h"

namespace wardmis {

// null where there are no paths from the lights. samplesPerHit: that are asked for.
nlohmann::json waysJson(const WaySurvey& survey, int samplesPerHit);

// With their weights and alone; a row for each length of paths, from those that the camera made alone to those that are
// traced to the film. None where there are none.
std::vector<Picture> wayPictures(const std::string& configuration, const WaySurvey& survey);

}  // namespace wardmis
