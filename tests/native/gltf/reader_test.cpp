// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "every_operation.h"

namespace wardmis {
namespace {

using namespace test;

// ---- What is read ---------------------------------------------------------------------------------------------------

TEST(Glb, ReadsASquare) {
  const Scene s = read(square());
  ASSERT_EQ(s.meshes.size(), 1u);
  ASSERT_EQ(s.meshes[0].parts.size(), 1u);
  const MeshPart& part = s.meshes[0].parts[0];
  EXPECT_EQ(s.meshes[0].name, "Quad");
  ASSERT_EQ(part.positions.size(), 4u);
  expectNear(part.positions[2], {1, 1, 0}, 0);
  EXPECT_TRUE(part.normals.empty());
  ASSERT_EQ(part.primitives.size(), 1u);
  EXPECT_EQ(std::vector<uint32_t>(part.primitives[0].indices.data.begin(), part.primitives[0].indices.data.end()),
            (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));
  ASSERT_EQ(s.instances.size(), 1u);
  EXPECT_EQ(s.instances[0].name, "Square");
  EXPECT_EQ(s.instances[0].toWorld, Affine{});
  ASSERT_EQ(s.materials.size(), 1u);  // the default
  EXPECT_FLOAT_EQ(s.materials[0].diffuse.value.x, 0.8f);
  EXPECT_FALSE(s.camera);
  EXPECT_FALSE(s.hasFilm);
  EXPECT_EQ(s.film.width, 960);
  EXPECT_EQ(s.degenerateTriangles, 0u);
}

TEST(Glb, IsAViewIntoTheMappedFile) {
  const TemporaryFolder folder;
  const Scene s = readGlb(folder.write("a.glb", square().bytes()));
  const MeshPart& part = s.meshes[0].parts[0];
  EXPECT_EQ(part.positions.owner, part.primitives[0].indices.owner);
  EXPECT_EQ(part.positions.owner.use_count(), 2);  // the two arrays, and nothing else, keep the file mapped
}

TEST(Glb, ReadsEverything) {
  const Scene s = read(everything());
  // Instances: the node's translation times each of its own.
  ASSERT_EQ(s.instances.size(), 2u);
  expectNear(s.instances[0].toWorld.t, {10, 0, 1});
  expectNear(s.instances[1].toWorld.t, {10, 0, 2});
  expectNear(s.instances[1].toWorld.x, {-1, 0, 0});  // half a turn about z
  expectNear(s.instances[1].toWorld.y, {0, -1, 0});
  EXPECT_EQ(s.instances[0].visibility, kSeenByCamera | kCastsShadow);

  // Primitives that share their vertices share a part; the third needs no UVs, so that it is another one.
  const Mesh& mesh = s.meshes.at(0);
  ASSERT_EQ(mesh.parts.size(), 2u);
  ASSERT_EQ(mesh.parts[0].primitives.size(), 2u);
  expectNear({mesh.parts[0].uvs[0].x, mesh.parts[0].uvs[0].y, 0}, {0, 0, 0});  // v is turned over
  expectNear({mesh.parts[0].uvs[2].x, mesh.parts[0].uvs[2].y, 0}, {1, 1, 0});
  const auto strip = mesh.parts[0].primitives[1].indices.data;
  EXPECT_EQ(std::vector<uint32_t>(strip.begin(), strip.end()), (std::vector<uint32_t>{0, 1, 3, 1, 2, 3}));
  EXPECT_EQ(s.degenerateTriangles, 1u);  // the strip's last
  EXPECT_TRUE(mesh.parts[1].uvs.empty());
  const auto fan = mesh.parts[1].primitives[0].indices.data;
  EXPECT_EQ(std::vector<uint32_t>(fan.begin(), fan.end()), (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));

  // Materials, in the order of their first use.
  ASSERT_EQ(s.materials.size(), 3u);
  const Material& plate = s.materials[0];
  EXPECT_EQ(plate.name, "Plate");
  EXPECT_EQ(plate.variant, WardVariant::kWardDur);
  expectNear(plate.diffuse.value, {0.1f, 0.2f, 0.3f});
  expectNear(plate.emission.value, {1, 0, 0});
  EXPECT_FLOAT_EQ(plate.alphaX.value, 0.1f);
  EXPECT_FLOAT_EQ(plate.rotation, 0.25f);
  EXPECT_EQ(plate.alphaY.texture.channel, 1);
  EXPECT_FLOAT_EQ(plate.alphaY.texture.transform[5], 0.5f);
  const Texture& alpha = s.textures.at(plate.alphaY.texture.texture);
  EXPECT_EQ(alpha.wrapU, Wrap::kClamp);
  EXPECT_EQ(alpha.wrapV, Wrap::kMirror);
  EXPECT_EQ(alpha.filter, Filter::kNearest);
  EXPECT_FLOAT_EQ(s.images.at(alpha.image).floats.at(1), 0.5f);
  const Image& pixels = s.images.at(s.textures.at(plate.diffuse.texture.texture).image);
  EXPECT_TRUE(pixels.srgb);
  EXPECT_EQ(pixels.bytes.at(3), 255);  // raw rows are from the bottom already

  const Material& metal = s.materials[1];
  EXPECT_EQ(metal.variant, WardVariant::kWardGmd);
  EXPECT_FLOAT_EQ(metal.alphaX.value, 0.25f);
  expectNear(metal.emission.value, {0, 5, 0});
  EXPECT_NE(metal.diffuse.texture.texture, metal.specular.texture.texture);  // combined texel by texel
  EXPECT_EQ(s.materials[2].name, "(none)");

  // Camera: the node's scale is ignored.
  ASSERT_TRUE(s.camera);
  expectNear(s.camera->toWorld.x, {1, 0, 0});
  expectNear(s.camera->toWorld.z, {0, 0, 1});
  expectNear(s.camera->toWorld.t, {0, 0, 5});
  EXPECT_FLOAT_EQ(s.camera->left, -0.3f);
  EXPECT_FLOAT_EQ(s.camera->right, 0.4f);
  EXPECT_FLOAT_EQ(s.camera->clipFar, 100);
  EXPECT_FLOAT_EQ(s.camera->lensRadius, 0.01f);
  EXPECT_EQ(s.camera->blades, 6);

  // Film and world.
  EXPECT_TRUE(s.hasFilm);
  EXPECT_EQ(s.film.width, 768);
  EXPECT_EQ(s.film.x1, 700);
  EXPECT_EQ(s.film.filter, FilterType::kGaussian);
  EXPECT_FLOAT_EQ(s.film.filterWidth, 2);
  EXPECT_FLOAT_EQ(s.film.exposure, 2);
  EXPECT_TRUE(s.film.transparent);
  EXPECT_TRUE(s.zUp);
  expectNear(s.worlds.at(0).radiance, {1, 2, 3});
  EXPECT_FLOAT_EQ(s.worlds.at(0).matrix[1], 1);
  EXPECT_FLOAT_EQ(s.images.at(s.textures.at(s.worlds.at(0).texture).image).floats.at(3), 4);

  // Lights.
  ASSERT_EQ(s.lights.size(), 6u);
  EXPECT_EQ(s.lights[0].type, LightType::kArea);
  EXPECT_TRUE(s.lights[0].ellipse);
  EXPECT_FLOAT_EQ(s.lights[0].sizeY, 3);
  EXPECT_FLOAT_EQ(s.lights[0].spread, 1);
  expectNear(s.lights[0].emitted, {4, 4, 4});
  EXPECT_EQ(s.lights[1].name, "Lamp");
  expectNear(s.lights[1].emitted, {5, 2.5f, 0});
  expectNear(s.lights[1].toWorld.t, {0, 1, 0});
  EXPECT_FALSE(s.lights[1].facing);
  EXPECT_TRUE(s.lights[2].cosine);
  EXPECT_FLOAT_EQ(s.lights[2].blend, 0.5f);
  EXPECT_FALSE(s.lights[3].shadow);
  EXPECT_FLOAT_EQ(s.lights[3].angle, 0.01f);
  EXPECT_EQ(s.lights[4].name, "Core spot");
  EXPECT_FLOAT_EQ(s.lights[4].angle, 0.8f);
  EXPECT_NEAR(std::cos(0.4) + (1 - std::cos(0.4)) * s.lights[4].blend, std::cos(0.2), 1e-6);
  EXPECT_EQ(s.lights[5].type, LightType::kSun);
  expectNear(s.lights[5].emitted, {0, 0, 1});

  EXPECT_EQ(s.notes, std::vector<std::string>{"material 'Glass': rendered as magenta"});
  EXPECT_TRUE(listHas(s.leftOut, "KHR_materials_clearcoat"));
  EXPECT_TRUE(listHas(s.leftOut, "its power is 0"));
}

TEST(Glb, TakesEveryLayoutOfAccessors) {
  // Strided: positions interleaved with normals.
  GlbBuilder b = square();
  const std::vector<float> mixed = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
  const int view = b.view(mixed, {{"byteStride", 24}});
  const json like = {{"bufferView", view}, {"count", 4}, {"type", "VEC3"}, {"componentType", 5126}};
  json normals = like;
  normals["byteOffset"] = 12;
  primitive(b)["attributes"] = {{"POSITION", b.add("accessors", like)}, {"NORMAL", b.add("accessors", normals)}};
  Scene s = read(b);
  expectNear(s.meshes[0].parts[0].positions[2], {1, 1, 0}, 0);
  expectNear(s.meshes[0].parts[0].normals[3], {0, 0, 1}, 0);

  // Integers, normalised or not.
  b = square();
  primitive(b)["attributes"] = {
      {"POSITION", b.accessor<int16_t>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 2, 0}, 3)},
      {"NORMAL", b.accessor<int8_t>({0, 0, 127, 0, 0, -128, 0, 0, 127, 0, 0, 64}, 3, {{"normalized", true}})}};
  s = read(b);
  expectNear(s.meshes[0].parts[0].positions[3], {0, 2, 0}, 0);
  EXPECT_FLOAT_EQ(s.meshes[0].parts[0].normals[1].z, -1);
  EXPECT_FLOAT_EQ(s.meshes[0].parts[0].normals[3].z, 64 / 127.0f);

