// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/statistics.h"

#include <nlohmann/json.hpp>

#include "cli/settings.h"
#include "math/clones.h"
#include "world/needs.h"

namespace wardmis {

using nlohmann::json;

namespace {

json settingsJson(const RenderSettings& s, const Scene& scene) {
  json j = toJson(s);
  j.update({{"spp", s.seconds > 0 ? json() : json(s.spp)},
            {"time", s.seconds > 0 ? json(s.seconds) : json()},
            {"target_error", s.targetError > 0 ? json(s.targetError) : json()},
            {"seed", s.seed},
            {"filter", name(scene.film.filter)},
            {"filter_width", scene.film.filterWidth}});
  return j;
}

}  // namespace

json countsJson(const Counts& c, const std::vector<std::string>& techniques) {
  json samples = json::object(), rays{{"camera", c.cameraRays}};
  for (size_t t = 0; t < techniques.size(); ++t) {
    samples[techniques[t]] = c.samples[t];
    rays[t + 1 == techniques.size() ? "shadow" : techniques[t]] = c.rays[t];
  }
  if (c.lightRays > 0) rays["light"] = c.lightRays, rays["connections"] = c.connections;
  samples["total"] = Counts::sum(c.samples), rays["total"] = c.allRays();
  return {{"camera_paths", c.cameraRays},
          {"samples", std::move(samples)},
          {"rays", std::move(rays)},
          {"counts",
           {{"nan", c.rare.nan},
            {"infinite", c.rare.infinite},
            {"negative", c.rare.negative},
            {"underflow", c.underflows}}}};
}

double meanVariance(const FilmBuffer& film) {
  double sum = 0;
  for (const Pixel& p : film.pixels) sum += static_cast<double>(luminance(film.variance(p)));
  return sum / static_cast<double>(std::max<size_t>(1, film.pixels.size()));
}

// How they are shared between the pixels; null: evenly.
json pixelSamples(const FilmBuffer& film, double gain) {
  if (film.shares.after.empty()) return {};
  uint32_t least = ~0u, most = 0;
  for (const Pixel& p : film.pixels) least = std::min(least, film.count(p)), most = std::max(most, film.count(p));
  return {{"least", least}, {"most", most}, {"expected_gain", gain}};
}

// Of paths from the lights; null: there are none.
json waysJson(const RenderSettings& settings, const Statistics& s) {
  if (!s.ways) return {};
  return {{"samples_at_hit", s.ways->atHit * settings.samplesPerHit},
          {"light_paths", s.ways->paths},
          {"connections", s.ways->connections},
          {"later_connections", s.ways->laterConnections},
          {"light_tracing", s.lightTracing},
          {"expected_gain", s.wayGain}};
}

json statisticsJson(const std::string& path, const RenderSettings& settings, const Scene& scene, const Statistics& s,
                    const FilmBuffer& film, double read, double write, double total) {
  json j{{"version", WARDMIS_VERSION},
         {"scene", path},
         {"settings", settingsJson(settings, scene)},
         {"seconds",
          {{"read", read},
           {"build", s.buildSeconds},
           {"pilot", s.pilotSeconds},
           {"render", s.renderSeconds},
           {"write", write},
           {"total", total}}},
         {"cpu_seconds", {{"pilot", s.pilotCpuSeconds}, {"render", s.renderCpuSeconds}}},
         {"samples_per_pixel", film.samples},
         {"pixel_samples", pixelSamples(film, s.pixelGain)},
         {"ways", waysJson(settings, s)},
         {"hidden_lights", s.hiddenLights < 1 ? json(s.hiddenLights) : json()},
         {"pilot_in_image", s.allocated ? json(s.pilotKept) : json()},
         {"pixels", film.pixels.size()},
         {"needs", describe(s.needs)},
         {"kernel", describe(s.kernel)},
         {"allocated", s.allocated},
         {"cost", s.cost},
         {"cost_of_hit", s.costOfHit},
         {"left_out", s.leftOut},
         {"notes", scene.notes},
         {"scene_counts",
          {{"triangles", s.triangles},
           {"instances", s.instances},
           {"materials", scene.materials.size()},
           {"lights", scene.lights.size()},
           {"emissive_triangles", s.emissiveTriangles}}},
         {"mean_variance", meanVariance(film)},
         {"error", s.error ? json{{"relmse_trimmed", s.error->relMse}, {"upper", s.error->upper}} : json()},
         {"threads", s.threads},
         {"isa", clonedFor()}};
  j.update(countsJson(s.counts, s.techniqueNames));
  return j;
}

std::string dumped(const json& value, int indent) {
  return value.dump(indent, ' ', false, json::error_handler_t::replace);
}

void describe(ExrImage& image, const json& statistics) {
  for (const char* key : {"version", "settings", "seconds", "samples_per_pixel", "samples", "rays", "counts", "needs",
                          "kernel", "left_out", "notes", "threads"}) {
    const json& v = statistics.at(key);
    image.attributes.emplace_back(std::string("wardmis:") + key, v.is_string() ? v.get<std::string>() : dumped(v));
  }
}

}  // namespace wardmis
