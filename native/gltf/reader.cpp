// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>

#include "gltf/accessor.h"
#include "gltf/file.h"
#include "gltf/json.h"
#include "gltf/left_out.h"
#include "gltf/material.h"
#include "gltf/mesh.h"
#include "gltf/node.h"
#include "math/number.h"

namespace wardmis {
namespace {

constexpr const char* kExtension = "WARDMIS_scene";
constexpr size_t kMostWorlds = 16;  // each has a table of its own; an exporter needs one for each kind of ray

void checkVersion(const Json& root) {
  const Json version = root.at("asset").at("version");
  const std::string_view text = version.string();
  if (!text.starts_with("2.")) version.failExpected("glTF version 2.x");
}

void checkExtensions(const Json& root, LeftOut& leftOut) {
  // KHR_mesh_quantization only allows more component types, which the accessors take anyway.
  constexpr std::string_view kKnown[] = {kExtension,
                                         "KHR_lights_punctual",
                                         "KHR_texture_transform",
                                         "KHR_materials_emissive_strength",
                                         "KHR_materials_unlit",
                                         "KHR_mesh_quantization",
                                         "KHR_draco_mesh_compression",
                                         "EXT_meshopt_compression",
                                         "KHR_meshopt_compression",
                                         "EXT_texture_webp",
                                         "EXT_mesh_gpu_instancing"};
  // Of these the rest can be shown without; what is lost is said for each material and image.
  constexpr std::string_view kOfSurfaces[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_",
                                              "GOOGLE_texture_"};
  const auto isKnown = [&](std::string_view name) {
    return std::ranges::find(kKnown, name) != std::end(kKnown) ||
           std::ranges::any_of(kOfSurfaces, [&](std::string_view start) { return name.starts_with(start); });
  };
  const JsonArray required = root.array("extensionsRequired"), used = root.array("extensionsUsed");
  for (size_t i = 0; i < required.size(); i++)
    if (!isKnown(required[i].string()))
      required[i].fail(fmt::format("the scene requires the extension '{}', which this reader does not know",
                                   cleaned(required[i].string())),
                       "export the scene without it");
  for (size_t i = 0; i < used.size(); i++)
    if (const std::string_view name = used[i].string(); std::ranges::find(kKnown, name) == std::end(kKnown)) {
      const std::string what = "extension " + cleaned(name), why = "this reader does not know it";
      isKnown(name) ? leftOut.addUnneeded(what, why) : leftOut.add(what, why);
    }
}

Film readFilm(const Json& json) {
  constexpr std::pair<std::string_view, FilterType> kFilters[] = {
      {"box", FilterType::kBox}, {"gaussian", FilterType::kGaussian}, {"blackman-harris", FilterType::kBlackmanHarris}};
  Film film;
  const auto ints = [](const JsonArray& array, size_t n, const Json& place, int low) {
    if (array.size() != n) place.failExpected(fmt::format("{} whole numbers", n));
    std::array<int, 4> out{};
    for (size_t i = 0; i < n; i++) out[i] = static_cast<int>(array[i].integer(low, kLargestSide));
    return out;
  };
  const Json resolution = json.at("resolution");
  const auto size = ints(resolution.array(), 2, resolution, 1);
  film.width = film.x1 = size[0];
  film.height = film.y1 = size[1];
  if (uint64_t(film.width) * film.height > uint64_t(1) << 28) resolution.failExpected("at most 2^28 pixels");
  if (const auto border = json.find("border")) {
    const auto b = ints(border->array(), 4, *border, 0);
    film.x0 = b[0], film.y0 = b[1], film.x1 = b[2], film.y1 = b[3];
    if (!(film.x0 < film.x1 && film.x1 <= film.width && film.y0 < film.y1 && film.y1 <= film.height))
      border->failExpected(fmt::format("[x0, y0, x1, y1] within {} x {} pixels, not empty", film.width, film.height));
  }
  if (const auto filter = json.find("filter")) {
    film.filter = filter->at("type").choice(kFilters);
    film.filterWidth = filter->numberOr("width", film.filterWidth, 1e-6f, 100);
  }
  film.exposure = json.numberOr("exposure", 1, 0);
  film.transparent = json.booleanOr("transparent", false);
  film.keepUvs = json.booleanOr("keepUvs", false);
  film.alphaThreshold = json.numberOr("alphaThreshold", film.alphaThreshold, 0, 1);
  if (const auto shutter = json.find("shutter")) {
    film.shutter.rolling = shutter->numberOr("rolling", -1, 0, 1);
    if (const auto curve = shutter->find("curve")) {
      const JsonArray values = curve->array();
      if (values.size() < 2 || values.size() > 4096) curve->failExpected("2 to 4096 numbers");
      float most = 0;
      for (size_t i = 0; i < values.size(); i++)
        most = std::max(most, film.shutter.open.emplace_back(values[i].number(0, 1e6f)));
      if (!(most > 0)) curve->failExpected("a number above 0");
    }
  }
  return film;
}

// Directions are looked up after it, so that it must have an inverse; rows may be of any length.
void readWorldMatrix(const Json& json, float (&matrix)[9]) {
  json.numbers(matrix);
  const Vec3f x{matrix[0], matrix[1], matrix[2]}, y{matrix[3], matrix[4], matrix[5]},
      z{matrix[6], matrix[7], matrix[8]};
  const float lengths = length(x) * length(y) * length(z), determinant = std::abs(dot(cross(x, y), z));
  if (!(determinant > 1e-5f * lengths && determinant > 1e-20f && lengths < 1e20f))
    json.fail("it has no inverse: directions of the sky cannot be told from it", "use a rotation, or leave it out");
}

World readWorld(const Json& json, Materials& materials) {
  constexpr std::pair<std::string_view, SkyMap> kMaps[] = {{"equirectangular", SkyMap::kEquirectangular},
                                                           {"mirror-ball", SkyMap::kMirrorBall}};
  World world;
  const auto texture = json.find("texture");
  world.radiance = json.lightOr("radiance", texture || json.find("program") ? Rgb{1, 1, 1} : Rgb{0, 0, 0});
  world.visibility = readVisibility(json);
  world.maxBounces = static_cast<int>(json.integerOr("maxBounces", world.maxBounces, 0, 1 << 20));
  if (json.find("program") && texture)
    texture->fail("stands beside a program, in whose place it is", "export the scene again");
  world.program = materials.program(json, "the world", world.result);
  if (const auto cone = json.find("cone")) {
    const Vec3f axis = cone->at("axis").vec3();
    if (!(length(axis) > 1e-10f && length(axis) < 1e10f)) cone->at("axis").failExpected("a direction");
    world.coneAxis = normalize(axis);
    world.coneAngle = cone->at("angle").number(1e-5f, 2 * kPi<float>);
  }
  if (texture && !isBlack(world.radiance)) {
    world.texture = materials.worldTexture(texture->at("index"));
    if (const auto map = texture->find("projection")) world.map = map->choice(kMaps);
    if (const auto matrix = texture->find("matrix")) readWorldMatrix(*matrix, world.matrix);
  }
  return world;
}

Scene read(const Bytes& file, const std::filesystem::path& folder, const std::string& name, bool needsCamera) {
  LeftOut leftOut;
  const GlbChunks chunks = splitGlb(file, name, leftOut);
  const JsonDocument document(name, chunks.json);
  const Json root(document);
  checkVersion(root);
  checkExtensions(root, leftOut);

  Scene scene;
  scene.path = name;
  Buffers buffers(root, chunks.binary, folder, file.size());
  Accessors accessors(root, buffers, file.size());
  Materials materials(root, buffers, leftOut);
  Meshes meshes(root, accessors, buffers, materials, leftOut);

  if (const auto own = root.extension(kExtension)) {
    scene.foreign = false;
    const Json version = own->at("version");
    if (version.integer(0, UINT64_MAX) != 1)
      version.failExpected("version 1 of WARDMIS_scene; use a newer renderer for newer files");
    constexpr std::pair<std::string_view, bool> kAxes[] = {{"Y", false}, {"Z", true}};
    if (const auto axis = own->find("upAxis")) scene.zUp = axis->choice(kAxes);
    if (const auto film = own->find("film")) {
      scene.film = readFilm(*film);
      scene.hasFilm = true;
      if (scene.film.keepUvs) meshes.keepUvs();
    }
    if (const auto world = own->find("world")) {
      if (world->isObject()) {
        scene.worlds.push_back(readWorld(*world, materials));
      } else {
        const JsonArray worlds = world->array();
        if (worlds.size() > kMostWorlds) world->failExpected(fmt::format("at most {} worlds", kMostWorlds));
        for (size_t i = 0; i < worlds.size(); i++) scene.worlds.push_back(readWorld(worlds[i], materials));
      }
      std::erase_if(scene.worlds, [](const World& w) { return isBlack(w.radiance); });
    }
    const JsonArray notes = own->array("notes");
    for (size_t i = 0; i < notes.size(); i++) scene.notes.emplace_back(notes[i].string());
  }

  readNodes(root, accessors, buffers, materials, meshes, leftOut, needsCamera, scene);
  if (root.array("animations").size() > 0) leftOut.addUnneeded("animations", "one frame is rendered");
  meshes.finish(scene);
  materials.finish(scene);
  scene.lacking = scene.leftOut = leftOut.lacking();
  std::ranges::copy(leftOut.unneeded(), std::back_inserter(scene.leftOut));
  scene.files = buffers.files();
  return scene;
}

}  // namespace

Scene readGlb(const std::filesystem::path& path, bool needsCamera) {
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  Scene scene = read(mapFile(path), folder, path.string(), needsCamera);
  scene.files.insert(scene.files.begin(), path);
  return scene;
}

Scene readGlb(std::span<const std::byte> bytes, const std::filesystem::path& folder, const std::string& name) {
  // A copy: the scene's arrays are views, and outlive the caller's bytes.
  auto copy = std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end());
  return read({*copy, copy}, folder, name, false);
}

}  // namespace wardmis
