// SPDX-License-Identifier: GPL-3.0-or-later
// Compressed meshes and images, of files that the tests compress themselves; each where its library is installed.
#if WITH_DRACO
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#endif
#if WITH_MESHOPT
#include <meshoptimizer.h>
#endif
#if WITH_WEBP
#include <webp/encode.h>
#endif

#include "glb_support.h"

namespace wardmis {
namespace {

using namespace test;

// Whatever a byte of it is changed to, the scene is read or refused.
[[maybe_unused]] void survives(const GlbBuilder& b, size_t from, size_t size) {
  for (size_t i = from; i < from + size; ++i)
    for (const int change : {0x01, 0x80, 0xFF}) {
      GlbBuilder copy = b;
      copy.binary[i] ^= static_cast<std::byte>(change);
      try {
        read(copy);
      } catch (const Error& e) {
        ASSERT_EQ(e.code, ExitCode::kScene) << e.what();
      }
    }
}

#if WITH_DRACO
// Two triangles with normals and texture coordinates as Draco packs them.
std::vector<char> dracoSquare() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const int faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
  for (int f = 0; f < 2; ++f) {
    const auto* c = faces[f];
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), corners[c[0]], corners[c[1]], corners[c[2]]);
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(f), corners[c[0]], corners[c[1]], corners[c[2]]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 14);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.data() + buffer.size()};
}

TEST(Codecs, ReadsDraco) {
  GlbBuilder b;
  rawTexture<uint8_t>(b, 1, 1, 3, {1, 2, 3});
  const std::vector<char> packed = dracoSquare();
  const int view = b.view(packed);
  const size_t from = b.binary.size() - packed.size();
  b.add("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorTexture", {{"index", 0}}}}}});
  b.add("accessors", {{"count", 4}, {"type", "VEC3"}, {"componentType", 5126}});
  b.add("accessors", {{"count", 6}, {"type", "SCALAR"}, {"componentType", 5125}});
  b.add("accessors", {{"count", 4}, {"type", "VEC2"}, {"componentType", 5126}});
  b.add("meshes", {{"name", "Quad"},
                   {"primitives",
                    {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 2}}},
                      {"indices", 1},
                      {"material", 0},
                      {"extensions",
                       {{"KHR_draco_mesh_compression",
                         {{"bufferView", view}, {"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}}}}}}}}});
  b.add("nodes", {{"mesh", 0}});
  b.root["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const Scene s = read(b);
  const MeshPart& part = s.meshes.at(0).parts.at(0);
  ASSERT_EQ(part.positions.size(), 4u);
  ASSERT_EQ(part.primitives[0].indices.size(), 6u);
  float area = 0;
  for (size_t t = 0; t < 2; ++t) {
    const auto corner = [&](size_t k) { return part.positions[part.primitives[0].indices[3 * t + k]]; };
    area += 0.5f * cross(corner(1) - corner(0), corner(2) - corner(0)).z;
  }
  EXPECT_NEAR(area, 1, 1e-3);  // all of the square, facing as before
  ASSERT_EQ(part.uvs.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(part.uvs[i].x, part.positions[i].x, 1e-2);
    EXPECT_NEAR(part.uvs[i].y, 1 - part.positions[i].y, 1e-2);
  }
  survives(b, from, packed.size());
  b.root["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 7;
  expectHas(errorOf(b), "what Draco has compressed is damaged: has no attribute 7");
}
#endif

#if WITH_MESHOPT
TEST(Codecs, ReadsMeshopt) {
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3};
  std::vector<uint8_t> vertices(meshopt_encodeVertexBufferBound(4, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 4, 12));
  std::vector<uint8_t> triangles(meshopt_encodeIndexBufferBound(6, 4));
  triangles.resize(meshopt_encodeIndexBuffer(triangles.data(), triangles.size(), indices.data(), 6));
  // normals as directions in an octahedron of bytes, four a vertex
  const float up[16] = {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::vector<int8_t> octahedral(16);
  meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, up);
  std::vector<uint8_t> normals(meshopt_encodeVertexBufferBound(4, 4));
  normals.resize(meshopt_encodeVertexBuffer(normals.data(), normals.size(), octahedral.data(), 4, 4));

  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    GlbBuilder b;
    const auto packed = [&](const std::vector<uint8_t>& data, size_t count, size_t stride, json more) {
      const int raw = b.view(data);
      json extension = b.root["bufferViews"][raw];
      extension.update({{"count", count}, {"byteStride", stride}});
      extension.update(more);
      return b.add(
          "bufferViews",
          {{"buffer", 1}, {"byteLength", count * stride}, {"byteStride", stride}, {"extensions", {{name, extension}}}});
    };
    const int position = packed(vertices, 4, 12, {{"mode", "ATTRIBUTES"}});
    const int index = packed(triangles, 6, 4, {{"mode", "TRIANGLES"}});
    const int normal = packed(normals, 4, 4, {{"mode", "ATTRIBUTES"}, {"filter", "OCTAHEDRAL"}});
    b.root["bufferViews"][index].erase("byteStride");
    b.root["buffers"] = {{{"byteLength", b.binary.size()}},
                         {{"byteLength", 9999}, {"extensions", {{name, {{"fallback", true}}}}}}};
    b.add("accessors", {{"bufferView", position}, {"count", 4}, {"type", "VEC3"}, {"componentType", 5126}});
    b.add("accessors", {{"bufferView", index}, {"count", 6}, {"type", "SCALAR"}, {"componentType", 5125}});
    b.add("accessors",
          {{"bufferView", normal}, {"count", 4}, {"type", "VEC3"}, {"componentType", 5120}, {"normalized", true}});
    b.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 2}}}, {"indices", 1}}}}});
    b.add("nodes", {{"mesh", 0}});
    b.root["extensionsRequired"] = {name};
    const Scene s = read(b);
    const MeshPart& part = s.meshes.at(0).parts.at(0);
    for (size_t i = 0; i < 4; ++i) {
      expectNear(part.positions[i], {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]}, 0);
      expectNear(part.normals[i], {0, 0, 1}, 0.01f);
    }
    const auto span = part.primitives[0].indices.data;
    EXPECT_EQ(std::vector<uint32_t>(span.begin(), span.end()), indices);
    survives(b, 0, b.binary.size());
  }
}
#endif

