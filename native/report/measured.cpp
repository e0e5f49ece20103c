// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/measured.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "film/exr.h"
#include "integrate/passes.h"
#include "math/error.h"

namespace wardmis {
namespace {

constexpr size_t kGroupsShown = 12;    // of each kind, the largest
constexpr size_t kSmallestGroup = 64;  // pixels

// A group's pixels as an image of one row.
RgbImage partOf(const RgbImage& image, const Group& g) {
  RgbImage part{static_cast<int>(g.pixels.size()), 1, {}};
  part.rgb.reserve(3 * g.pixels.size());
  for (const uint32_t i : g.pixels) part.rgb.insert(part.rgb.end(), &image.rgb[3 * i], &image.rgb[3 * i] + 3);
  return part;
}

// Per pixel, over the seeds.
std::vector<float> rms(const std::vector<std::vector<float>>& squaredErrors) {
  std::vector<float> values(squaredErrors[0].size());
  for (const std::vector<float>& e : squaredErrors)
    for (size_t i = 0; i < values.size(); ++i) values[i] += e[i] / static_cast<float>(squaredErrors.size());
  for (float& v : values) v = std::sqrt(v);
  return values;
}

}  // namespace

std::vector<Group> groupsOf(const Experiment& e) {
  std::map<std::string, std::vector<uint32_t>> objects, materials, stiffness;
  constexpr std::pair<float, const char*> kClasses[] = {
      {2, "a: 1 to 2"}, {10, "b: 2 to 10"}, {100, "c: 10 to 100"}, {1e4f, "d: 100 to 10⁴"}, {1e38f, "e: over 10⁴"}};
  for (uint32_t i = 0; i < e.survey.pixels.size(); ++i) {
    const SurveyPixel& p = e.survey.pixels[i];
    if (p.material < 0) continue;
    if (const std::string* name = e.built->geometry.placements[p.placement].name) objects[*name].push_back(i);
    materials[e.scene->materials[static_cast<size_t>(p.material)].name].push_back(i);
    if (p.stiffness > 0)
      for (const auto& [limit, name] : kClasses)
        if (p.stiffness < limit) {
          stiffness[name].push_back(i);
          break;
        }
  }
  std::vector<Group> groups;
  for (auto* kind : {&objects, &materials, &stiffness}) {
    std::vector<Group> found;
    for (auto& [name, pixels] : *kind)
      if (pixels.size() >= kSmallestGroup)
        found.push_back({kind == &objects     ? "object"
                         : kind == &materials ? "material"
                                              : "stiffness",
                         kind == &stiffness ? name.substr(3) : name, std::move(pixels)});
    if (found.size() < 2) continue;  // the whole image says it already
    if (kind != &stiffness)
      std::stable_sort(found.begin(), found.end(),
                       [](const Group& a, const Group& b) { return a.pixels.size() > b.pixels.size(); });
    if (found.size() > kGroupsShown) found.resize(kGroupsShown);
    groups.insert(groups.end(), std::make_move_iterator(found.begin()), std::make_move_iterator(found.end()));
  }
  return groups;
}

Reference partOf(const Reference& reference, const Group& g) {
  Reference part;
  part.image = partOf(reference.image, g);
  if (reference.known())
    part.setVariance(partOf({reference.image.width, reference.image.height, reference.variance}, g).rgb);
  return part;
}

double wallSpread(const Measured& m) {
  std::vector<double> walls;
  for (const Run& run : *m.runs) walls.push_back(run.checkpoints.back().time.wall);
  std::sort(walls.begin(), walls.end());
  return walls.back() / walls[walls.size() / 2];
}

Measured measure(const Experiment& e, size_t k, const std::vector<Group>& groups) {
  Measured m;
  m.configuration = &e.configurations[k];
  m.runs = &e.runs[k];
  m.reference = &e.references[m.configuration->common ? 0 : m.configuration->reference];
  if (m.runs->size() < 2)
    throw Error(ExitCode::kCancelled,
                fmt::format("'{}' has {} finished run{}; a report needs two", m.configuration->name, m.runs->size(),
                            m.runs->size() == 1 ? "" : "s"),
                "run the same command again: it goes on where this one ended");
  std::vector<RgbImage> images;
  const double n = double(m.runs->size());
  for (const Run& run : *m.runs) {
    if (m.configuration->external) {
      images.push_back(readRgb(run.image));
      continue;
    }
    const ExrImage exr = readExr(run.image);
    images.push_back(rgbOf(exr, run.image));
    const size_t pixels = images.back().pixels();
    m.predicted.resize(pixels);
    for (const char c : {'R', 'G', 'B'})
      if (const auto* v = exr.channel(fmt::format("ViewLayer.Variance.{}", c)))
        for (size_t i = 0; i < pixels; ++i) m.predicted[i] += (*v)[i] / static_cast<float>(3 * n);
    m.fractions.resize(e.survey.techniqueNames.size());
    for (size_t t = 0; t < m.fractions.size(); ++t)
      if (const auto* v = exr.channel(fmt::format("ViewLayer.{}.X", allocationPass(e.survey.techniqueNames[t])))) {
        m.fractions[t].resize(pixels);
        for (size_t i = 0; i < pixels; ++i) m.fractions[t][i] += (*v)[i] / static_cast<float>(n);
      }
  }
  for (const Group& g : groups) {
    const RgbImage reference = partOf(m.reference->image, g);
    std::vector<Metrics>& each = m.groups.emplace_back();
    for (const RgbImage& image : images) each.push_back(compareImages(partOf(image, g), reference));
  }
  const bool another = m.configuration->external && m.configuration->common;
  m.seeds = seedStatistics(images, *m.reference, m.runs->front().checkpoints.back().spp, another ? kParity : kRounding);
  m.rmsError = rms(m.seeds.errors);
  m.first = std::move(images[0]);
  return m;
}

}  // namespace wardmis
