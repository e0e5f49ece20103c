// SPDX-License-Identifier: GPL-3.0-or-later
// A whole render: set-up, pilot, passes over the image, statistics.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "film/error_estimate.h"
#include "film/film.h"
#include "integrate/counts.h"
#include "integrate/settings.h"
#include "mis/ways.h"
#include "scene/scene.h"

namespace wardmis {

// Camera samples per pixel of a pilot that is not part of the image: that of `auto`, which is coarse; 0 where it is.
// The evenness of Sobol's points is that of all points of a technique: a few of other weights undo it, and where the
// light is smooth, these are most of the error.
double pilotApart(const RenderSettings&);

struct Clocks {
  double wall = 0, cpu = 0;  // seconds; cpu: of all threads

  Clocks operator-(const Clocks& b) const { return {wall - b.wall, cpu - b.cpu}; }
  Clocks& operator+=(const Clocks& b) { return *this = {wall + b.wall, cpu + b.cpu}; }
};

struct Statistics {
  double buildSeconds = 0, pilotSeconds = 0, renderSeconds = 0;  // wall; render excludes the pilot
  double pilotCpuSeconds = 0, renderCpuSeconds = 0;
  Counts counts;
  Counts pilotCounts;  // of these, what a pilot that is not part of the image took
  uint32_t needs = 0, kernel = 0;
  std::vector<std::string> leftOut;
  std::vector<std::string> doubts;  // of what is seen, for the user
  uint64_t triangles = 0, instances = 0, emissiveTriangles = 0;
  int threads = 0;
  TechniqueMask techniques = 0;             // those that the scene has
  std::vector<std::string> techniqueNames;  // of all that the kernel knows
  bool allocated = false;                   // a pilot ran and counts were allocated by it
  bool pilotKept = false;                   // its samples are part of the image
  std::vector<float> cost;                  // of a sample of each technique, that the allocation took into account
  float costOfHit = 0;                      // a share of a hit's own, in the same unit
  double pixelGain = 1;           // of error x time, that unequal samples of pixels are to bring; 1: all have as many
  double hiddenLights = 1;        // LightVisibility::learn(), where lights are drawn by it; 1: they are not
  std::optional<WayCounts> ways;  // in mean over the pixels; none: there are no paths from the lights
  bool lightTracing = false;      // they are traced to the film, too
  double wayGain = 1;  // of second moment x cost, that chosen numbers of ways have over paths from the camera alone
  Clocks wayPilot;     // what choosing them took
  std::optional<EstimatedError> error;  // the last estimate, where an error is aimed at
};

struct Progress {
  bool pilot = false;
  uint32_t samples = 0;  // complete ones of every pixel
  uint32_t of = 0;       // 0: not known before
  double fraction = 0, seconds = 0;
  std::optional<double> left;  // none: not known yet
};

enum class Stop : int { kNo = 0, kKeep, kDiscard };  // stop, keeping the image so far or not

// What a caller wants to hear. Called from one thread at a time, between passes or every quarter of a second.
struct RenderObserver {
  std::function<void(const Statistics&)> started;  // needs and what is left out are known
  std::function<void(const Progress&)> progress;
  // Between passes: the film, at rest, whose pixels are squares of `side` pixels of the image. A few coarse ones come
  // first, then the pilot's if it is no part of the image. Of a long pass the parts are seen, and there may be pixels
  // without samples among them.
  std::function<void(const FilmBuffer&, int side)> image;
  // At 1, 2, 4, 8 ... samples and the last: the film, the time so far from the pilot's start on, what was counted. The
  // time that it takes itself does not count. Without a limit of time alone.
  std::function<void(const FilmBuffer&, const Clocks&, const Counts&)> checkpoint;
  const std::atomic<Stop>* stop = nullptr;
};

struct BuiltScene;  // integrate/setup.h

// Renders scene.film's border. Throws Error.
FilmBuffer render(const BuiltScene& built, const RenderSettings& settings, Statistics& statistics,
                  const RenderObserver& observer = {});
// The same for one render alone.
FilmBuffer render(const Scene& scene, const RenderSettings& settings, Statistics& statistics,
                  const RenderObserver& observer = {});

}  // namespace wardmis
