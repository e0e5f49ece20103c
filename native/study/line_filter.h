// SPDX-License-Identifier: GPL-3.0-or-later
// A program in a pipe: lines in, lines out.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <functional>
#include <string_view>

namespace wardmis {

// What becomes of one line, whose number begins at 1; the end of line is cut off.
using LineFunction = std::function<void(std::string_view line, uint64_t number, fmt::memory_buffer& out)>;

inline constexpr size_t kMaxLine = 4096;

// Reads the descriptor `in` to its end, and writes to `out` before each wait for more, so that a program may write a
// line and read its answer. Ends quietly when nobody reads `out` any more. What came before a line that throws is
// written.
void filterLines(int in, int out, const LineFunction& function);

}  // namespace wardmis
