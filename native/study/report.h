// SPDX-License-Identifier: GPL-3.0-or-later
// A study as a table, JSON, CSV and a figure.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "study/trials.h"

namespace wardmis {

// A study of one case at one or more numbers of samples.
struct Study {
  StudyInput input;
  Exact exact;
  Densities costNanoseconds{};  // measured, of one sample of each technique
  std::vector<TrialSettings> settings;
  std::vector<std::vector<StrategyRun>> runs;  // by settings
  double seconds = 0;                          // all of it
};

std::string studyTable(const Study&);
nlohmann::json studyJson(const Study&);
std::string studyCsv(const Study&);
void plotStudy(const Study&, const std::string& path);

}  // namespace wardmis
