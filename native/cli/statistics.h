// SPDX-License-Identifier: GPL-3.0-or-later
// The statistics of a render (docs/command.md).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "film/exr.h"
#include "integrate/render.h"

namespace wardmis {

// read, write, total: seconds.
nlohmann::json statisticsJson(const std::string& path, const RenderSettings& settings, const Scene& scene,
                              const Statistics& s, const FilmBuffer& film, double read, double write, double total);

// The part of it that counts, of which those of several renders can be added.
nlohmann::json countsJson(const Counts& counts, const std::vector<std::string>& techniques);
double meanVariance(const FilmBuffer& film);

// As text that is UTF-8 whatever the strings in it are. indent: -1 for one line.
std::string dumped(const nlohmann::json& value, int indent = -1);

// Puts what a reader of the image wants to know into its header.
void describe(ExrImage& image, const nlohmann::json& statistics);

}  // namespace wardmis