  // Sparse, over data and over nothing.
  for (const bool hasBase : {true, false}) {
    b = square();
    json& accessor = b.root["accessors"][0];
    if (!hasBase) accessor.erase("bufferView");
    const int where = b.view<uint8_t>({1, 2, 3});
    const int what = b.view<float>({5, 0, 0, 5, 5, 0, 0, 5, 0});
    accessor["sparse"] = {{"count", 3},
                          {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                          {"values", {{"bufferView", what}}}};
    s = read(b);
    expectNear(s.meshes[0].parts[0].positions[0], {0, 0, 0}, 0);
    expectNear(s.meshes[0].parts[0].positions[2], {5, 5, 0}, 0);
  }

  // No indices; and data that is not aligned in memory, since the text before it has an odd length.
  b = square();
  primitive(b).erase("indices");
  primitive(b)["attributes"]["POSITION"] = b.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.root["buffers"] = {{{"byteLength", b.binary.size()}}};
  Bytes odd = b.bytes();
  uint32_t length;
  std::memcpy(&length, odd.data() + 12, 4);
  odd.insert(odd.begin() + 20 + length, std::byte{' '});
  length++;
  std::memcpy(odd.data() + 12, &length, 4);
  const uint32_t whole = static_cast<uint32_t>(odd.size());
  std::memcpy(odd.data() + 8, &whole, 4);
  s = read(odd);
  EXPECT_EQ(s.meshes[0].parts[0].primitives[0].indices.size(), 3u);
  expectNear(s.meshes[0].parts[0].positions[2], {0, 1, 0}, 0);
}

TEST(Glb, DropsDegenerateTriangles) {
  GlbBuilder b = square();
  primitive(b)["indices"] = b.accessor<uint32_t>({0, 0, 1, 0, 1, 2, 1, 1, 1, 0, 2, 3, 2, 3, 3}, 1);
  Scene s = read(b);
  EXPECT_EQ(s.degenerateTriangles, 3u);
  const auto kept = s.meshes[0].parts[0].primitives[0].indices.data;
  EXPECT_EQ(std::vector<uint32_t>(kept.begin(), kept.end()), (std::vector<uint32_t>{0, 1, 2, 0, 2, 3}));

  primitive(b)["indices"] = b.accessor<uint32_t>({0, 0, 1}, 1);
  s = read(b);
  EXPECT_TRUE(s.meshes.empty());
  EXPECT_TRUE(s.instances.empty());
  EXPECT_TRUE(listHas(s.leftOut, "'Square': its mesh has nothing to render"));
}

// A sky for each kind of ray; what is black is none.
GlbBuilder withSeveralWorlds() {
  GlbBuilder b = square();
  const int texture = rawTexture<float>(b, 1, 1, 1, {1}), other = rawTexture<float>(b, 1, 1, 1, {2});
  b.extension() = {{"version", 1},
                   {"world",
                    {{{"radiance", {1, 2, 3}}, {"visibility", {"camera"}}},
                     {{"radiance", {0, 0, 0}}, {"texture", {{"index", other}}}},
                     {{"texture", {{"index", texture}, {"projection", "mirror-ball"}}},
                      {"visibility", {"diffuse", "glossy", "transmission"}},
                      {"maxBounces", 2}},
                     {{"radiance", {4, 4, 4}}, {"visibility", json::array()}}}}};
  return b;
}
TEST(Glb, ReadsSeveralWorlds) {
  const Scene scene = read(withSeveralWorlds());
  ASSERT_EQ(scene.worlds.size(), 3u);
  expectNear(scene.worlds[0].radiance, {1, 2, 3});
  EXPECT_EQ(scene.worlds[0].visibility, kSeenByCamera);
  EXPECT_EQ(scene.worlds[0].maxBounces, 1024);
  EXPECT_EQ(scene.worlds[1].visibility, kSeenBySurfaces);
  EXPECT_EQ(scene.worlds[1].maxBounces, 2);
  EXPECT_EQ(scene.worlds[1].map, SkyMap::kMirrorBall);
  EXPECT_EQ(scene.images.at(scene.textures.at(scene.worlds[1].texture).image).floats.at(0), 1);
  EXPECT_EQ(scene.worlds[2].visibility, 0);
}

// Less light than none, and a light that does not follow every path.
TEST(Glb, ReadsLightsThatTakeAwayAndEnd) {
  GlbBuilder b = square();
  b.extension() = {{"version", 1}, {"world", {{"radiance", {-1, 0, 0.5}}}}};
  b.extension()["lights"] = {{{"type", "sun"}, {"irradiance", -2}, {"color", {1, 0, 0.5}}, {"maxBounces", 3}}};
  b.root["nodes"][0]["extensions"]["WARDMIS_scene"]["light"] = 0;
  const Scene scene = read(b);
  expectNear(scene.worlds.at(0).radiance, {-1, 0, 0.5f});
  ASSERT_EQ(scene.lights.size(), 1u);
  expectNear(scene.lights[0].emitted, {-2, 0, -1});
  EXPECT_EQ(scene.lights[0].maxBounces, 3);
}

TEST(Glb, ReadsWhatCatchesShadows) {
  GlbBuilder b = square();
  const Scene usual = read(b);
  EXPECT_FALSE(usual.instances.at(0).shadowCatcher);
  b.extension() = {{"version", 1}};
  b.extension()["lights"] = {{{"type", "point"}, {"intensity", 2}},
                             {{"type", "point"}, {"intensity", 2}, {"onCatchers", false}}};
  json& nodes = b.root["nodes"];
  nodes[0]["extensions"]["WARDMIS_scene"] = {{"shadowCatcher", true}, {"light", 0}};
  nodes.push_back({{"extensions", {{"WARDMIS_scene", {{"light", 1}}}}}});
  b.root["scenes"] = {{{"nodes", json::array()}}};
  for (size_t i = 0; i < nodes.size(); ++i) b.root["scenes"][0]["nodes"].push_back(i);
  const Scene scene = read(b);
  EXPECT_TRUE(scene.instances.at(0).shadowCatcher);
  ASSERT_EQ(scene.lights.size(), 2u);
  EXPECT_TRUE(scene.lights[0].onCatchers);
  EXPECT_FALSE(scene.lights[1].onCatchers);
}

TEST(Glb, ReadsTheTerminatorOfShadows) {
  GlbBuilder b = square();
  EXPECT_EQ(read(b).instances.at(0).terminator.geometry, 0);
  b.root["nodes"][0]["extensions"]["WARDMIS_scene"] = {{"shadowTerminator", {0.25, 0.5}}};
  const Scene scene = read(b);
  EXPECT_EQ(scene.instances.at(0).terminator.geometry, 0.25f);
  EXPECT_EQ(scene.instances.at(0).terminator.shading, 0.5f);
  b.root["nodes"][0]["extensions"]["WARDMIS_scene"]["shadowTerminator"][1] = 2;
  EXPECT_THROW(read(b), Error);
}

TEST(Glb, MultipliesTheHierarchy) {
  GlbBuilder b = square();
  b.root["nodes"] = {
      {{"children", {1}}, {"matrix", {0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 7, 0, 0, 1}}},
      {{"mesh", 0}, {"translation", {1, 2, 3}}, {"scale", {2, 2, 2}}, {"rotation", {0, 0, 0.70710678, 0.70710678}}},
      {{"mesh", 0}, {"name", "Flat"}, {"scale", {1, 1, 0}}},
      {{"mesh", 0}, {"name", "Elsewhere"}}};
  b.root["scenes"] = {{{"nodes", {3}}}, {{"nodes", {0, 2}}}};
  b.root["scene"] = 1;
  const Scene s = read(b);
  ASSERT_EQ(s.instances.size(), 1u);
  expectNear(s.instances[0].toWorld.t, {7 + 3, 2, -1});
  expectNear(s.instances[0].toWorld.x, {0, 2, 0});  // x -> y by the rotation, which the parent keeps
  expectNear(s.instances[0].toWorld.y, {0, 0, 2});  // y -> -x -> z
  EXPECT_TRUE(listHas(s.leftOut, "'Flat'"));
  EXPECT_TRUE(listHas(s.leftOut, "other scenes"));
}

TEST(Glb, MapsCoreMaterials) {
  const auto material = [](const json& pbr) { return read(textured({{"pbrMetallicRoughness", pbr}})).materials.at(0); };
  Material m = material({{"baseColorFactor", {0.5, 0.25, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0.5}});
  expectNear(m.diffuse.value, {0.5f, 0.25f, 0});
  expectNear(m.specular.value, {0.04f, 0.04f, 0.04f});
  EXPECT_FLOAT_EQ(m.alphaX.value, 0.25f);
  m = material({{"baseColorFactor", {0.5, 0.25, 0, 1}}, {"roughnessFactor", 0}});  // metallic is 1 by default
  expectNear(m.diffuse.value, {0, 0, 0});
  expectNear(m.specular.value, {0.5f, 0.25f, 0});
  EXPECT_FLOAT_EQ(m.alphaY.value, 1e-6f);
  m = material({{"baseColorFactor", {1, 0.25, 0, 1}}, {"metallicFactor", 0}});  // diffuse + specular <= 1
  expectNear(m.diffuse.value, {1 / 1.04f, 0.25f / 1.04f, 0});
  expectNear(m.specular.value, {0.04f / 1.04f, 0.04f / 1.04f, 0.04f / 1.04f});

  // Metallic and roughness from a texture: one texel at each end of the unit interval.
  GlbBuilder b = textured({{"pbrMetallicRoughness",
                            {{"baseColorFactor", {0.5, 0.5, 0.5, 1}}, {"metallicRoughnessTexture", {{"index", 0}}}}}});
  rawTexture<uint8_t>(b, 2, 1, 3, {0, 255, 0, 0, 51, 255});
  const Scene s = read(b);
  const Image& diffuse = s.images.at(s.textures.at(s.materials[0].diffuse.texture.texture).image);
  const Image& specular = s.images.at(s.textures.at(s.materials[0].specular.texture.texture).image);
  const Image& alpha = s.images.at(s.textures.at(s.materials[0].alphaX.texture.texture).image);
  EXPECT_EQ(diffuse.bytes.at(0), 188);  // sRGB of 0.5
  EXPECT_EQ(diffuse.bytes.at(3), 0);
  EXPECT_EQ(specular.bytes.at(3), 188);
  EXPECT_FLOAT_EQ(alpha.floats.at(0), 1);
  EXPECT_NEAR(alpha.floats.at(1), 0.04f, 1e-6f);
  EXPECT_EQ(s.images.size(), 3u);  // the source is gone
}

TEST(Glb, AppliesTextureTransforms) {
  // The example of KHR_texture_transform: the lower left quadrant, turned clockwise by a quarter.
  GlbBuilder b =
      textured({{"pbrMetallicRoughness",
                 {{"metallicFactor", 0},
                  {"baseColorTexture",
                   {{"index", 0},
                    {"extensions",
                     {{"KHR_texture_transform",
                       {{"offset", {0, 1}}, {"rotation", 1.5707963267948966}, {"scale", {0.5, 0.5}}}}}}}}}}});
  rawTexture<uint8_t>(b, 1, 1, 3, {1, 2, 3});
  const Scene s = read(b);
  const float* m = s.materials[0].diffuse.texture.transform;
  const auto at = [&](float u, float v) { return Vec3f{m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5], 0}; };
  // In v-up coordinates: the file's (0, 0), the upper left, goes to the lower left corner, (0, 0.5 down) and so on.
  expectNear(at(0, 1), {0, 0, 0});
  expectNear(at(1, 1), {0, 0.5f, 0});
  expectNear(at(0, 0), {0.5f, 0, 0});
  expectNear(at(1, 0), {0.5f, 0.5f, 0});
}

TEST(Glb, TexturesAsBlenderFiltersThem) {
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
  rawTexture<uint8_t>(b, 1, 1, 4, {100, 200, 255, 51});
  json& image = b.root["images"][0]["extensions"]["WARDMIS_scene"];
  image["colorSpace"] = "sRGB";
  image["filterEncoded"] = true;
  image["alpha"] = "multiplies";
  b.root["textures"][0]["extensions"]["WARDMIS_scene"] = {{"filter", "cubic"}, {"wrap", "clip"}};
  const Scene s = read(b);
  EXPECT_EQ(s.textures.at(0).filter, Filter::kCubic);
  EXPECT_EQ(s.textures.at(0).wrapU, Wrap::kClip);
  EXPECT_EQ(s.textures.at(0).wrapV, Wrap::kClip);
  EXPECT_TRUE(s.images.at(0).filterEncoded);
  EXPECT_EQ(s.images.at(0).bytes, (Texels<uint8_t>{20, 40, 51, 51}));  // a fifth
  image["alpha"] = "ignored";
  EXPECT_EQ(read(b).images.at(0).bytes, (Texels<uint8_t>{100, 200, 255, 255}));
}

TEST(Glb, LoadsImagesFromTheFileAndItsFolder) {
  const TemporaryFolder folder;
  folder.write("sub/wood grain.png", png2x1({255, 0, 0, 0, 255, 0}));
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}},
                                {"specular", {{"value", {1, 1, 1}}, {"texture", {{"index", 1}}}}},
                                {"alphaX", {{"texture", {{"index", 0}, {"channel", 3}}}}},
                                {"alphaY", {{"texture", {{"index", 0}, {"channel", 2}}}}}}));
  b.add("images", {{"uri", "sub/wood%20grain.png"}});
  b.add("images", {{"mimeType", "image/png"}, {"bufferView", b.view(png2x1({0, 0, 255, 9, 9, 9}))}});
  b.add("images", {{"name", "Unused"}, {"uri", "missing.png"}});
  b.add("textures", {{"source", 0}});
  b.add("textures", {{"source", 1}});
  const Scene s = readGlb(folder.write("scene.glb", b.bytes()));
  const Material& m = s.materials.at(0);
  const auto image = [&](const TextureUse& use) { return s.images.at(s.textures.at(use.texture).image); };
  EXPECT_EQ(image(m.diffuse.texture).bytes, (Texels<uint8_t>{255, 0, 0, 0, 255, 0}));
  EXPECT_TRUE(image(m.diffuse.texture).srgb);
  EXPECT_EQ(m.alphaX.texture.texture, -1);     // a channel that the image lacks: alpha is 1
  EXPECT_FALSE(image(m.alphaY.texture).srgb);  // the same file as numbers
  EXPECT_EQ(image(m.specular.texture).bytes.at(2), 255);
  EXPECT_TRUE(listHas(s.leftOut, "image 'Unused'"));

  // The same scene as text.
  b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", "scene.bin"}}};
  folder.write("scene.bin", b.binary);
  const std::string text = "\xEF\xBB\xBF " + b.text();
  EXPECT_EQ(readGlb(folder.write("scene.gltf", test::bytesOf(text.data(), text.size()))).images.size(), 3u);
}

