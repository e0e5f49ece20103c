// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of an image's camera samples, rendered apart: what a film has summed up, to the bit, as channels of an EXR, and
// the sum of two films.
#pragma once

#include "film/exr.h"
#include "film/film.h"

namespace wardmis {

// What the channels' names begin with.
inline constexpr const char* kPartChannel = "part.";

// Everything that the film has of its pixels, as whole numbers of 32 bits: as many channels as a pixel has of these.
std::vector<ExrWords> wordsOf(const FilmBuffer& film);

// The inverse, into a film of the same size that keeps the same (data, light, catchers). False where the channels do
// not fit it.
bool setWords(FilmBuffer& film, const std::vector<ExrWords>& words);

// Adds the samples of `more`, a film of the same image that keeps the same, and whose samples follow those of `film`.
void append(FilmBuffer& film, const FilmBuffer& more);

}  // namespace wardmis
