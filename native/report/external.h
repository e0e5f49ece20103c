// SPDX-License-Identifier: GPL-3.0-or-later
// Renders of another program, by a manifest (docs/report-format.md).
#pragma once

#include <functional>

#include "report/experiment.h"

namespace wardmis {

// Whether it is a manifest: all but its images. Throws Error(kFile).
nlohmann::json readManifest(const std::filesystem::path& manifest);

// Adds the manifest's renderer as a configuration, with its reference and its runs. Throws Error(kFile).
void addExternal(Experiment& experiment, const std::filesystem::path& manifest,
                 const std::function<void(const std::string&)>& warn);

}  // namespace wardmis
