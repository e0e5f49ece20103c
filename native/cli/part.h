// SPDX-License-Identifier: GPL-3.0-or-later
// A part of an image's samples as a file: an image of its own samples, with the film's sums to the bit beside it, and
// in its header what it is a part of.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "film/exr.h"
#include "film/film.h"
#include "integrate/passes.h"
#include "integrate/render.h"

namespace wardmis {

// What is written is made of this, besides the film.
struct ImageDescription {
  std::string layer;
  bool zUp = false;
  std::vector<PassInfo> passes;
  std::vector<std::string> techniqueNames;
};
ExrImage toImage(const FilmBuffer& film, const ImageDescription& description);

// Makes `image`, of this film, a part. whole: `samples`, those of the image, and what else its parts have alike; the
// rest is added. statistics: of this render.
void makePart(ExrImage& image, const FilmBuffer& film, nlohmann::json whole, const ImageDescription& description,
              const nlohmann::json& statistics, const nlohmann::json& pilotCounts);

// A part's header.
struct PartHeader {
  std::string path;
  SampleRange range;
  nlohmann::json whole;        // what all parts of one image have alike
  nlohmann::json statistics;   // of the render that made it
  nlohmann::json pilotCounts;  // of these, those of a pilot that is not among its samples
  std::string words;           // hash of its sums

  uint32_t of() const;  // samples that the image has
  ImageDescription description() const;
};

// Throws Error(kFile) where the file is no part.
PartHeader readPartHeader(const std::string& path);
// Its film. Throws Error(kFile).
FilmBuffer readPart(const PartHeader& header);

}  // namespace wardmis
