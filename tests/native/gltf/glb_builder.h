// SPDX-License-Identifier: GPL-3.0-or-later
// Builds small GLB files for tests: the JSON is public, binary data is appended through view() and accessor().
#pragma once

#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "scene/scene.h"

namespace wardmis::test {

using nlohmann::json;
using Bytes = std::vector<std::byte>;

inline Bytes bytesOf(const void* data, size_t size) {
  const auto* p = static_cast<const std::byte*>(data);
  return Bytes(p, p + size);
}

struct GlbBuilder {
  json root = {{"asset", {{"version", "2.0"}}}};
  Bytes binary;

  template <class T>
  int view(const std::vector<T>& data, json extra = json::object()) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const size_t offset = binary.size(), size = data.size() * sizeof(T);
    const Bytes bytes = bytesOf(data.data(), size);
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    extra.update({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
    return add("bufferViews", extra);
  }

  // Elements of `components` values of type T (float: 5126, and so on).
  template <class T>
  int accessor(const std::vector<T>& values, int components, json extra = json::object()) {
    const int viewIndex = view(values);
    extra.update({{"bufferView", viewIndex},
                  {"count", values.size() / components},
                  {"type", components == 1 ? "SCALAR" : "VEC" + std::to_string(components)},
                  {"componentType", componentType<T>()}});
    return add("accessors", extra);
  }

  // Appends to a top-level array.
  int add(const std::string& array, json value) {
    root[array].push_back(std::move(value));
    return static_cast<int>(root[array].size()) - 1;
  }

  json& extension() { return root["extensions"]["WARDMIS_scene"]; }

  Bytes bytes() const {
    json copy = root;
    if (!binary.empty() && !copy.contains("buffers")) copy["buffers"] = {{{"byteLength", binary.size()}}};
    return glb(copy.dump(), binary);
  }
  std::string text() const { return root.dump(); }

  static Bytes glb(std::string text, Bytes binary) {
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    Bytes out;
    const auto word = [&](size_t v) {
      const uint32_t w = static_cast<uint32_t>(v);
      const Bytes b = bytesOf(&w, 4);
      out.insert(out.end(), b.begin(), b.end());
    };
    const size_t binarySize = binary.empty() ? 0 : 8 + binary.size();
    word(0x46546C67), word(2), word(12 + 8 + text.size() + binarySize);
    word(text.size()), word(0x4E4F534A);
    const Bytes t = bytesOf(text.data(), text.size());
    out.insert(out.end(), t.begin(), t.end());
    if (!binary.empty()) {
      word(binary.size()), word(0x004E4942);
      out.insert(out.end(), binary.begin(), binary.end());
    }
    return out;
  }

  template <class T>
  static constexpr int componentType() {
    if (std::is_same_v<T, int8_t>) return 5120;
    if (std::is_same_v<T, uint8_t>) return 5121;
    if (std::is_same_v<T, int16_t>) return 5122;
    if (std::is_same_v<T, uint16_t>) return 5123;
    if (std::is_same_v<T, uint32_t>) return 5125;
    return 5126;
  }
};

// Two triangles that make the unit square in the plane z = 0, on one node 'Square'.
inline GlbBuilder square() {
  GlbBuilder b;
  b.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);  // accessor 0: positions
  b.accessor<uint32_t>({0, 1, 2, 0, 2, 3}, 1);                 // accessor 1: indices
  b.add("meshes", {{"name", "Quad"}, {"primitives", {{{"attributes", {{"POSITION", 0}}}, {"indices", 1}}}}});
  b.add("nodes", {{"name", "Square"}, {"mesh", 0}});
  return b;
}

inline json& primitive(GlbBuilder& b, int i = 0) { return b.root["meshes"][0]["primitives"][i]; }

// square() with a material, normals and texture coordinates.
inline GlbBuilder textured(json material) {
  GlbBuilder b = square();
  primitive(b)["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 3);
  primitive(b)["attributes"]["TEXCOORD_0"] = b.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, 2);
  primitive(b)["material"] = b.add("materials", std::move(material));
  return b;
}

inline json ward(json extension, const std::string& name = "Plate") {
  return {{"name", name}, {"extensions", {{"WARDMIS_scene", std::move(extension)}}}};
}

// An image of raw pixels with a texture on it; the texture's index.
template <class T>
int rawTexture(GlbBuilder& b, int width, int height, int channels, const std::vector<T>& pixels,
               json extra = json::object()) {
  extra.update({{"width", width},
                {"height", height},
                {"channels", channels},
                {"type", std::is_same_v<T, float> ? "f32" : "u8"}});
  const int view = b.view(pixels);
  const int image = b.add("images", {{"name", "Pixels"},
                                     {"mimeType", "application/x-wardmis-pixels"},
                                     {"bufferView", view},
                                     {"extensions", {{"WARDMIS_scene", extra}}}});
  return b.add("textures", {{"source", image}});
}

// Two curves as ribbons, tubes and cones, and their points as spheres.
inline GlbBuilder withStrands() {
  GlbBuilder b;
  const int positions = b.accessor<float>({0, 0, 0, 0, 0, 1, 0, 0, 2, 1, 0, 0, 1, 1, 0}, 3);
  const int radii = b.accessor<float>({0.1f, 0.2f, 0, 0.1f, 0.3f}, 1);
  const int segments = b.accessor<uint8_t>({0, 1, 1, 2, 3, 4}, 1);
  json primitives = json::array();
  for (const char* shape : {"ribbons", "tubes", "cones", "spheres"}) {
    json p = {{"attributes", {{"POSITION", positions}, {"_RADIUS", radii}}},
              {"extensions", {{"WARDMIS_scene", {{"shape", shape}}}}}};
    const bool lines = std::string(shape) != "spheres";
    p["mode"] = lines ? 1 : 0;
    if (lines) p["indices"] = segments;
    primitives.push_back(p);
  }
  primitives[0]["extensions"]["WARDMIS_scene"]["pieces"] = 3;
  primitives[1]["extensions"]["WARDMIS_scene"]["inside"] = true;
  b.add("meshes", {{"name", "Hair"}, {"primitives", primitives}});
  b.add("nodes", {{"name", "Fur"}, {"mesh", 0}});
  return b;
}

// A scene that uses nearly everything that the format has.
inline GlbBuilder everything() {
  GlbBuilder b = textured(ward(
      {{"variant", "ward-dur"},
       {"diffuse", {{"value", {0.1, 0.2, 0.3}}, {"texture", {{"index", 0}}}}},
       {"specular", {{"value", {0.5, 0.5, 0.5}}}},
       {"alphaX", {{"value", 0.1}}},
       {"alphaY", {{"value", 0.2}, {"texture", {{"index", 1}, {"channel", 1}, {"transform", {2, 0, 0, 0, 2, 0.5}}}}}},
       {"rotation", 0.25},
       {"emission", {{"value", {1, 0, 0}}}}}));
  rawTexture<uint8_t>(b, 2, 2, 3, {0, 0, 0, 255, 255, 255, 128, 128, 128, 10, 20, 30});
  rawTexture<float>(b, 1, 1, 3, {0.25f, 0.5f, 1.0f});
  b.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  b.root["textures"][1]["sampler"] = 0;
  rawTexture<float>(b, 2, 1, 3, {1, 2, 3, 4, 5, 6});
  b.add("materials", {{"name", "Metal"},
                      {"pbrMetallicRoughness",
                       {{"baseColorFactor", {1, 0.5, 0.25, 1}},
                        {"metallicFactor", 0.5},
                        {"roughnessFactor", 0.5},
                        {"baseColorTexture",
                         {{"index", 0},
                          {"extensions",
                           {{"KHR_texture_transform",
                             {{"offset", {0, 0.5}}, {"rotation", 1.5707963267948966}, {"scale", {0.5, 0.25}}}}}}}}}},
                      {"emissiveFactor", {0, 1, 0}},
                      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 5}}}}}});
  json second = primitive(b);
  second["material"] = 1;
  second["mode"] = 5;
  second["indices"] = b.accessor<uint16_t>({0, 1, 3, 2, 2}, 1);
  b.root["meshes"][0]["primitives"].push_back(second);
  json third = primitive(b);
  third["mode"] = 6;
  third.erase("material");
  third["indices"] = b.accessor<uint8_t>({0, 1, 2, 3}, 1);
  b.root["meshes"][0]["primitives"].push_back(third);

  const int translation = b.accessor<float>({0, 0, 1, 0, 0, 2}, 3);
  const int rotation = b.accessor<int16_t>({0, 0, 0, 32767, 0, 0, 32767, 0}, 4, {{"normalized", true}});
  b.root["nodes"][0]["translation"] = {10, 0, 0};
  b.root["nodes"][0]["extensions"] = {
      {"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translation}, {"ROTATION", rotation}}}}},
      {"WARDMIS_scene", {{"visibility", {"camera", "shadow"}}}}};

  b.root["cameras"] = {{{"type", "perspective"},
                        {"perspective", {{"yfov", 0.69}, {"znear", 0.1}}},
                        {"extensions",
                         {{"WARDMIS_scene",
                           {{"projection", "perspective"},
                            {"viewPlane", {-0.3, 0.4, -0.2, 0.2}},
                            {"clip", {0.1, 100}},
                            {"lensRadius", 0.01},
                            {"focusDistance", 3},
                            {"blades", 6},
                            {"bladeRotation", 0.1},
                            {"bladeRatio", 1.5}}}}}}};
  b.add("nodes", {{"name", "Camera"}, {"camera", 0}, {"translation", {0, 0, 5}}, {"scale", {2, 3, 4}}});
  b.extension() = {
      {"version", 1},
      {"upAxis", "Z"},
      {"camera", 1},
      {"film",
       {{"resolution", {768, 512}},
        {"border", {1, 2, 700, 500}},
        {"filter", {{"type", "gaussian"}, {"width", 2}}},
        {"exposure", 2},
        {"transparent", true}}},
      {"world", {{"radiance", {1, 2, 3}}, {"texture", {{"index", 2}, {"matrix", {0, 1, 0, -1, 0, 0, 0, 0, 1}}}}}},
      {"lights",
       {{{"name", "Area"}, {"type", "area"}, {"shape", "ellipse"}, {"size", {2, 3}}, {"radiance", 4}, {"spread", 1}},
        {{"name", "Lamp"},
         {"type", "point"},
         {"intensity", 5},
         {"radius", 0.1},
         {"facing", false},
         {"color", {1, 0.5, 0}}},
        {{"name", "Spot"}, {"type", "spot"}, {"intensity", 6}, {"angle", 1}, {"blend", 0.5}, {"cosine", true}},
        {{"name", "Sun"}, {"type", "sun"}, {"irradiance", 7}, {"angle", 0.01}, {"shadow", false}},
        {{"name", "Off"}, {"type", "point"}, {"intensity", 0}}}},
      {"notes", {"material 'Glass': rendered as magenta"}}};
  for (int i = 0; i < 5; i++)
    b.add("nodes", {{"extensions", {{"WARDMIS_scene", {{"light", i}}}}}, {"translation", {0, i, 0}}});
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 3}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
      {{"type", "directional"}, {"color", {0, 0, 1}}}};
  b.add("nodes", {{"name", "Core spot"}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.add("nodes", {{"name", "Core sun"}, {"extensions", {{"KHR_lights_punctual", {{"light", 1}}}}}});
  b.root["extensionsUsed"] = {"WARDMIS_scene", "KHR_lights_punctual", "KHR_materials_clearcoat"};
  b.root["extensionsRequired"] = {"WARDMIS_scene", "EXT_mesh_gpu_instancing"};
  return b;
}

}  // namespace wardmis::test
