// SPDX-License-Identifier: GPL-3.0-or-later
// The command's verbs. Each adds its options to the parser and gives back what is to run: it returns the exit code.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace wardmis {

using Verb = std::function<int()>;

Verb addRender(CLI::App& app);
Verb addMerge(CLI::App& app);
Verb addInfo(CLI::App& app);
Verb addCompare(CLI::App& app);
Verb addConverge(CLI::App& app);
Verb addStudy(CLI::App& app);
Verb addEval(CLI::App& app);
Verb addStability(CLI::App& app);

}  // namespace wardmis