TEST(Glb, ReadsDataUris) {
  GlbBuilder b = square();
  b.root["buffers"] = {
      {{"byteLength", 9 * 4},
       {"uri", "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
  b.root["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
  b.root["accessors"] = {{{"bufferView", 0}, {"count", 3}, {"type", "VEC3"}, {"componentType", 5126}}};
  primitive(b).erase("indices");
  const std::string text = b.text();
  const Scene s = read(test::bytesOf(text.data(), text.size()));
  expectNear(s.meshes[0].parts[0].positions[1], {1, 0, 0}, 0);
  b.root["buffers"][0]["uri"] = "data:application/octet-stream;base64,AA*A";
  expectHas(errorOf(b), "buffers[0].uri: its base64 data is wrong");
}

TEST(Glb, FitsCoreCamerasToTheFilm) {
  GlbBuilder b = square();
  b.root["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.5707963}, {"aspectRatio", 1}, {"znear", 0.5}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}}};
  b.add("nodes", {{"camera", 0}});
  Scene s = read(b);
  EXPECT_NEAR(s.camera->top, 1, 1e-6);
  EXPECT_NEAR(s.camera->right, 960.0 / 540, 1e-6);
  EXPECT_FLOAT_EQ(s.camera->clipNear, 0.5f);
  b.root["nodes"][1]["camera"] = 1;
  s = read(b);
  EXPECT_TRUE(s.camera->orthographic());
  EXPECT_FLOAT_EQ(s.camera->bottom, -2);
  EXPECT_FLOAT_EQ(s.camera->clipFar, 9);
}

TEST(Glb, SaysWhatItLeavesOut) {
  GlbBuilder b = textured(ward({{"diffuse", {{"value", {1, 1, 1}}}}}));
  primitive(b)["attributes"]["COLOR_0"] = b.accessor<float>(std::vector<float>(12, NAN), 3);  // not even looked at
  primitive(b)["attributes"]["TANGENT"] = b.accessor<float>(std::vector<float>(16, NAN), 4);
  primitive(b)["targets"] = json::array();
  b.add("meshes", {{"primitives", 5}});
  b.add("materials", {{"name", "Spare"}});
  b.root["animations"] = {1};
  b.root["nodes"][0]["skin"] = 0;
  json points = primitive(b);
  points["mode"] = 0;
  b.root["meshes"][0]["primitives"].push_back(points);
  const Scene s = read(b);
  EXPECT_TRUE(s.meshes[0].parts[0].uvs.empty());
  for (const char* what :
       {"vertex colours of mesh 'Quad' with material 'Plate'", "TANGENT", "TEXCOORD_0", "morph targets of mesh 'Quad'",
        "1 meshes", "'Spare'", "animations", "skin of 'Square'", "points and lines"})
    EXPECT_TRUE(listHas(s.leftOut, what)) << what;
}

TEST(Glb, KeepsUvsForAnisotropy) {
  EXPECT_FALSE(
      read(textured(ward(
               {{"specular", {{"value", {1, 1, 1}}}}, {"alphaX", {{"value", 0.1}}}, {"alphaY", {{"value", 0.2}}}})))
          .meshes[0]
          .parts[0]
          .uvs.empty());
}

TEST(Glb, MendsImages) {
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
  rawTexture<float>(b, 2, 2, 1, {NAN, -1, INFINITY, 0.5f});
  const Scene s = read(b);
  EXPECT_EQ(s.images[0].floats, (Texels<float>{0, -1, 0, 0.5f}));
  EXPECT_TRUE(listHas(s.leftOut, "2 values of image 'Pixels'"));
}

// One image is no reason not to render the rest: it is magenta, and named.
TEST(Glb, ShowsDamagedImagesInMagenta) {
  GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
  b.root["textures"] = {{{"source", 0}}};
  b.root["images"] =
      json::array({{{"name", "Wood"}, {"bufferView", b.view<uint8_t>({0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0})}}});
  const Scene s = read(b.bytes());
  ASSERT_EQ(s.images.size(), 1u);
  EXPECT_EQ(s.images[0].bytes, (Texels<uint8_t>{255, 0, 255}));
  ASSERT_EQ(s.notes.size(), 1u);
  expectHas(s.notes[0], "image 'Wood' is a damaged PNG file");
  expectHas(s.notes[0], "(needed by material 'Plate'); magenta is shown instead");
}

// ---- What is refused ------------------------------------------------------------------------------------------------

TEST(Glb, RefusesEveryTruncation) {
  const Bytes whole = everything().bytes();
  for (size_t n = 0; n < whole.size(); n++) {
    const std::string message = errorOf([&] { read(Bytes(whole.begin(), whole.begin() + n)); });
    EXPECT_TRUE(message.starts_with("scene.glb: ")) << message;
  }
}

TEST(Glb, SurvivesEveryWrongByte) {
  const Bytes whole = everything().bytes();
  for (size_t i = 0; i < whole.size(); i++)
    for (const int change : {0x01, 0x10, 0x80, 0xFF}) {
      Bytes copy = whole;
      copy[i] ^= static_cast<std::byte>(change);
      try {
        read(copy);
      } catch (const Error& e) {
        ASSERT_EQ(e.code, ExitCode::kScene) << e.what();
      }
    }
}

TEST(Glb, RefusesWrongContainers) {
  const Bytes good = square().bytes();
  const auto with = [&](size_t offset, uint32_t value) {
    Bytes copy = good;
    std::memcpy(copy.data() + offset, &value, 4);
    return errorOf([&] { read(copy); });
  };
  expectHas(with(0, 0x12345678), "neither a GLB file");
  expectHas(with(4, 1), "expected version 2, found 1");
  expectHas(with(8, 20), "GLB chunk 0: claims");
  expectHas(with(8, 4), "claims 4 bytes");
  expectHas(with(8, UINT32_MAX), "claims 4294967295 bytes");
  expectHas(with(12, UINT32_MAX - 3), "GLB chunk 0: claims");
  expectHas(with(12, 6), "GLB chunk 1: claims");
  expectHas(with(16, 0x004E4942), "must be JSON");
  uint32_t jsonLength;
  std::memcpy(&jsonLength, good.data() + 12, 4);
  expectHas(with(20 + jsonLength + 4, 0x4E4F534A), "GLB chunk 1: the first chunk, and only it, must be JSON");

  // A second BIN chunk.
  Bytes twice = good;
  twice.insert(twice.end(), good.begin() + 20 + jsonLength, good.end());
  const uint32_t size = static_cast<uint32_t>(twice.size());
  std::memcpy(twice.data() + 8, &size, 4);
  expectHas(errorOf([&] { read(twice); }), "GLB chunk 2: only the second chunk may be BIN");

  expectHas(errorOf([] { read(Bytes{}); }), "is empty");
  expectHas(errorOf([] { read(GlbBuilder::glb("", {})); }), "JSON");
  expectHas(errorOf([] { read(GlbBuilder::glb("[]", {})); }), "expected an object, found []");
  std::string deep = R"({"extras":)" + std::string(100'000, '[') + std::string(100'000, ']') + "}";
  expectHas(errorOf([&] { read(GlbBuilder::glb(deep, {})); }), "JSON");
}

// A change to a good scene, and what the message must hold.
struct Hostile {
  const char* expected;
  std::function<void(GlbBuilder&)> change;
};

TEST(Glb, RefusesHostileScenes) {
  const auto nan = [](float bad) {
    return [bad](GlbBuilder& b) {
      primitive(b)["attributes"]["POSITION"] = b.accessor<float>({0, 0, 0, 1, 0, 0, 1, bad, 0, 0, 1, 0}, 3);
    };
  };
  const auto node = [](const json& value) { return [value](GlbBuilder& b) { b.root["nodes"][0].update(value); }; };
  const auto material = [](const json& value) {
    return [value](GlbBuilder& b) { primitive(b)["material"] = b.add("materials", value); };
  };
  const auto extension = [](const json& value) {
    return [value](GlbBuilder& b) { (b.extension() = {{"version", 1}}).update(value); };
  };
  const auto light = [](const json& value) {
    return [value](GlbBuilder& b) {
      b.extension() = {{"version", 1}, {"lights", json::array({value})}};
      b.root["nodes"][0]["extensions"]["WARDMIS_scene"]["light"] = 0;
    };
  };
  const auto instancing = [](const json& attributes) {
    return [attributes](GlbBuilder& b) {
      b.root["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = attributes;
    };
  };
  const auto uri = [](std::string text) {
    return [text](GlbBuilder& b) { b.root["buffers"] = {{{"uri", text}, {"byteLength", 4}}}; };
  };
  const auto camera = [](const json& value) {
    return [value](GlbBuilder& b) {
      b.root["cameras"] = {{{"extensions", {{"WARDMIS_scene", value}}}}};
      b.root["nodes"][0]["camera"] = 0;
    };
  };
  const auto image = [](const json& value) {
    return [value](GlbBuilder& b) {
      primitive(b)["material"] = b.add("materials", ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
      b.root["textures"] = {{{"source", 0}}};
      b.root["images"] = json::array({value});
    };
  };

  const Hostile kTable[] = {
      // asset and extensions
      {"extensionsRequired[0]: the scene requires the extension 'KHR_techniques_webgl'",
       [](GlbBuilder& b) { b.root["extensionsRequired"] = {"KHR_techniques_webgl"}; }},
      {"'asset' is missing", [](GlbBuilder& b) { b.root.erase("asset"); }},
      {"asset.version: expected glTF version 2.x, found \"1.0\"", [](GlbBuilder& b) { b.root["asset"]["version"] = "1.0"; }},
      {"extensions.WARDMIS_scene.version: expected version 1", [](GlbBuilder& b) { b.extension()["version"] = 2; }},
      {"extensions.WARDMIS_scene.upAxis: expected one of \"Y\", \"Z\", found \"X\"", extension({{"upAxis", "X"}})},
      {"nodes: expected an array, found an object", [](GlbBuilder& b) { b.root["nodes"] = json::object(); }},
      {"nodes[0]: expected an object, found 3", [](GlbBuilder& b) { b.root["nodes"][0] = 3; }},
      // nodes
      {"nodes[0] 'Square' .mesh: refers to meshes[1], but the file has 1", node({{"mesh", 1}})},
      {"nodes[0] 'Square' .mesh: expected a whole number >= 0, found -1", node({{"mesh", -1}})},
      {"nodes[0] 'Square' .mesh: expected a whole number >= 0, found 0.5", node({{"mesh", 0.5}})},
      {"nodes[0] 'Square' .mesh: expected a whole number >= 0, found \"0\"", node({{"mesh", "0"}})},
      {"nodes[0] 'Square' .mesh: refers to meshes[18446744073709551615]", node({{"mesh", UINT64_MAX}})},
      {"nodes[0] 'Square': has more than 63 ancestors, or is its own", node({{"children", {0}}})},
      {"nodes[1]: has more than 63 ancestors, or is its own",
       [](GlbBuilder& b) {
         b.add("nodes", {{"children", {2}}});
         b.add("nodes", {{"children", {1}}});
       }},
      {"has more than 63 ancestors",
       [](GlbBuilder& b) {
         for (int i = 1; i <= 64; i++) b.add("nodes", {{"children", {i - 1}}});
       }},
      {"nodes[1].children[0]: node 2 is a child of nodes[0] already",
       [](GlbBuilder& b) {
         b.root["nodes"][0]["children"] = {2};
         b.add("nodes", {{"children", {2}}});
         b.add("nodes", json::object());
       }},
      {"scene: refers to scenes[5]",
       [](GlbBuilder& b) {
         b.root["scenes"] = {{{"nodes", {0}}}};
         b.root["scene"] = 5;
       }},
      {".translation: expected 3 numbers, found [1, 2]", node({{"translation", {1, 2}}})},
      {".translation[1]: expected a number, found \"x\"", node({{"translation", {1, "x", 2}}})},
      {".scale[0]: expected a number of single precision, found 1e+300", node({{"scale", {1e300, 1, 1}}})},
      {"'Square': its rotation is not a unit quaternion", node({{"rotation", {0, 0, 0, 0}}})},
      {"'Square' .matrix: its last row", node({{"matrix", json::array({1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})}})},
      {"has both a matrix and", node({{"matrix", json::array({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1})}, {"scale", {1, 1, 1}}})},
      {"nodes[1]: its world matrix is not finite",
       [](GlbBuilder& b) {
         b.root["nodes"][0]["scale"] = {1e38, 1e38, 1e38};
         b.root["nodes"][0]["children"] = {1};
         b.add("nodes", {{"mesh", 0}, {"scale", {1e38, 1, 1}}});
       }},
      {".visibility[0]: expected one of \"camera\"", node({{"extensions", {{"WARDMIS_scene", {{"visibility", {"nobody"}}}}}}})},
      // meshes
      {"meshes[0] 'Quad': 'primitives' is missing", [](GlbBuilder& b) { b.root["meshes"][0].erase("primitives"); }},
      {"meshes[0] 'Quad' .primitives: expected at least one", [](GlbBuilder& b) { b.root["meshes"][0]["primitives"] = json::array(); }},
      {"primitives[0].mode: expected a whole number from 0 to 6, found 7", [](GlbBuilder& b) { primitive(b)["mode"] = 7; }},
      {"primitives[0].material: refers to materials[0], but the file has 0", [](GlbBuilder& b) { primitive(b)["material"] = 0; }},
      {"primitives[0].indices: refers to vertex 4, but there are 4",
       [](GlbBuilder& b) { primitive(b)["indices"] = b.accessor<uint8_t>({0, 1, 4}, 1); }},
      {"meshes[0] 'Quad' .primitives[0].attributes.POSITION: element 2 of accessor 2 is not finite", nan(NAN)},
      {"element 2 of accessor 2 is not finite", nan(INFINITY)},
      {"triangle 0 is too large for single precision", nan(1e30f)},
      {"attributes.NORMAL: has 1 elements, but POSITION has 4",
       [](GlbBuilder& b) { primitive(b)["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1}, 3); }},
      // accessors
      {"attributes.POSITION: refers to accessors[9]", [](GlbBuilder& b) { primitive(b)["attributes"]["POSITION"] = 9; }},
      {"attributes.POSITION: expected elements of type VEC3, but accessor 1 has 1", [](GlbBuilder& b) { primitive(b)["attributes"]["POSITION"] = 1; }},
      {"indices: expected elements of type SCALAR", [](GlbBuilder& b) { primitive(b)["indices"] = 0; }},
      {"indices: accessor 2 has componentType 5126",
       [](GlbBuilder& b) { primitive(b)["indices"] = b.accessor<float>({0, 1, 2}, 1); }},
      {"attributes.POSITION: accessor 0 ends at byte 4812, but its bufferView has 48 bytes", [](GlbBuilder& b) { b.root["accessors"][0]["count"] = 401; }},
      {"accessors[0].count: expected a whole number from 1", [](GlbBuilder& b) { b.root["accessors"][0]["count"] = 0; }},
      {"accessors[0].count: expected a whole number from 1", [](GlbBuilder& b) { b.root["accessors"][0]["count"] = uint64_t(1) << 40; }},
      {"accessor 0 claims 4000000000 elements without data",
       [](GlbBuilder& b) {
         b.root["accessors"][0].erase("bufferView");
         b.root["accessors"][0]["count"] = 4000000000u;
       }},
      {"accessors[0].type: expected one of \"SCALAR\"", [](GlbBuilder& b) { b.root["accessors"][0]["type"] = "VEC5"; }},
      {"accessors[0].componentType: expected 5120, 5121", [](GlbBuilder& b) { b.root["accessors"][0]["componentType"] = 5124; }},
      {"accessors[0].byteOffset: expected a whole number", [](GlbBuilder& b) { b.root["accessors"][0]["byteOffset"] = UINT64_MAX; }},
      {"accessors[0].byteOffset: expected a whole number >= 0, found -4", [](GlbBuilder& b) { b.root["accessors"][0]["byteOffset"] = -4; }},
      {"attributes.POSITION: accessor 0 has elements of 12 bytes, but its byteStride is 4", [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 4; }},
      {"bufferViews[0].byteStride: expected a whole number from 4 to 252, found 0", [](GlbBuilder& b) { b.root["bufferViews"][0]["byteStride"] = 0; }},
      {"bufferView 0 has 48 bytes from byte 18446744073709551600 on", [](GlbBuilder& b) { b.root["bufferViews"][0]["byteOffset"] = UINT64_MAX - 15; }},
      {"bufferView 0 has 18446744073709551615 bytes", [](GlbBuilder& b) { b.root["bufferViews"][0]["byteLength"] = UINT64_MAX; }},
      {"bufferViews[0].buffer: refers to buffers[7]", [](GlbBuilder& b) { b.root["bufferViews"][0]["buffer"] = 7; }},
      {"sparse.count: expected a whole number from 1 to 4, found 5",
       [](GlbBuilder& b) { b.root["accessors"][0]["sparse"] = {{"count", 5}}; }},
      {"sparse.indices: refers to element 4, but there are 4",
       [](GlbBuilder& b) {
         const int where = b.view<uint8_t>({4}), what = b.view<float>({1, 2, 3});
         b.root["accessors"][0]["sparse"] = {{"count", 1}, {"indices", {{"bufferView", where}, {"componentType", 5121}}}, {"values", {{"bufferView", what}}}};
       }},
      {"sparse.values: ends at byte 24",
       [](GlbBuilder& b) {
         const int where = b.view<uint8_t>({1, 2}), what = b.view<float>({1, 2, 3});
         b.root["accessors"][0]["sparse"] = {{"count", 2}, {"indices", {{"bufferView", where}, {"componentType", 5121}}}, {"values", {{"bufferView", what}}}};
       }},
      // buffers and uris
      {"buffers[0]: claims 99999 bytes", [](GlbBuilder& b) { b.root["buffers"] = {{{"byteLength", 99999}}}; }},
      {"buffers[0]: 'byteLength' is missing", [](GlbBuilder& b) { b.root["buffers"] = json::array({json::object()}); }},
      {"buffers[1]: has no uri, and the file has no binary chunk for it",
       [](GlbBuilder& b) {
         b.root["buffers"] = {{{"byteLength", 4}}, {{"byteLength", 4}}};
         b.root["bufferViews"][0]["buffer"] = 1;
       }},
      {"buffers[0].uri: '/etc/passwd' is not a file in the scene's folder", uri("/etc/passwd")},
      {"buffers[0].uri: '../a.bin' is not a file in", uri("../a.bin")},
      {"buffers[0].uri: 'a/../../b' is not a file in", uri("a/%2e%2E/../b")},
      {"buffers[0].uri: 'file:///etc/passwd' is not a file in", uri("file:///etc/passwd")},
      {"buffers[0].uri: 'http://example.org/a' is not a file in", uri("http://example.org/a")},
      {"buffers[0].uri: '..\\a' is not a file in", uri("..\\a")},
      {"buffers[0].uri: 'a%2' is not a valid uri", uri("a%2")},
      {"buffers[0].uri: 'a%00b' is not a valid uri", uri("a%00b")},
      {"buffers[0].uri: '' is not a valid uri", uri("")},
      {"buffers[0].uri: 'missing.bin' cannot be read: No such file", uri("missing.bin")},
      {"buffers[0].uri: expected 'data:TYPE;base64", uri("data:text/plain,hello")},
      // materials and images
      {"materials[0] 'Plate' .extensions.WARDMIS_scene.diffuse.value: expected three numbers >= 0, found [1, -1, 0]",
       material(ward({{"diffuse", {{"value", {1, -1, 0}}}}}))},
      {"diffuse.value[0]: expected a number of single precision, found 1e+39", material(ward({{"diffuse", {{"value", {1e39, 1, 0}}}}}))},
      {"alphaX.value: expected a number >= 0, found -0.1", material(ward({{"alphaX", {{"value", -0.1}}}}))},
      {"alphaX.texture.index: refers to textures[3]", material(ward({{"alphaX", {{"texture", {{"index", 3}}}}}}))},
      {"alphaX.texture: 'index' is missing", material(ward({{"alphaX", {{"texture", json::object()}}}}))},
      {"variant: expected one of \"ward\", \"ward-dur\", \"ward-gmd\", found \"phong\"", material(ward({{"variant", "phong"}}))},
      {"metallicFactor: expected a number from 0 to 1, found 2", material({{"pbrMetallicRoughness", {{"metallicFactor", 2}}}})},
      {"baseColorFactor: expected four numbers >= 0", material({{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, -1, 1}}}}})},
      {"emissiveFactor: expected three numbers >= 0", material({{"emissiveFactor", {-1, 0, 0}}})},
      {"its emission is not a number", material({{"emissiveFactor", {1e30, 0, 0}}, {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 1e30}}}}}})},
      {"images[0]: 3 x 3 pixels of 1 channels need 9 bytes, found 48 (needed by material 'Plate')",
       image({{"bufferView", 0}, {"mimeType", "application/x-wardmis-pixels"}, {"extensions", {{"WARDMIS_scene", {{"width", 3}, {"height", 3}, {"channels", 1}, {"type", "u8"}}}}}})},
      {"images[0].extensions.WARDMIS_scene.width: expected a whole number from 1 to 65536, found 2147483648",
       image({{"bufferView", 0}, {"mimeType", "application/x-wardmis-pixels"}, {"extensions", {{"WARDMIS_scene", {{"width", 1u << 31}, {"height", 1u << 31}, {"channels", 4}, {"type", "f32"}}}}}})},
      {"raw pixels need the extension WARDMIS_scene", image({{"bufferView", 0}, {"mimeType", "application/x-wardmis-pixels"}})},
      // lights, camera, film
      {"lights[0].type: expected one of", light({{"type", "laser"}})},
      {"lights[0]: 'radiance' is missing", light({{"type", "area"}})},
      {"lights[0] 'L' .radius: expected a number >= 0, found -1", light({{"name", "L"}, {"type", "point"}, {"intensity", 1}, {"radius", -1}})},
      {"lights[0].maxBounces: expected a whole number >= 0", light({{"type", "point"}, {"intensity", 1}, {"maxBounces", -1}})},
      {"lights[0]: its area is not positive", light({{"type", "area"}, {"radiance", 1}, {"size", {0, 1}}})},
      {"lights[0]: its area is beyond", light({{"type", "area"}, {"radiance", 1}, {"size", {1e30, 1e30}}})},
      {"lights[0]: its power is not a number", light({{"type", "sun"}, {"irradiance", 1e38}, {"color", {1e38, 1, 1}}})},
      {"light: refers to lights[4]", [](GlbBuilder& b) { b.root["nodes"][0]["extensions"]["WARDMIS_scene"]["light"] = 4; }},
      {"camera: nodes[0] has no camera", extension({{"camera", 0}})},
      {"cameras[0].extensions.WARDMIS_scene.viewPlane: expected [left", camera({{"viewPlane", {1, -1, -1, 1}}})},
      {"viewPlane: expected [left", camera({{"projection", "equirectangular"}, {"viewPlane", {1, 1, -1, 1}}})},
      {"projection: expected", camera({{"projection", "pinhole"}, {"viewPlane", {-1, 1, -1, 1}}})},
      {"polynomial", camera({{"projection", "fisheye-polynomial"}, {"viewPlane", {-1, 1, -1, 1}}})},
      {"polynomial: expected",
       camera({{"projection", "fisheye-polynomial"}, {"viewPlane", {-1, 1, -1, 1}}, {"polynomial", {0, 1}}})},
      {"fov: expected",
       camera({{"projection", "fisheye-equidistant"}, {"viewPlane", {-1, 1, -1, 1}}, {"fov", -1}})},
      {"clip: expected the near clip distance below", camera({{"viewPlane", {-1, 1, -1, 1}}, {"clip", {5, 1}}})},
      {"'Square': carries a camera, but its scale is 0",
       [camera](GlbBuilder& b) {
         camera({{"viewPlane", {-1, 1, -1, 1}}})(b);
         b.root["nodes"][0]["scale"] = {1, 1, 0};
       }},
      {"film.resolution[0]: expected a whole number from 1 to 65536, found 0", extension({{"film", {{"resolution", {0, 1}}}}})},
      {"film.resolution: expected at most 2^28 pixels", extension({{"film", {{"resolution", {65536, 65536}}}}})},
      {"film.border: expected [x0, y0, x1, y1] within 4 x 4", extension({{"film", {{"resolution", {4, 4}}, {"border", {0, 0, 5, 4}}}}})},
      {"film.filter.type: expected one of", extension({{"film", {{"resolution", {4, 4}}, {"filter", {{"type", "sinc"}}}}}})},
      {"world.texture.index: refers to textures[0]", extension({{"world", {{"texture", {{"index", 0}}}}}})},
      {"world[1].visibility[0]: expected one of \"camera\"", extension({{"world", {json::object(), {{"visibility", {"all"}}}}}})},
      {"world.maxBounces: expected a whole number >= 0", extension({{"world", {{"radiance", {1, 1, 1}}, {"maxBounces", -1}}}})},
      {"world: expected at most 16 worlds", extension({{"world", json(17, json::object())}})},
      {"world.texture.projection: expected one of \"equirectangular\", \"mirror-ball\"",
       [extension](GlbBuilder& b) {
         const int texture = rawTexture<float>(b, 1, 1, 1, {1});
         extension({{"world", {{"texture", {{"index", texture}, {"projection", "cube"}}}}}})(b);
       }},
      {"world.texture.matrix: it has no inverse",
       [extension](GlbBuilder& b) {
         const int texture = rawTexture<float>(b, 1, 1, 1, {1});
         extension({{"world", {{"texture", {{"index", texture}, {"matrix", {1, 0, 0, 0, 1, 0, 1, 1, 0}}}}}}})(b);
       }},
      // instancing
      {"attributes: expected TRANSLATION, ROTATION or SCALE", instancing(json::object())},
      {"attributes.TRANSLATION: refers to accessors[9]", instancing({{"TRANSLATION", 9}})},
      {"attributes.SCALE: expected elements of type VEC3", instancing({{"SCALE", 1}})},
      {"attributes.TRANSLATION: has 1 elements, but the other attributes have 4",
       [instancing](GlbBuilder& b) { instancing({{"SCALE", 0}, {"TRANSLATION", b.accessor<float>({0, 0, 0}, 3)}})(b); }},
  };
  const TemporaryFolder folder;
  for (const Hostile& h : kTable) {
    GlbBuilder b = square();
    h.change(b);
    const std::string message = errorOf([&] { read(b.bytes(), folder.path); });
    EXPECT_TRUE(message.starts_with("scene.glb: ")) << message;
    expectHas(message, h.expected);
  }
}

TEST(Glb, DoesNotFollowLinksOutOfItsFolder) {
  const TemporaryFolder folder;
  folder.write("outside.bin", square().binary);
  fs::create_directories(folder.path / "scene");
  fs::create_symlink("../outside.bin", folder.path / "scene/link.bin");
  fs::create_directory_symlink("..", folder.path / "scene/up");
  for (const std::string uri : {"link.bin", "up/outside.bin"}) {
    GlbBuilder b = square();
    b.root["buffers"] = {{{"byteLength", b.binary.size()}, {"uri", uri}}};
    expectHas(errorOf([&] { read(b.bytes(), folder.path / "scene"); }), "is not a file in the scene's folder");
    b.root["buffers"][0]["uri"] = "scene/" + uri;  // the same link, from a folder that holds what it leads to
    EXPECT_EQ(read(b.bytes(), folder.path).meshes.size(), 1u);
  }
}

TEST(Glb, RefusesBombs) {
  // A small file whose 3000 accessors each make a million vertices out of the same bytes.
  GlbBuilder b;
  b.accessor<uint8_t>(std::vector<uint8_t>(3'000'000), 3);
  b.root["meshes"] = {{{"primitives", json::array()}}};
  for (int i = 0; i < 3000; i++) {
    b.add("accessors", b.root["accessors"][0]);
    b.root["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", i}}}, {"mode", 5}});
  }
  b.add("nodes", {{"mesh", 0}});
  expectHas(errorOf(b), "asks for far more data than the file holds");

  // Ten thousand nodes with a hundred thousand instances each.
  b = square();
  const int translation = b.accessor<float>(std::vector<float>(300'000), 3);
  b.root["nodes"] = json::array();
  for (int i = 0; i < 10'000; i++)
    b.add("nodes", {{"mesh", 0},
                    {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", translation}}}}}}}});
  expectHas(errorOf(b), "asks for far more data than the file holds");
}

TEST(Glb, NamesFilesThatCannotBeOpened) {
  const TemporaryFolder folder;
  expectHas(errorOf([&] { readGlb(folder.path / "none.glb"); }, ExitCode::kFile),
            "none.glb: cannot be opened: No such file");
  expectHas(errorOf([&] { readGlb(folder.path); }, ExitCode::kFile), "it is not a regular file");
  expectHas(errorOf([&] { readGlb(folder.write("empty.glb", {})); }), "empty.glb: is empty");
}

// The fuzzer's seeds (tests/native/gltf/fuzz_glb.cpp says how they are made) are read without harm.
TEST(Glb, ReadsTheCorpus) {
  const auto seed = [](const GlbBuilder& b) {
    GlbBuilder copy = b;
    if (!b.binary.empty()) copy.root["buffers"] = {{{"byteLength", b.binary.size()}}};
    const std::string text = copy.text() + '\0';
    Bytes out = test::bytesOf(text.data(), text.size());
    out.insert(out.end(), b.binary.begin(), b.binary.end());
    return out;
  };
  if (const char* to = std::getenv("WARDMIS_WRITE_CORPUS")) {
    GlbBuilder sparse = square();
    const int where = sparse.view<uint8_t>({1}), what = sparse.view<float>({5, 0, 0});
    sparse.root["accessors"][0]["sparse"] = {{"count", 1},
                                             {"indices", {{"bufferView", where}, {"componentType", 5121}}},
                                             {"values", {{"bufferView", what}}}};
    GlbBuilder png = textured({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    png.add("images", {{"bufferView", png.view(png2x1({1, 2, 3, 4, 5, 6}))}});
    png.add("textures", {{"source", 0}});
    GlbBuilder foreign = textured(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 1}}}}},
         {"extensions", {{"KHR_materials_unlit", json::object()}, {"KHR_materials_transmission", json::object()}}}});
    foreign.add("images", {{"uri", "lost.png"}});
    foreign.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
    primitive(foreign)["attributes"]["TEXCOORD_1"] = primitive(foreign)["attributes"]["TEXCOORD_0"];
    primitive(foreign)["attributes"]["COLOR_0"] = foreign.accessor<float>(std::vector<float>(12, 1), 3);
    foreign.root["nodes"][0]["children"] = {1};
    foreign.add("nodes", {{"mesh", 0}});
    foreign.root["scenes"] = {{{"nodes", {1}}}};
    const std::pair<const char*, GlbBuilder> seeds[] = {{"square", square()},
                                                        {"everything", everything()},
                                                        {"sparse", sparse},
                                                        {"png", png},
                                                        {"foreign", foreign},
                                                        {"program", withEveryOperation()},
                                                        {"worlds", withSeveralWorlds()},
                                                        {"strands", withStrands()}};
    for (const auto& [name, b] : seeds) {
      const Bytes bytes = seed(b);
      std::ofstream(fs::path(to) / name, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
  }
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(WARDMIS_TEST_DATA) / "native/gltf/corpus")) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    const size_t end = std::min(bytes.find('\0'), bytes.size());
    const std::string binary = end < bytes.size() ? bytes.substr(end + 1) : "";
    try {
      read(GlbBuilder::glb(bytes.substr(0, end), test::bytesOf(binary.data(), binary.size())));
    } catch (const Error& e) {
      EXPECT_EQ(e.code, ExitCode::kScene) << entry.path() << e.what();
    }
    files++;
  }
  EXPECT_GE(files, 8);
}

}  // namespace
}  // namespace wardmis
