// SPDX-License-Identifier: GPL-3.0-or-later
// Where figures come from: the program, the machine, and its state.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

namespace wardmis {

nlohmann::json machineJson();  // version, compiler, flags, cpu, isa, cores, system

std::string timestamp();  // UTC, ISO 8601
double loadAverage();     // of the last minute; 0 where unknown

// Seconds of a fixed loop of one thread: what changes between two of them is the machine.
double calibrate();

// FNV-1a of the files' bytes, 64 bits, in hexadecimal; of a further file its length comes before them. Throws
// Error(kFile) if the first one cannot be read: what a scene misses is missing, until it is there.
std::string hashOf(std::span<const std::filesystem::path> files);

}  // namespace wardmis
