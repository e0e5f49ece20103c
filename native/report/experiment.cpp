// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/experiment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "film/exr.h"
#include "math/error.h"

namespace wardmis {

using nlohmann::json;

std::string estimates(const RenderSettings& s) {
  const PathLimits limits = s.limits();
  if (!limits.bounce(false)) return "direct light";
  std::string text = fmt::format("paths, depth {}", limits.depth);
  for (const auto& [kind, bounces] :
       {std::pair{"diffuse", limits.bounces[kDiffuseBounce]}, {"glossy", limits.bounces[kGlossyBounce]}})
    if (bounces < limits.depth - 1) text += fmt::format(", {} {} bounces", bounces, kind);
  return text;
}

void Reference::setVariance(std::vector<float> v) {
  variance = std::move(v);
  mseFloor = relMseFloor = trimmedFloor = 0;
  std::vector<double> shares(variance.size() / 3);
  for (size_t i = 0; i < variance.size(); ++i) {
    const double r = double(image.rgb[i]), n = double(variance.size());
    mseFloor += double(variance[i]) / n;
    relMseFloor += double(variance[i]) / (r * r + kRelMseEpsilon) / n;
    shares[i / 3] += double(variance[i]) / (r * r + kRelMseEpsilon) / 3;
  }
  std::sort(shares.begin(), shares.end());
  const size_t keep = shares.size() - (shares.size() + 999) / 1000;
  for (size_t i = 0; i < keep; ++i) trimmedFloor += shares[i] / double(keep);
}

json toJson(const Run& run) {
  json checkpoints = json::array();
  for (const Checkpoint& c : run.checkpoints) {
    json j{{"spp", c.spp},
           {"wall", c.time.wall},
           {"cpu", c.cpuKnown ? json(c.time.cpu) : json()},
           {"camera_rays", c.cameraRays},
           {"rays", c.rays}};
    for (const MetricInfo& m : allMetrics()) j[m.name] = c.error.*m.value;
    checkpoints.push_back(std::move(j));
  }
  const Counts& n = run.counts;
  return {{"seed", run.seed},
          {"pilot_seconds", run.pilotSeconds},
          {"flip", run.flip ? json(*run.flip) : json()},
          {"calibration_seconds", run.calibration},
          {"load", run.load},
          {"samples", n.samples},
          {"camera_rays", n.cameraRays},
          {"rays", n.rays},
          {"light_rays", n.lightRays},
          {"connections", n.connections},
          {"dropped", {n.rare.nan, n.rare.infinite, n.rare.negative}},
          {"checkpoints", std::move(checkpoints)}};
}

namespace {

// A time or an error.
double measured(const json& j) {
  const double x = j;
  if (!(x >= 0 && std::isfinite(x))) throw std::domain_error("a negative time or error");
  return x;
}

}  // namespace

Run runFromJson(const json& j) {
  Run run;
  run.seed = j.at("seed");
  run.pilotSeconds = measured(j.at("pilot_seconds"));
  if (!j.at("flip").is_null()) run.flip = measured(j.at("flip"));
  run.calibration = measured(j.at("calibration_seconds")), run.load = measured(j.at("load"));
  j.at("samples").get_to(run.counts.samples);
  run.counts.cameraRays = j.at("camera_rays");
  j.at("rays").get_to(run.counts.rays);
  run.counts.lightRays = j.value("light_rays", uint64_t{0}),
  run.counts.connections = j.value("connections", uint64_t{0});
  const auto dropped = j.at("dropped").get<std::array<uint64_t, 3>>();
  run.counts.rare.nan = dropped[0], run.counts.rare.infinite = dropped[1], run.counts.rare.negative = dropped[2];
  for (const json& c : j.at("checkpoints")) {
    Checkpoint at;
    at.spp = c.at("spp");
    at.time.wall = measured(c.at("wall"));
    at.cpuKnown = !c.at("cpu").is_null();
    if (at.cpuKnown) at.time.cpu = measured(c.at("cpu"));
    at.cameraRays = c.at("camera_rays"), at.rays = c.at("rays");
    for (const MetricInfo& m : allMetrics()) at.error.*m.value = measured(c.at(m.name));
    run.checkpoints.push_back(at);
  }
  return run;
}

std::string folderName(const std::string& name) {
  std::string folder;
  for (const char c : name)
    folder += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || (c & 0x80) != 0 ? c : '_';
  return folder.empty() ? "_" : folder;
}

void ImageMean::add(const RgbImage& image) {
  width_ = image.width, height_ = image.height, ++count_;
  sum_.resize(image.rgb.size()), squares_.resize(image.rgb.size());
  for (size_t i = 0; i < sum_.size(); ++i) {
    const double v = double(image.rgb[i]);
    sum_[i] += v, squares_[i] += v * v;
  }
}

RgbImage ImageMean::mean() const {
  RgbImage image{width_, height_, std::vector<float>(sum_.size())};
  for (size_t i = 0; i < sum_.size(); ++i) image.rgb[i] = static_cast<float>(sum_[i] / count_);
  return image;
}

std::vector<float> ImageMean::variance() const {
  if (count_ < 2) return {};
  std::vector<float> variance(sum_.size());
  for (size_t i = 0; i < sum_.size(); ++i) {
    const double mean = sum_[i] / count_;
    variance[i] = static_cast<float>(std::max(0.0, squares_[i] / count_ - mean * mean) / (count_ - 1));
  }
  return variance;
}

RgbImage toRgb(const FilmBuffer& film) {
  RgbImage image{film.width, film.height, std::vector<float>(3 * film.pixels.size())};
  float* to = image.rgb.data();
  for (int y = film.height - 1; y >= 0; --y)
    for (int x = 0; x < film.width; ++x) {
      const auto c = film.combined(static_cast<size_t>(y) * static_cast<size_t>(film.width) + static_cast<size_t>(x));
      *to++ = c[0], *to++ = c[1], *to++ = c[2];
    }
  return image;
}

RgbImage rgbOf(const ExrImage& from, const std::filesystem::path& path) {
  RgbImage image{from.width, from.height, {}};
  const std::vector<float>* channels[3];
  for (size_t c = 0; c < 3; ++c)
    if (channels[c] = from.channel(std::string("ViewLayer.Combined.") + "RGB"[c]); channels[c] == nullptr)
      throw Error(ExitCode::kFile, fmt::format("{}: has no channel ViewLayer.Combined.{}", path.string(), "RGB"[c]),
                  "the file is none of this study's; delete it");
  image.rgb.resize(3 * channels[0]->size());
  for (size_t i = 0; i < channels[0]->size(); ++i)
    for (size_t c = 0; c < 3; ++c) image.rgb[3 * i + c] = (*channels[c])[i];
  return image;
}

}  // namespace wardmis
