// SPDX-License-Identifier: GPL-3.0-or-later
// `materials`, `textures` and `images`: only what is used is read, and images are decoded last, all at once.
#pragma once

#include <map>
#include <unordered_map>
#include <utility>

#include "gltf/file.h"
#include "gltf/left_out.h"
#include "gltf/program.h"
#include "image/decode.h"
#include "scene/scene.h"

namespace wardmis {

class Materials {
 public:
  Materials(const Json& root, Buffers& buffers, LeftOut& leftOut);

  // The index in Scene::materials of a primitive's material, read when it is first used.
  int use(const Json& primitive);
  // Which TEXCOORD_n the material needs, for textures or as the direction of its anisotropy; -1: none.
  int uvSet(int material) const;
  std::string described(int material) const;  // for messages
  const Program* program(int material) const { return read_.materials[material].program.get(); }
  // A world's texture; finish() makes of it the index in Scene::textures.
  int worldTexture(const Json& index);
  // The program of the world or of a light, if it has one, and which of its values, a vector, is its `result`. `user`:
  // for messages. finish() is to be told of it by the scene.
  std::shared_ptr<const Program> program(const Json& owner, const std::string& user, int& result);

  // Decodes the images and moves everything into the scene.
  void finish(Scene& scene);

 private:
  // A core material whose inputs need their textures combined texel by texel.
  struct Bake {
    Json json;
    int material;  // in read_
    Rgb base;
    float metallic, roughness;
    TextureUse baseTexture, roughnessTexture;
  };
  struct PendingImage {
    Json json;  // of the image, or of a texture that has none
    Encoding encoding;
    std::string neededBy;
    std::string missing = {};  // why there is nothing to decode
  };

  Material ward(const Json& extension);
  Material core(const Json& json);
  void readColor(const Json& extension, std::string_view key, ColorInput& out, bool light = false);
  Closure closure(const Json& json);
  void readDirection(const Json& json, const char* key, int& result);
  void readScalar(const Json& extension, std::string_view key, ScalarInput& out);
  void readAlpha(const Json& extension, std::string_view key, ScalarInput& out);
  // Whether the input is a value of the program.
  bool readResult(const Json& input, ValueKind kind, int& result);
  TextureUse wardTexture(const Json& json, bool isColor);
  std::optional<TextureUse> coreTexture(const Json& parent, std::string_view key, bool isColor);
  int texture(const Json& index, bool isColor);
  int image(size_t image, bool isColor);
  std::optional<size_t> source(const Json& texture);
  Bytes fetch(PendingImage& pending);
  static DecodedImage decode(const PendingImage& pending, const Bytes& bytes, ImageBudget& budget);
  void bake(const Bake& bake, ImageBudget& budget);
  int addImage(Image image, const Texture& like);
  void mendLight(std::vector<World>& worlds, const std::vector<DecodedImage>& decoded, std::vector<std::string>& notes);

  JsonArray materials_, textures_, samplers_, images_;
  Buffers& buffers_;
  LeftOut& leftOut_;
  std::string user_;                      // whose textures are being read, for messages
  int set_ = -1;                          // the TEXCOORD_n of the first of them
  std::optional<ProgramReader> program_;  // of the material that is being read

  Scene read_;               // materials as read, with textures that finish() may combine or drop
  std::vector<int> uvSets_;  // of read_.materials: that of the textures, -1 without any
  std::unordered_map<size_t, int> materialOf_;
  int defaultMaterial_ = -1;
  std::map<std::pair<size_t, bool>, int> textureOf_;  // by index in the file, and whether it is a colour
  std::map<std::pair<size_t, Encoding>, int> imageOf_;
  std::vector<PendingImage> pending_;  // of read_.images
  std::vector<Bake> bakes_;
};

}  // namespace wardmis
