// SPDX-License-Identifier: GPL-3.0-or-later
// A comparison of configurations on one scene: who takes part, and what was measured. Kept on disk run by run, so that
// what is done is never lost (docs/report-format.md).
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "film/exr.h"
#include "integrate/survey.h"
#include "integrate/way_survey.h"
#include "report/image.h"
#include "report/metrics.h"

namespace wardmis {

// Which light the images of these settings converge to.
std::string estimates(const RenderSettings& settings);

// One way of rendering the scene.
struct Configuration {
  std::string name, renderer = "WardMIS";
  RenderSettings settings;   // of WardMIS
  nlohmann::json described;  // the settings, for the report
  std::vector<std::string> leftOut, notes;
  std::string kernel;
  size_t reference = 0;   // index into Experiment::references
  bool external = false;  // rendered by another program, from a manifest
  bool common = false;    // external: held against WardMIS' own reference
};

struct Checkpoint {
  uint32_t spp = 0;
  Clocks time;
  bool cpuKnown = true;
  Metrics error;
  uint64_t cameraRays = 0, rays = 0;  // rays: all kinds; 0 where unknown
};

// One seed of one configuration.
struct Run {
  uint64_t seed = 0;
  std::vector<Checkpoint> checkpoints;  // spp increasing
  double pilotSeconds = 0;
  Counts counts;                     // at the last checkpoint
  std::filesystem::path image;       // its last image
  std::optional<double> flip;        // of the last image, where the library is installed
  double calibration = 0, load = 0;  // seconds of a fixed loop just before it; the system's load average
};

// What images converge to.
struct Reference {
  std::string estimates;  // which light: "paths, depth 8"
  std::filesystem::path path;
  bool made = false;  // by us, else given
  RgbImage image;
  std::vector<float> variance;  // of the image, per value; empty if unknown
  uint32_t spp = 0, chunks = 0;
  double seconds = 0;
  // Its variance's share of an error; 0 where unknown. Trimmed: without the largest 0.1 % of the shares, about what the
  // trimmed relMSE has of it, whose pixels may be others.
  double mseFloor = 0, relMseFloor = 0, trimmedFloor = 0;

  bool known() const { return !variance.empty(); }
  void setVariance(std::vector<float> v);  // once there is the image
};

struct Experiment {
  std::filesystem::path folder;
  std::string title;
  const Scene* scene = nullptr;
  int width = 0, height = 0;
  std::vector<Configuration> configurations;
  size_t baseline = 0;
  std::vector<uint64_t> seeds;
  std::vector<uint32_t> checkpoints;
  std::vector<Reference> references;
  std::vector<std::vector<Run>> runs;  // of each configuration, by seed
  Survey survey;
  std::vector<WaySurvey> ways;  // of each configuration of ours
  std::optional<double> target;
  bool complete = false;
  std::array<double, kMaxTechniques> sampleCost{};  // CPU seconds of one sample of each technique
  std::string started, ended, command, sceneHash;
  int threads = 0;
  const BuiltScene* built = nullptr;  // knows the names of what each pixel shows
};

nlohmann::json toJson(const Run& run);
Run runFromJson(const nlohmann::json& j);  // throws nlohmann::json::exception, std::domain_error

// A configuration's name as a folder's.
std::string folderName(const std::string& name);

// The mean of independent images of one size, and its variance.
class ImageMean {
 public:
  void add(const RgbImage& image);
  uint32_t count() const { return count_; }
  RgbImage mean() const;
  std::vector<float> variance() const;  // of the mean, per value; empty with fewer than two

 private:
  int width_ = 0, height_ = 0;
  uint32_t count_ = 0;
  std::vector<double> sum_, squares_;
};

RgbImage toRgb(const FilmBuffer& film);

// The image of a run or reference that we wrote ourselves: Combined as RGB.
RgbImage rgbOf(const ExrImage& image, const std::filesystem::path& path);

}  // namespace wardmis
