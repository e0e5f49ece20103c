// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/verbs.h"
#include "gltf/reader.h"
#include "image/texel_memory.h"
#include "integrate/light_tracer.h"
#include "scene/defaults.h"
#include "world/needs.h"

namespace wardmis {
namespace {

// The operations that each program of materials, lights and skies has, and how often.
std::vector<std::pair<std::string, std::map<std::string, int>>> programsOf(const Scene& scene) {
  std::vector<std::pair<std::string, std::map<std::string, int>>> out;
  const auto add = [&](const std::string& user, const std::shared_ptr<const Program>& program) {
    if (!program) return;
    auto& [name, operations] = out.emplace_back();
    name = user.empty() ? "(without a name)" : user;
    for (const Instruction& i : program->instructions) ++operations[std::string(info(i.operation).name)];
  };
  for (const Material& m : scene.materials) add(m.name, m.program);
  for (const Light& light : scene.lights) add(light.name, light.program);
  for (const World& w : scene.worlds) add("(the world)", w.program);
  return out;
}

}  // namespace

Verb addInfo(CLI::App& app) {
  struct Options {
    std::string scene, integrand = "split", integrator = "path";
    bool json = false;
  };
  auto o = std::make_shared<Options>();
  app.add_option("SCENE", o->scene, "a .glb or .gltf file")->required();
  app.add_option("--integrand", o->integrand, "as for render")
      ->check(CLI::IsMember({"split", "joint"}))
      ->capture_default_str();
  app.add_option("--integrator", o->integrator, "as for render")
      ->check(CLI::IsMember({"direct", "path", "bidirectional"}))
      ->capture_default_str();
  app.add_flag("--json", o->json, "machine output");

  return [o] {
    Scene scene = readGlb(o->scene);
    addDefaults(scene);
    requireMemoryFor(scene);
    Geometry geometry(scene);
    const std::vector<Environment> environments = environmentsOf(scene);
    const Emitters emitters(scene, geometry, environments);
    uint32_t n = needs(scene, geometry, emitters, o->integrand == "joint");
    if (o->integrator != "direct") n |= kNeedsBounces;
    std::vector<std::string> left = leftOut(scene, n, emitters);
    if (o->integrator == "bidirectional")
      if (std::string none = noLightPaths(scene, geometry, emitters, {}); !none.empty())
        left.push_back(std::move(none));
    const Film& film = scene.film;
    const std::vector<std::pair<std::string, std::map<std::string, int>>> programs = programsOf(scene);
    const TexelUse texels = texelUse();
    if (o->json) {
      const nlohmann::json j{{"version", WARDMIS_VERSION},
                             {"scene", o->scene},
                             {"resolution", {film.width, film.height}},
                             {"border", {film.x0, film.y0, film.x1, film.y1}},
                             {"camera", scene.camera->name},
                             {"scene_counts",
                              {{"triangles", geometry.triangles},
                               {"curve_segments", geometry.segments},
                               {"spheres", geometry.spheres},
                               {"instances", geometry.placements.size()},
                               {"meshes", scene.meshes.size()},
                               {"materials", scene.materials.size()},
                               {"lights", scene.lights.size()},
                               {"emissive_triangles", emitters.emissiveTriangles()},
                               {"images", scene.images.size()},
                               {"image_bytes_in_memory", texels.memory},
                               {"image_bytes_in_files", texels.files},
                               {"degenerate_triangles", scene.degenerateTriangles}}},
                             {"needs", describe(n)},
                             {"programs", programs},
                             {"left_out", left},
                             {"notes", scene.notes}};
      fmt::print("{}\n", j.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
      return 0;
    }
    fmt::print("{}\n", o->scene);
    fmt::print("  image       {} x {}", film.width, film.height);
    if (film.x1 - film.x0 != film.width || film.y1 - film.y0 != film.height)
      fmt::print(", border {} x {}", film.x1 - film.x0, film.y1 - film.y0);
    fmt::print("\n  camera      {}\n", scene.camera->name);
    fmt::print("  geometry    {} triangles in {} objects of {} meshes\n", geometry.triangles,
               geometry.placements.size(), scene.meshes.size());
    if (geometry.segments > 0) fmt::print("              {} segments of curves\n", geometry.segments);
    if (geometry.spheres > 0) fmt::print("              {} spheres\n", geometry.spheres);
    if (scene.degenerateTriangles > 0)
      fmt::print("              {} triangles without area were dropped\n", scene.degenerateTriangles);
    const std::string taken = describe(texels);
    fmt::print("  materials   {}, textures {}{}\n", scene.materials.size(), scene.images.size(),
               taken.empty() ? "" : ": " + taken);
    std::string skies;
    for (const Environment& e : environments)
      if (e.exists())
        skies += (skies.empty() ? "" : ", ") + std::string(e.world().program        ? "program"
                                                           : e.world().texture >= 0 ? "image"
                                                                                    : "constant");
    fmt::print("  lights      {}, emissive triangles {}, environment {}\n", scene.lights.size(),
               emitters.emissiveTriangles(), skies.empty() ? "none" : skies);
    fmt::print("  needs       {}\n", describe(n));
    for (const auto& [material, operations] : programs) {
      std::string text;
      for (const auto& [name, count] : operations)
        text += (text.empty() ? "" : ", ") + name + (count > 1 ? fmt::format(" x {}", count) : "");
      fmt::print("  program     {}: {}\n", material, text);
    }
    for (const std::string& s : left) fmt::print("  left out    {}\n", s);
    for (const std::string& s : scene.notes) fmt::print("  note        {}\n", s);
    return 0;
  };
}

}  // namespace wardmis
