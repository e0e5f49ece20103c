// SPDX-License-Identifier: GPL-3.0-or-later
// The report as files: report.json, CSV tables, and report.html, which needs nothing but a browser.
#pragma once

#include <filesystem>

#include "report/analysis.h"

namespace wardmis {

// Writes report.json, curves.csv, configurations.csv, groups.csv, images/*.exr and report.html, in this order. Throws
// Error(kFile).
void writeReport(const std::filesystem::path& folder, const Analysis& analysis);

}  // namespace wardmis
