// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of options that CLI11's own let through: NaN in a range, "-1" as a large number, nothing as a name.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>

namespace wardmis {

// A finite number in [low, high].
CLI::Validator between(double low, double high);

// A whole number of 64 bits without a sign, for --seed.
CLI::Validator wholeNumber();

// Anything but nothing, for every option that has a value.
CLI::Validator notEmpty();

// At most `longest` bytes.
CLI::Validator notLonger(size_t longest);

}  // namespace wardmis