#if WITH_WEBP
TEST(Codecs, ReadsWebp) {
  for (const int channels : {3, 4}) {
    const Texels<uint8_t> pixels =
        channels == 3 ? Texels<uint8_t>{1, 2, 3, 4, 5, 6} : Texels<uint8_t>{1, 2, 3, 255, 4, 5, 6, 128};
    uint8_t* file = nullptr;
    const size_t size = channels == 3 ? WebPEncodeLosslessRGB(pixels.data(), 1, 2, 3, &file)
                                      : WebPEncodeLosslessRGBA(pixels.data(), 1, 2, 4, &file);
    ASSERT_GT(size, 0u);
    GlbBuilder b = textured(ward({{"diffuse", {{"texture", {{"index", 0}}}}}}));
    b.add("images", {{"bufferView", b.view(std::vector<uint8_t>(file, file + size))}, {"mimeType", "image/webp"}});
    WebPFree(file);
    b.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 0}}}}}});
    b.root["extensionsRequired"] = {"EXT_texture_webp"};
    const Scene s = read(b);
    const Image& image = s.images.at(0);
    EXPECT_EQ(image.height, 2);
    EXPECT_EQ(image.channels, channels);
    EXPECT_TRUE(image.srgb);
    EXPECT_EQ(image.bytes.at(0), 4);  // rows from the bottom
    EXPECT_EQ(image.bytes.at(channels), 1);
    survives(b, b.binary.size() - size, size);
  }
}
#endif

}  // namespace
}  // namespace wardmis
