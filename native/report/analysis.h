// SPDX-License-Identifier: GPL-3.0-or-later
// From what was measured to what is reported: every number of docs/report-format.md.
#pragma once

#include "report/experiment.h"
#include "report/pictures.h"

namespace wardmis {

struct Analysis {
  nlohmann::json report;  // report.json
  std::vector<Picture> pictures;
  std::vector<std::pair<std::string, ExrImage>> images;  // for images/: a configuration's mean, and its error
};

// told: the share of the work that is done. Throws Error(kUsage) where a configuration has fewer than two seeds.
Analysis analyse(const Experiment& experiment, const std::function<void(double)>& told);

// The first paragraph, in words, from the numbers of the report.
std::vector<std::string> finding(const nlohmann::json& report);

// What to say beside the map of who wins where most of its blocks seem to contradict the finding; else nothing. `wins`
// and `timeToTarget` are a configuration's in the report.
std::string mapRemark(const std::string& name, const std::string& baseline, const nlohmann::json& wins,
                      const nlohmann::json& timeToTarget);

}  // namespace wardmis
