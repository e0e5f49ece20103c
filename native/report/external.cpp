// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/external.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

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

[[noreturn]] void fail(const fs::path& manifest, const std::string& what) {
  throw Error(ExitCode::kFile, fmt::format("{}: {}", manifest.string(), what),
              "docs/report-format.md says what it must hold");
}

}  // namespace

json readManifest(const fs::path& manifest) try {
  if (!fs::is_regular_file(manifest))
    throw Error(ExitCode::kFile, manifest.string() + ": is no file", "check the path after --external");
  std::ifstream in(manifest);
  if (!in) throw Error(ExitCode::kFile, manifest.string() + ": cannot be read", "check the path after --external");
  json j = json::parse(in);
  if (j.at("name").get<std::string>().empty()) fail(manifest, "\"name\" is empty");
  if (j.at("reference").at("images").empty()) fail(manifest, "\"reference\" has no images");
  std::set<std::pair<uint64_t, uint64_t>> seen;
  for (const json& run : j.at("runs")) {
    if (!run.at("path").is_string()) fail(manifest, fmt::format("\"path\" is {}, not a text", run["path"].dump()));
    for (const char* key : {"seed", "spp"})
      if (!run.at(key).is_number_unsigned())
        fail(manifest, fmt::format("\"{}\" is {}, not a whole number", key, run.at(key).dump()));
    if (run["spp"] < 1 || run["spp"] > (1u << 24))
      fail(manifest, fmt::format("a run of {} samples", run["spp"].dump()));
    if (!(run.at("wall").get<double>() > 0)) fail(manifest, fmt::format("a run took {} s", run["wall"].dump()));
    if (run.contains("cpu") && !run["cpu"].is_null() && !(run["cpu"].get<double>() > 0))
      fail(manifest, fmt::format("a run took {} s of CPU time", run["cpu"].dump()));
    if (!seen.emplace(run["seed"], run["spp"]).second)
      fail(manifest, fmt::format("seed {} has {} samples twice", run["seed"].dump(), run["spp"].dump()));
  }
  return j;
} catch (const json::exception& x) {
  fail(manifest, x.what());
}

void addExternal(Experiment& e, const fs::path& manifest, const std::function<void(const std::string&)>& warn) try {
  const json j = readManifest(manifest);
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
  // known of all, or of none
  const bool cpuKnown = std::all_of(j.at("runs").begin(), j.at("runs").end(),
                                    [](const json& run) { return run.contains("cpu") && !run["cpu"].is_null(); });
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
    at.cpuKnown = cpuKnown;
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
    for (const Checkpoint& at : run.checkpoints) spp.push_back(at.spp);
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
