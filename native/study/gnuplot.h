// SPDX-License-Identifier: GPL-3.0-or-later
// Figures through gnuplot, which runs as a program of its own.
#pragma once

#include <string>

namespace wardmis {

// Draws `script` (which must not set terminal or output) to an .svg or .png file of the given size in pixels, complete
// or not at all. Throws Error: usage for another ending, file where gnuplot is not installed or fails.
void drawWithGnuplot(const std::string& path, int width, int height, const std::string& script);

// Ends with usage where `path` has another ending than .svg and .png: to be called before the work is done.
void checkPlotName(const std::string& path);

// A label in gnuplot's syntax, nothing in it interpreted.
std::string gnuplotText(const std::string& text);

}  // namespace wardmis
