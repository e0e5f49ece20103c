// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/external.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "math/error.h"
#include "report/flip.h"

namespace wardmis {

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

RgbImage readSized(const fs::path& path, const Experiment& e) {
  RgbImage image = readRgb(path);
  if (image.width != e.width || image.height != e.height)
    throw Error(ExitCode::kFile,
                fmt::format("{} has {} x {} pixels, the scene's render {} x {}", path.string(), image.width,
                            image.height, e.width, e.height),
                "render both at the same resolution and border");
  return image;
}

}  // namespace

void addExternal(Experiment& e, const fs::path& manifest, const std::function<void(const std::string&)>& warn) try {
  std::ifstream in(manifest);
  if (!in) throw Error(ExitCode::kFile, manifest.string() + ": cannot be read", "check the path after --external");
  const json j = json::parse(in);
  const fs::path folder = manifest.parent_path();
  Configuration c;
  c.name = j.at("name");
  c.renderer = j.value("renderer", c.name);
  c.described = j.value("settings", json::object());
  c.notes = j.value("notes", std::vector<std::string>{});
  c.external = true;
  c.common = j.value("common_reference", false);
  for (const Configuration& other : e.configurations)
    if (other.name == c.name)
      throw Error(ExitCode::kUsage, fmt::format("{}: there is a configuration '{}' already", manifest.string(), c.name),
                  "give it another \"name\"");

  std::vector<fs::path> images;
  for (const json& path : j.at("reference").at("images")) images.push_back(folder / path.get<std::string>());
  if (images.empty()) throw Error(ExitCode::kFile, manifest.string() + ": \"reference\" has no images", "add two");
  if (images.size() < 2 && warn)
    warn(fmt::format("{}: one reference image: its own noise is unknown and is not subtracted", manifest.string()));
  ImageMean mean;
  for (const fs::path& path : images) mean.add(readSized(path, e));
  Reference r;
  r.estimates = c.name, r.path = images.front(), r.chunks = mean.count();
  r.image = mean.mean();
  r.setVariance(mean.variance());
  r.spp = j.at("reference").value("spp", 0u) * r.chunks;
  c.reference = e.references.size();
  e.references.push_back(std::move(r));
  const RgbImage& truth = e.references[c.common ? 0 : c.reference].image;

  std::map<uint64_t, Run> runs;
  std::map<uint64_t, RgbImage> last;
  std::vector<json> entries = j.at("runs").get<std::vector<json>>();
  std::stable_sort(entries.begin(), entries.end(), [](const json& a, const json& b) {
    return a.at("spp").get<uint32_t>() < b.at("spp").get<uint32_t>();
  });
  for (const json& entry : entries) {
    const uint64_t seed = entry.at("seed");
    Run& run = runs[seed];
    run.seed = seed;
    Checkpoint at;
    at.spp = entry.at("spp");
    at.time.wall = entry.at("wall");
    if (at.spp < 1 || !(at.time.wall > 0))
      throw Error(ExitCode::kFile,
                  fmt::format("{}: a run of {} samples in {} s", manifest.string(), at.spp, at.time.wall),
                  "give both as they were");
    at.cpuKnown = entry.contains("cpu") && !entry.at("cpu").is_null();
    if (at.cpuKnown) at.time.cpu = entry.at("cpu");
    at.cameraRays = uint64_t{at.spp} * truth.pixels();
    run.image = folder / entry.at("path").get<std::string>();
    RgbImage image = readSized(run.image, e);
    at.error = compareImages(image, truth);
    last[seed] = std::move(image);
    run.checkpoints.push_back(at);
  }
  const auto sppOf = [](const Run& run) {
    std::vector<uint32_t> spp;
    for (const Checkpoint& c : run.checkpoints) spp.push_back(c.spp);
    return spp;
  };
  std::vector<uint32_t> all;
  for (const auto& [seed, run] : runs)
    if (run.checkpoints.size() > all.size()) all = sppOf(run);
  std::vector<Run> complete;
  for (auto& [seed, run] : runs) {
    if (sppOf(run) != all) continue;  // it was stopped there
    run.flip = flipError(last[seed], truth);
    complete.push_back(std::move(run));
  }
  if (complete.size() < 2)
    throw Error(ExitCode::kFile,
                fmt::format("{}: {} complete seeds; statistics need two", manifest.string(), complete.size()),
                "render more seeds");
  e.configurations.push_back(std::move(c));
  e.runs.push_back(std::move(complete));
} catch (const json::exception& x) {
  throw Error(ExitCode::kFile, fmt::format("{}: {}", manifest.string(), x.what()),
              "docs/report-format.md says what it must hold");
}

}  // namespace wardmis
