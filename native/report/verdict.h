// SPDX-License-Identifier: GPL-3.0-or-later
// What to use, and what it brings, in one plain line. It says no more than the intervals do: ties are ties, and where
// an interval is too wide for one, no difference was found.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace wardmis {

constexpr double kAlike = 1e-4;  // of ratios that are one in all that is printed

// The configuration to use, out of those of WardMIS that estimate what the baseline does without a bias: the one that
// is surely sooner than the baseline at the target, the soonest of several; where no time can be compared, the one that
// surely has less error at equal time; else the baseline. Empty where there is nothing to choose: no error, or no
// configuration that may be used.
std::string recommended(const nlohmann::json& report);

// `use` is recommended(); `ratios` by name: its time to the target over that of each other configuration, an interval
// or null. Returns the line.
std::string verdictText(const nlohmann::json& report, const std::string& use, const nlohmann::json& ratios);

// For each configuration that is better than the baseline in one column and worse in another, the sentence that tells
// why.
std::vector<std::string> contradictions(const nlohmann::json& report);

}  // namespace wardmis
