// SPDX-License-Identifier: GPL-3.0-or-later
// Files of other programs: what is not quite as glTF demands and does no harm is read and named, what would show
// something else is refused, and what a picture needs and they lack is chosen.
#include <cmath>

#include "glb_support.h"
#include "scene/defaults.h"
#include "world/camera_ray.h"
#include "world/geometry.h"

namespace wardmis {
namespace {

using namespace test;

void append(Bytes& file, uint32_t word) {
  const Bytes bytes = bytesOf(&word, 4);
  file.insert(file.end(), bytes.begin(), bytes.end());
}

// square() as a GLB whose JSON chunk has a length that is no multiple of 4; padded: with what fills it up, not counted.
Bytes oddChunk(bool padded) {
  const GlbBuilder b = square();
  json root = b.root;
  root["buffers"] = {{{"byteLength", b.binary.size()}}};
  std::string text = root.dump();
  while (text.size() % 4 != 2) text += ' ';
  const size_t length = text.size();
  if (padded) text += "  ";
  Bytes out;
  for (const size_t word :
       {size_t{0x46546C67}, size_t{2}, 12 + 8 + text.size() + 8 + b.binary.size(), length, size_t{0x4E4F534A}})
    append(out, static_cast<uint32_t>(word));
  const Bytes bytes = bytesOf(text.data(), text.size());
  out.insert(out.end(), bytes.begin(), bytes.end());
  append(out, static_cast<uint32_t>(b.binary.size()));
  append(out, 0x004E4942);
  out.insert(out.end(), b.binary.begin(), b.binary.end());
  return out;
}

TEST(Foreign, ContainersNeedNotBeTidy) {
  const auto check = [](const Bytes& file, const char* said) {
    const Scene s = read(file);
    ASSERT_EQ(s.instances.size(), 1u) << said;
    expectNear(s.meshes[0].parts[0].positions[2], {1, 1, 0}, 0);
    EXPECT_TRUE(listHas(s.leftOut, said)) << said;
  };
  Bytes file = square().bytes();
  file.insert(file.end(), 3, std::byte{7});
  check(file, "the last 3 bytes of the file: they lie behind the end that its header gives");
  const uint32_t size = static_cast<uint32_t>(file.size());
  std::memcpy(file.data() + 8, &size, 4);
  check(file, "3 bytes at the end of the file: they are no chunk");
  for (const bool padded : {false, true}) check(oddChunk(padded), "padding of GLB chunk 0: its length");
}

TEST(Foreign, BuffersThatNobodyReadsNeedNoData) {
  GlbBuilder b = square();
  b.root["buffers"] = {{{"byteLength", b.binary.size()}}, {{"byteLength", 99}}};
  b.add("bufferViews", {{"buffer", 1}, {"byteLength", 99}});
  EXPECT_EQ(read(b).instances.size(), 1u);
}

TEST(Foreign, VerticesThatMakeNoTriangleAreLeftOver) {
  GlbBuilder b = square();
  primitive(b).erase("indices");
  Scene s = read(b);
  EXPECT_EQ(s.meshes.at(0).parts[0].primitives[0].indices.size(), 3u);
  EXPECT_TRUE(listHas(s.leftOut, "the last 1 of 4 vertices of meshes[0] 'Quad' .primitives[0]"));

  primitive(b)["indices"] = b.accessor<uint8_t>({0, 1, 2, 2, 3}, 1);
  s = read(b);
  EXPECT_EQ(s.meshes.at(0).parts[0].primitives[0].indices.size(), 3u);
  EXPECT_TRUE(listHas(s.leftOut, "the last 2 of 5 vertices"));

  for (const int mode : {4, 5, 6}) {
    primitive(b)["indices"] = b.accessor<uint8_t>({0, 1}, 1);
    primitive(b)["mode"] = mode;
    s = read(b);
    EXPECT_TRUE(s.instances.empty());
    EXPECT_TRUE(listHas(s.leftOut, "the last 2 of 2 vertices"));
  }
}

TEST(Foreign, PrimitivesWithoutPositionsAreSkipped) {
  GlbBuilder b = square();
  b.root["meshes"][0]["primitives"].push_back({{"attributes", json::object()}});
  b.root["meshes"][0]["primitives"].push_back({{"indices", 1}});
  const Scene s = read(b);
  EXPECT_EQ(s.meshes.at(0).parts.size(), 1u);
  EXPECT_TRUE(listHas(s.leftOut, "a primitive of mesh 'Quad' (2 times): it has no POSITION"));
}

TEST(Foreign, RootsThatAreNoneStayWhereTheyAre) {
  GlbBuilder b = square();
  b.root["nodes"] = {{{"name", "Parent"}, {"mesh", 0}, {"children", {1}}, {"translation", {5, 0, 0}}},
                     {{"name", "Child"}, {"mesh", 0}, {"children", {2}}, {"translation", {0, 1, 0}}},
                     {{"name", "Grandchild"}, {"mesh", 0}}};
  b.root["scenes"] = {{{"nodes", {1, 1}}}};
  Scene s = read(b);
  ASSERT_EQ(s.instances.size(), 2u);  // what the scene lists, and what hangs on it
  EXPECT_EQ(s.instances[0].name, "Child");
  expectNear(s.instances[0].toWorld.t, {5, 1, 0});
  EXPECT_TRUE(listHas(s.leftOut, "the root 'Child' (2 times): it is none, but a child of 'Parent', and stays there"));
  EXPECT_TRUE(listHas(s.leftOut, "the scene lists it twice"));

  b.root["scenes"] = {{{"nodes", {0, 1}}}};
  s = read(b);
  EXPECT_EQ(s.instances.size(), 3u);  // each once
}

TEST(Foreign, NormalsThatAreNoNumbersSpoilTheirVertexAlone) {
  GlbBuilder b = textured(ward({{"diffuse", {{"value", {1, 1, 1}}}}}));
  primitive(b)["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1, 0, NAN, 1, 0, 0, 1, INFINITY, 0, 1}, 3);
  const Scene s = read(b);
  const MeshPart& part = s.meshes.at(0).parts[0];
  expectNear(part.normals[0], {0, 0, 1}, 0);
  expectNear(part.normals[1], {0, 0, 0}, 0);
  expectNear(part.normals[3], {0, 0, 0}, 0);
  EXPECT_TRUE(listHas(s.leftOut, "2 normals or texture coordinates of mesh 'Quad'"));
}

TEST(Foreign, ImagesThatAreMissingAreMagenta) {
  const TemporaryFolder folder;
  const std::pair<json, const char*> kTable[] = {
      {{{"name", "Wood"}, {"uri", "wood.png"}}, "image 'Wood' 'wood.png' is not there: "},
      {{{"uri", "../wood.png"}}, "is not a file in the scene's folder"},
      {{{"uri", "data:image/png;base64,*"}}, "its base64 data is wrong"},
      {{{"bufferView", 99}}, "refers to bufferViews[99]"},
      {json::object(), "has neither uri nor bufferView, or both"},
  };
  for (const auto& [image, said] : kTable) {
    GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
    b.root["textures"] = {{{"source", 0}}};
    b.root["images"] = json::array({image});
    const Scene s = read(b.bytes(), folder.path);
    ASSERT_EQ(s.images.size(), 1u) << said;
    EXPECT_EQ(s.images[0].bytes, (Texels<uint8_t>{255, 0, 255})) << said;
    ASSERT_EQ(s.notes.size(), 1u) << said;
    expectHas(s.notes[0], said);
    expectHas(s.notes[0], "(needed by material 'Plate'); magenta is shown instead");
  }
}

// Light is never magenta: that of a sky, of a surface, of an unlit one.
TEST(Foreign, LightOfImagesThatAreMissingIsGrey) {
  const json texture = {{"index", 0}};
  const auto lost = [](json material) {
    GlbBuilder b = textured(std::move(material));
    b.root["textures"] = {{{"source", 0}}};
    b.root["images"] = json::array({{{"uri", "lost.png"}}});
    return b;
  };
  const std::pair<json, bool> kSurfaces[] = {
      {{{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture}}, false},
      {ward({{"emission", {{"value", {2, 2, 2}}, {"texture", texture}}}}), false},
      {{{"pbrMetallicRoughness", {{"baseColorTexture", texture}}},
        {"extensions", {{"KHR_materials_unlit", json::object()}}}},
       false},
      {ward({{"emission", {{"texture", texture}}}, {"diffuse", {{"texture", texture}}}}), true},
  };
  for (const auto& [material, shows] : kSurfaces) {
    const Scene s = read(lost(material).bytes());
    const Material& m = s.materials.at(0);
    const Image& light = s.images.at(s.textures.at(m.emission.texture.texture).image);
    EXPECT_EQ(light.floats, (Texels<float>{0.5f, 0.5f, 0.5f})) << material;
    ASSERT_EQ(s.notes.size(), 1u);
    expectHas(s.notes[0],
              shows ? "; magenta, and grey where it gives light, is shown instead" : "); grey light is shown instead");
    if (shows) {
      EXPECT_EQ(s.images.at(s.textures.at(m.diffuse.texture.texture).image).bytes, (Texels<uint8_t>{255, 0, 255}));
    }
  }
  GlbBuilder b = lost({{"name", "Plate"}});
  b.root["extensions"]["WARDMIS_scene"] = {{"version", 1}, {"world", {{"radiance", {2, 2, 2}}, {"texture", texture}}}};
  const Scene s = read(b.bytes());
  EXPECT_EQ(s.images.at(s.textures.at(s.worlds.at(0).texture).image).floats, (Texels<float>{0.5f, 0.5f, 0.5f}));
  expectHas(s.notes.at(0), "(needed by the world); grey light is shown instead");
}

TEST(Foreign, TexturesMayNameTheirImageByAnExtension) {
  for (const char* extension : {"EXT_texture_webp", "KHR_texture_basisu", "MSFT_texture_dds"}) {
    GlbBuilder b = textured({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
    b.add("images", {{"bufferView", b.view(png2x1({1, 2, 3, 4, 5, 6}))}});
    b.add("images", {{"bufferView", b.view(png2x1({7, 8, 9, 10, 11, 12}))}});
    b.add("textures", {{"source", 0}, {"extensions", {{extension, {{"source", 1}}}}}});
    b.root["extensionsRequired"] = {extension};
    EXPECT_EQ(read(b).images.at(0).bytes.at(0), 1) << "core glTF's own comes first";
    b.root["textures"][0].erase("source");
    EXPECT_EQ(read(b).images.at(0).bytes.at(0), 7);
    b.root["textures"][0].erase("extensions");
    const Scene s = read(b);
    EXPECT_EQ(s.images.at(0).bytes, (Texels<uint8_t>{255, 0, 255}));
    EXPECT_TRUE(listHas(s.notes, "textures[0] has no image (needed by material materials[0])"));
  }
  // KTX2 is named
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
  const std::string ktx = "\xABKTX 20\xBB\r\n\x1A\n0123456789";
  b.add("images", {{"bufferView", b.view(std::vector<char>(ktx.begin(), ktx.end()))}});
  b.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}});
  EXPECT_TRUE(listHas(read(b).notes, "is a KTX2 or Basis file (KHR_texture_basisu), which is not read"));
}

TEST(Foreign, AttributesThatAreWrongAreRefused) {
  const auto message = [](const std::string& name, const std::function<int(GlbBuilder&)>& accessor) {
    GlbBuilder b = square();
    const int index = accessor(b);
    primitive(b)["attributes"][name] = index;
    return errorOf(b);
  };
  const auto floats = [](size_t count, int components) {
    return [=](GlbBuilder& b) { return b.accessor<float>(std::vector<float>(count * components, 1), components); };
  };
  // also those that nobody reads
  for (const char* name : {"NORMAL", "COLOR_0", "_OWN"})
    expectHas(message(name, floats(3, 3)), "has 3 elements, but POSITION has 4");
  expectHas(message("TEXCOORD_1", floats(5, 2)), "has 5 elements, but POSITION has 4");
  expectHas(message("JOINTS_0", [](GlbBuilder& b) { return b.accessor<uint32_t>(std::vector<uint32_t>(16), 4); }),
            "has componentType 5125, which is not allowed here");
  expectHas(message("JOINTS_0", floats(4, 4)), "has componentType 5126, which is not allowed here");

  GlbBuilder b = square();
  Bytes odd = bytesOf(std::vector<float>(12).data(), 48);
  odd.insert(odd.begin(), std::byte{0});
  const int view = b.view(odd);
  b.root["accessors"][0].update({{"bufferView", view}, {"byteOffset", 1}});
  expectHas(errorOf(b), "its components of 4 bytes are not aligned");
}

TEST(Foreign, OneSetOfTextureCoordinatesIsReadAndTheOtherNamed) {
  GlbBuilder b = textured(
      {{"name", "Wall"},
       {"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}},
       {"emissiveFactor", {1, 1, 1}},
       {"emissiveTexture", {{"index", 0}}}});
  rawTexture<uint8_t>(b, 1, 1, 3, {1, 2, 3});
  primitive(b)["attributes"]["TEXCOORD_1"] = b.accessor<float>({.5f, .75f, 1, 1, 1, 0, 0, 0}, 2);
  Scene s = read(b);
  const Vec2f uv = s.meshes.at(0).parts[0].uvs[0];
  expectNear({uv.x, uv.y, 0}, {.5f, .25f, 0});
  EXPECT_GE(s.materials[0].diffuse.texture.texture, 0);
  EXPECT_EQ(s.materials[0].emission.texture.texture, -1);
  EXPECT_TRUE(listHas(s.leftOut, "emissiveTexture of material 'Wall': it needs TEXCOORD_0"));

  primitive(b)["attributes"].erase("TEXCOORD_1");
  s = read(b);
  EXPECT_TRUE(s.meshes.at(0).parts[0].uvs.empty());
  EXPECT_TRUE(listHas(s.leftOut,
                      "of material 'Wall' on primitive 0 of mesh 'Quad': it has no TEXCOORD_1: textures are "
                      "looked up at (0, 0)"));
}

TEST(Foreign, SetsThatAProgramAsksForInVainAreNamed) {
  for (const char* set : {"", "TEXCOORD_3"}) {
    GlbBuilder b = textured(ward(
        {{"program", {{"operations", json::array({{{"op", "uv"}, {"set", set}}})}}}, {"emission", {{"result", 0}}}}));
    primitive(b)["attributes"].erase("TEXCOORD_0");
    const Scene s = read(b);
    EXPECT_TRUE(listHas(s.leftOut, "of material 'Plate' on primitive 0 of mesh 'Quad': it has no " +
                                       std::string(*set ? set : "TEXCOORD_0")));
  }
}

TEST(Foreign, WhatTheMaterialIsNotGivenIsNamed) {
  GlbBuilder b = textured(
      {{"name", "Glass"},
       {"extensions",
        {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_clearcoat", json::object()}}}});
  primitive(b)["attributes"]["COLOR_0"] = b.accessor<float>(std::vector<float>(12, 1), 3);
  b.root["extensionsRequired"] = {"KHR_materials_transmission"};
  const Scene s = read(b);
  for (const char* what :
       {"KHR_materials_transmission of material 'Glass': nothing is transparent: it is rendered opaque",
        "KHR_materials_clearcoat of material 'Glass': it is rendered without",
        "vertex colours of mesh 'Quad' with material 'Glass'"})
    EXPECT_TRUE(listHas(s.leftOut, what)) << what;
}

TEST(Foreign, UnlitMaterialsAreSeenAsTheyAre) {
  GlbBuilder b = textured(
      {{"name", "Sign"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0.25, 0.5, 1, 1}}, {"baseColorTexture", {{"index", 0}}}}},
       {"emissiveFactor", {9, 9, 9}},
       {"extensions", {{"KHR_materials_unlit", json::object()}}}});
  rawTexture<uint8_t>(b, 1, 1, 3, {255, 255, 255});
  Scene s = read(b);
  const Material& m = s.materials.at(0);
  expectNear(m.emission.value, {0.25f, 0.5f, 1});
  EXPECT_GE(m.emission.texture.texture, 0);
  EXPECT_EQ(maxComponent(m.diffuse.value) + maxComponent(m.specular.value), 0);
  EXPECT_TRUE(listHas(s.leftOut, "KHR_materials_unlit of material 'Sign'"));
  addDefaults(s);
  expectNear(s.worlds.at(0).radiance, {1, 1, 1});  // it is no light for the rest
}

TEST(Foreign, WrongJsonIsNamedByLineAndByte) {
  const auto message = [](const std::string& text) {
    return errorOf([&] { read(bytesOf(text.data(), text.size())); });
  };
  const std::pair<std::string, const char*> kTable[] = {
      {"{\n \"asset\": {},\n \"nodes\": [1, 2,]\n}", "scene.glb: JSON, line 3, byte 33: "},
      {"{\"a\": tru}", "scene.glb: JSON, line 1, byte 10: "},
      {"{\"a\": \"\xFF\"}", "scene.glb: JSON, line 1, byte 8: "},
      {"{\"a\": 1", "scene.glb: JSON, line 1, byte 7: "},
      {"{\n\n\"a\": 123456789012345678901234567890}", "scene.glb: JSON, line 3, byte "},
      {"{\n\"a\": " + std::string(200, '[') + std::string(200, ']') + "}", "scene.glb: JSON, line 2, byte 1"},
  };
  for (const auto& [text, expected] : kTable) expectHas(message(text), expected);
}

TEST(Foreign, TheSceneKnowsAllFilesThatItWasReadFrom) {
  const TemporaryFolder folder;
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
  b.root["textures"] = {{{"source", 0}}};
  b.root["images"] = {{{"uri", "a.png"}}, {{"uri", "unused.png"}}};
  b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", "scene.bin"}}};
  folder.write("scene.bin", b.binary);
  const std::string text = b.text();
  const fs::path scene = folder.write("scene.gltf", bytesOf(text.data(), text.size()));
  EXPECT_EQ(readGlb(scene).files,
            (std::vector<fs::path>{scene, folder.path / "scene.bin", folder.path / "a.png"}));  // also a missing one
}

// ---- What is chosen where a file does not say
// -------------------------------------------------------------------------

TEST(Foreign, TheFittedViewHoldsEverythingAndFillsTheFilm) {
  const std::pair<int, int> kFilms[] = {{960, 540}, {100, 100}, {90, 300}};
  const json kTransforms[] = {{{"scale", {1, 1, 1}}},
                              {{"scale", {100, 1, 1}}, {"translation", {1e5, 3, -7}}},
                              {{"scale", {1e-4, 20, 1}}, {"rotation", {0.5, 0.5, 0.5, 0.5}}}};
  for (const auto& [width, height] : kFilms)
    for (const json& transform : kTransforms) {
      GlbBuilder b = square();
      b.root["nodes"][0].update(transform);
      b.add("nodes", {{"mesh", 0}, {"translation", {1, 2, 3}}});
      Scene s = read(b);
      s.film.width = s.film.x1 = width, s.film.height = s.film.y1 = height;
      addDefaults(s);
      ASSERT_TRUE(s.camera);
      const Camera& c = *s.camera;
      EXPECT_NEAR((c.right - c.left) / (c.top - c.bottom), float(width) / height, 1e-4);
      const Geometry g(s);
      double most = 0;
      for (int k = 0; k < 8; ++k) {
        const Vec3f p{k & 1 ? g.upper.x : g.lower.x, k & 2 ? g.upper.y : g.lower.y, k & 4 ? g.upper.z : g.lower.z};
        const Vec3f to = p - c.toWorld.t;
        const float depth = -dot(to, c.toWorld.z);
        ASSERT_GT(depth, 0);
        most = std::max<double>(
            {most, std::abs(dot(to, c.toWorld.x)) / depth / c.right, std::abs(dot(to, c.toWorld.y)) / depth / c.top});
      }
      EXPECT_LE(most, 1);
      EXPECT_GE(most, 0.9);
      EXPECT_TRUE(listHas(s.notes, "the scene has no camera"));
    }
}

TEST(Foreign, OnlyWhatIsDarkGetsASky) {
  const auto sky = [](const GlbBuilder& b) {
    Scene s = read(b);
    addDefaults(s);
    const bool has = !s.worlds.empty();
    EXPECT_EQ(has, listHas(s.notes, "the scene has no lights: a constant sky of radiance 1"));
    return has;
  };
  GlbBuilder b = square();
  EXPECT_TRUE(sky(b));
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 0}}};
  b.root["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  EXPECT_TRUE(sky(b));
  b.root["extensions"]["KHR_lights_punctual"]["lights"][0]["intensity"] = 1;
  EXPECT_FALSE(sky(b));
  // a model that glows, and a scene that is lit by what glows
  b = textured({{"emissiveFactor", {1, 0, 0}}});
  EXPECT_TRUE(sky(b));
  b.root["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  b.add("nodes", {{"camera", 0}});
  EXPECT_FALSE(sky(b));
  b = square();
  b.extension() = {{"version", 1}};
  EXPECT_FALSE(sky(b));  // a scene of ours that is dark is meant to be
}

TEST(Foreign, ASceneWithNothingInItHasAViewOfThat) {
  GlbBuilder b;
  b.root["nodes"] = json::array();
  Scene s = read(b);
  addDefaults(s);
  EXPECT_TRUE(s.camera);
  EXPECT_TRUE(listHas(s.notes, "the scene has nothing to render"));
}

TEST(Foreign, ACameraThatMustBeThereIsMissedAtOnce) {
  const TemporaryFolder folder;
  GlbBuilder b = square();
  b.root["accessors"][0]["count"] = 1000;  // would be refused, if it were read
  const fs::path path = folder.write("a.glb", b.bytes());
  expectHas(errorOf([&] { readGlb(path); }), "ends at byte");
  expectHas(errorOf([&] { readGlb(path, true); }), "a.glb: the scene has no camera");
}

}  // namespace
}  // namespace wardmis
