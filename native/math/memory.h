// SPDX-License-Identifier: GPL-3.0-or-later
// How much memory there is, for refusing what would not fit: Linux gives more than it has, and ends the program later.
#pragma once

#include <cstdint>
#include <string>

namespace wardmis {

// Bytes that the process may still take: of the machine, its control group and its own limits; 2^63 where unknown.
uint64_t availableMemory();

// Throws Error(kMemory) where `bytes` are not there. what: "its objects", say; hint: what would need less.
void requireMemory(uint64_t bytes, const std::string& what, const std::string& hint);

}  // namespace wardmis
