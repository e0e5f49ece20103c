// SPDX-License-Identifier: GPL-3.0-or-later
// A file appears complete or not at all.
#pragma once

#include <filesystem>
#include <string_view>

namespace wardmis {

// Writes under a temporary name beside `name` (or beside what it links to), then renames. Throws Error(kFile); then no
// file of either name is left.
void writeFile(const std::filesystem::path& name, std::string_view bytes);

}  // namespace wardmis
