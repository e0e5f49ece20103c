// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/material.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "scene/inputs.h"

namespace wardmis {
namespace {

constexpr const char* kExtension = "WARDMIS_scene";
constexpr int kMostHalvings = 20;        // an image is a single texel before
constexpr uint64_t kMostSets = 1 << 16;  // of texture coordinates

constexpr std::pair<std::string_view, WardVariant> kVariants[] = {
    {"ward", WardVariant::kWard}, {"ward-dur", WardVariant::kWardDur}, {"ward-gmd", WardVariant::kWardGmd}};
constexpr std::pair<std::string_view, ColorSpace> kColorSpaces[] = {{"sRGB", ColorSpace::kSrgb},
                                                                    {"linear", ColorSpace::kLinear}};
constexpr std::pair<std::string_view, Alpha> kAlphas[] = {
    {"kept", Alpha::kKept}, {"multiplies", Alpha::kMultiplies}, {"ignored", Alpha::kIgnored}};
constexpr std::pair<std::string_view, Filter> kFilters[] = {
    {"linear", Filter::kLinear}, {"nearest", Filter::kNearest}, {"cubic", Filter::kCubic}};
constexpr std::pair<std::string_view, Wrap> kExtensionWraps[] = {
    {"repeat", Wrap::kRepeat}, {"clamp", Wrap::kClamp}, {"mirror", Wrap::kMirror}, {"clip", Wrap::kClip}};

// What docs/scene-format.md makes of a base colour b and a metallic m.
struct CoreColors {
  Rgb diffuse, specular;
};
CoreColors coreColors(Rgb b, float m) {
  const Rgb diffuse = b * (1 - m), specular = Rgb{1, 1, 1} * (0.04f * (1 - m)) + b * m;
  const float scale = 1 / std::max(1.0f, maxComponent(diffuse + specular));
  return {diffuse * scale, specular * scale};
}

uint8_t srgbByte(float v) { return static_cast<uint8_t>(std::lround(255 * std::clamp(linearToSrgb(v), 0.0f, 1.0f))); }

}  // namespace

Materials::Materials(const Json& root, Buffers& buffers, LeftOut& leftOut)
    : materials_(root.array("materials")),
      textures_(root.array("textures")),
      samplers_(root.array("samplers")),
      images_(root.array("images")),
      buffers_(buffers),
      leftOut_(leftOut) {}

int Materials::use(const Json& primitive) {
  const auto add = [&](Material material) {
    uvSets_.push_back(set_);
    read_.materials.push_back(std::move(material));
    return static_cast<int>(read_.materials.size() - 1);
  };
  const auto index = primitive.find("material");
  set_ = -1;
  if (!index) {
    if (defaultMaterial_ < 0) {
      Material grey;
      grey.name = "(none)";
      grey.diffuse.value = {0.8f, 0.8f, 0.8f};
      defaultMaterial_ = add(grey);
    }
    return defaultMaterial_;
  }
  const size_t i = index->index(materials_.size(), "materials");
  const auto [entry, isNew] = materialOf_.try_emplace(i, -1);
  if (isNew) {
    const Json json = materials_[i];
    user_ = "material " + json.described();
    const auto extension = json.extension(kExtension);
    // core() may ask for a bake of the material that it is about to become.
    Material material = extension ? ward(*extension) : core(json);
    material.name = json.name();
    entry->second = add(std::move(material));
  }
  return entry->second;
}

int Materials::uvSet(int index) const {
  const Material& m = read_.materials[index];
  if (uvSets_[index] >= 0) return uvSets_[index];
  return m.alphaX.value != m.alphaY.value && maxComponent(m.specular.value) > 0 ? 0 : -1;
}

std::string Materials::described(int index) const {
  const std::string& name = read_.materials[index].name;
  return name.empty() ? "a material without a name" : "material '" + name + "'";
}

int Materials::worldTexture(const Json& index) {
  user_ = "the world";
  return texture(index, true);
}

std::shared_ptr<const Program> Materials::program(const Json& owner, const std::string& user, int& result) {
  const auto json = owner.find("program");
  if (!json) {
    if (const auto value = owner.find("result"))
      value->fail("refers to a value, but there is no program beside it", "export the scene again");
    return nullptr;
  }
  user_ = user;
  ProgramReader reader(*json, textures_.size());
  result = reader.use(owner.at("result"), ValueKind::kVector);
  return reader.finish([&](const Json& index) { return texture(index, true); });
}

Material Materials::ward(const Json& extension) {
  Material m;
  program_.reset();
  if (const auto program = extension.find("program")) program_.emplace(*program, textures_.size());
  const auto closures = extension.find("closures");
  for (const char* shortForm : {"variant", "diffuse", "specular", "alphaX", "alphaY", "rotation", "normal"})
    if (closures && extension.find(shortForm))
      closures->fail(fmt::format("stands beside '{}', in whose place it is", shortForm), "export the scene again");
  if (const auto variant = extension.find("variant")) m.variant = variant->choice(kVariants);
  readColor(extension, "diffuse", m.diffuse);
  readColor(extension, "specular", m.specular);
  readColor(extension, "emission", m.emission, true);
  readAlpha(extension, "alphaX", m.alphaX);
  readAlpha(extension, "alphaY", m.alphaY);
  m.rotation = extension.numberOr("rotation", 0);
  m.index = extension.numberOr("index", 0);
  readDirection(extension, "normal", m.normal);
  if (closures) {
    const JsonArray list = closures->array();
    for (size_t i = 0; i < list.size(); ++i) m.closures.push_back(closure(list[i]));
    m.transparent = std::any_of(m.closures.begin(), m.closures.end(), mayBeTransparent);
    m.constant = m.isConstant();
    m.opaqueShadow = !extension.booleanOr("transparentShadow", true);
  }
  if (program_) {
    std::shared_ptr<Program> program = program_->finish([&](const Json& index) { return texture(index, true); });
    if (!program->instructions.empty()) m.program = std::move(program);
  }
  return m;
}

void Materials::readDirection(const Json& json, const char* key, int& result) {
  if (const auto direction = json.find(key)) {
    direction->at("result");
    readResult(*direction, ValueKind::kVector, result);
  }
}

Closure Materials::closure(const Json& json) {
  constexpr std::pair<std::string_view, Glossy> kDistributions[] = {{"ggx", Glossy::kGgx},
                                                                    {"beckmann", Glossy::kBeckmann},
                                                                    {"multi-ggx", Glossy::kMultiGgx},
                                                                    {"ashikhmin-shirley", Glossy::kAshikhminShirley}};
  Closure c;
  const Json type = json.at("type");
  c.version = static_cast<uint8_t>(json.integerOr("version", 5, 3, 5));
  size_t k = 0;
  const auto is = [&](const ClosureInfo& i) {
    return i.name == type.string() && i.firstVersion <= c.version && c.version <= i.lastVersion;
  };
  while (k < kClosureTypes && !is(info(static_cast<ClosureType>(k)))) ++k;
  if (k == kClosureTypes)
    type.fail(fmt::format("there is no closure '{}' of version {}", cleaned(type.string().substr(0, 40)), c.version),
              "export the scene again");
  c.type = static_cast<ClosureType>(k);
  const ClosureInfo& i = info(c.type);
  readColor(json, "weight", c.weight, true);
  readScalar(json, "rotation", c.rotation);
  for (const ClosureInput& input : i.colors) {
    c.colors.push_back({{input.value, input.value, input.value}, {}});
    readColor(json, input.name, c.colors.back(), true);  // below 0, too, as programs may make them
  }
  for (const ClosureInput& input : i.scalars) {
    c.scalars.push_back({input.value, {}});
    readScalar(json, input.name, c.scalars.back());
  }
  if (const auto variant = json.find("variant")) c.variant = variant->choice(kVariants);
  if (const auto distribution = json.find("distribution"); distribution && i.distribution)
    c.distribution = distribution->choice(kDistributions);
  if (const auto thin = json.find("thinWall")) c.thinWall = thin->boolean();
  readDirection(json, "normal", c.normal);
  readDirection(json, "coatNormal", c.coatNormal);
  readDirection(json, "tangent", c.tangent);
  return c;
}

bool Materials::readResult(const Json& input, ValueKind kind, int& result) {
  const auto json = input.find("result");
  if (!json) return false;
  if (!program_) json->fail("refers to a value, but the material has no program", "export the scene again");
  if (input.find("texture")) input.fail("has both a result and a texture", "export the scene again");
  result = program_->use(*json, kind);
  return true;
}

void Materials::readColor(const Json& extension, std::string_view key, ColorInput& out, bool light) {
  const auto json = extension.find(key);
  if (!json) return;
  out.value = light ? json->lightOr("value", {1, 1, 1}) : json->colorOr("value", {1, 1, 1});
  const bool computed = readResult(*json, ValueKind::kVector, out.result);
  if (isBlack(out.value)) out.result = -1;  // nothing to multiply
  if (isBlack(out.value) || computed) return;
  if (const auto texture = json->find("texture")) out.texture = wardTexture(*texture, true);
}

void Materials::readScalar(const Json& extension, std::string_view key, ScalarInput& out) {
  const auto json = extension.find(key);
  if (!json) return;
  out.value = json->numberOr("value", 1);
  if (readResult(*json, ValueKind::kNumber, out.result)) return;
  if (const auto texture = json->find("texture")) out.texture = wardTexture(*texture, false);
}

void Materials::readAlpha(const Json& extension, std::string_view key, ScalarInput& out) {
  const auto json = extension.find(key);
  if (!json) return;
  out.value = json->numberOr("value", 1, 0);
  if (readResult(*json, ValueKind::kNumber, out.result)) return;
  if (const auto texture = json->find("texture"))
    out.texture = wardTexture(*texture, false);
  else
    out.value = clampedAlpha(out.value);
}

TextureUse Materials::wardTexture(const Json& json, bool isColor) {
  TextureUse use;
  set_ = 0;
  use.texture = texture(json.at("index"), isColor);
  use.channel = static_cast<int>(json.integerOr("channel", 0, 0, 3));
  if (const auto transform = json.find("transform")) transform->numbers(use.transform);
  return use;
}

Material Materials::core(const Json& json) {
  constexpr std::string_view kKnown[] = {"KHR_materials_emissive_strength", "KHR_materials_unlit"};
  if (const auto extensions = json.find("extensions"))
    extensions->forEachMember([&](std::string_view name, const Json&) {
      if (std::ranges::find(kKnown, name) == std::end(kKnown))
        leftOut_.add(cleaned(name) + " of " + user_, name == "KHR_materials_transmission"
                                                         ? "nothing is transparent: it is rendered opaque"
                                                         : "it is rendered without");
    });
  const bool unlit = json.extension("KHR_materials_unlit").has_value();
  Material m;
  Rgb base{1, 1, 1};
  float metallic = 1, roughness = 1;
  std::optional<TextureUse> baseTexture, roughnessTexture;
  if (const auto pbr = json.find("pbrMetallicRoughness")) {
    if (const auto factor = pbr->find("baseColorFactor")) {
      const auto rgba = factor->numbers<4>();
      base = {rgba[0], rgba[1], rgba[2]};
      if (std::min({base.x, base.y, base.z}) < 0) factor->failExpected("four numbers >= 0");
    }
    metallic = pbr->numberOr("metallicFactor", 1, 0, 1);
    roughness = pbr->numberOr("roughnessFactor", 1, 0, 1);
    if (maxComponent(base) > 0) baseTexture = coreTexture(*pbr, "baseColorTexture", true);
    if (!unlit && (metallic > 0 || roughness > 0))
      roughnessTexture = coreTexture(*pbr, "metallicRoughnessTexture", false);
  }
  if (json.stringOr("alphaMode", "OPAQUE") != "OPAQUE") leftOut_.add("transparency of " + user_, "surfaces are opaque");
  if (unlit) {  // seen as it is: what shines so, and reflects nothing
    m.unlit = true;
    m.emission.value = base;
    if (baseTexture) m.emission.texture = *baseTexture;
    leftOut_.add("KHR_materials_unlit of " + user_,
                 "it is rendered as light of that colour, which falls on the rest too");
    return m;
  }
  const CoreColors colors = coreColors(base, metallic);
  m.diffuse.value = colors.diffuse;
  m.specular.value = colors.specular;
  m.alphaX.value = m.alphaY.value = clampedAlpha(roughness * roughness);

  if (baseTexture && roughnessTexture) {
    const Texture &a = read_.textures[baseTexture->texture], &b = read_.textures[roughnessTexture->texture];
    if (!std::equal(baseTexture->transform, baseTexture->transform + 6, roughnessTexture->transform) ||
        a.wrapU != b.wrapU || a.wrapV != b.wrapV || a.filter != b.filter) {
      leftOut_.add("metallicRoughnessTexture of " + user_, "it is laid out otherwise than baseColorTexture");
      roughnessTexture.reset();
    }
  }
  if (roughnessTexture || (baseTexture && metallic > 0 && metallic < 1))
    bakes_.push_back({json, static_cast<int>(read_.materials.size()), base, metallic, roughness,
                      baseTexture.value_or(TextureUse{}), roughnessTexture.value_or(TextureUse{})});
  else if (baseTexture)
    (metallic == 0 ? m.diffuse : m.specular).texture = *baseTexture;  // the other one does not depend on the base

  float strength = 1;
  if (const auto extension = json.extension("KHR_materials_emissive_strength"))
    strength = extension->numberOr("emissiveStrength", 1, 0);
  m.emission.value = json.colorOr("emissiveFactor", {0, 0, 0}) * strength;
  if (!isFinite(m.emission.value)) json.fail("its emission is not a number of single precision");
  if (maxComponent(m.emission.value) > 0)
    if (const auto texture = coreTexture(json, "emissiveTexture", true)) m.emission.texture = *texture;

  for (const char* key : {"normalTexture", "occlusionTexture"})
    if (json.find(key)) leftOut_.add(key + (" of " + user_), "not part of the renderer's materials");
  return m;
}

std::optional<TextureUse> Materials::coreTexture(const Json& parent, std::string_view key, bool isColor) {
  const auto json = parent.find(key);
  if (!json) return std::nullopt;
  const auto extension = json->extension("KHR_texture_transform");
  uint64_t set = json->integerOr("texCoord", 0, 0, kMostSets);
  if (extension) set = extension->integerOr("texCoord", set, 0, kMostSets);
  if (set_ < 0) set_ = static_cast<int>(set);
  if (set != static_cast<uint64_t>(set_)) {
    leftOut_.add(
        fmt::format("{} of {}", key, user_),
        fmt::format("it needs TEXCOORD_{}, the material's other textures TEXCOORD_{}: one of them is read", set, set_));
    return std::nullopt;
  }
  TextureUse use;
  use.texture = texture(json->at("index"), isColor);
  if (extension) {
    const auto pair = [&](std::string_view name, Vec2f fallback) {
      const auto value = extension->find(name);
      if (!value) return fallback;
      const auto v = value->numbers<2>();
      return Vec2f{v[0], v[1]};
    };
    const Vec2f offset = pair("offset", {0, 0}), scale = pair("scale", {1, 1});
    const float angle = extension->numberOr("rotation", 0), c = std::cos(angle), s = std::sin(angle);
    // With v down, as in the file: u' = c sx u + s sy v + ox, v' = -s sx u + c sy v + oy (the extension's prose and its
    // example; the matrix printed there turns the other way). Here v is up: v -> 1 - v on both sides.
    const float m[6] = {c * scale.x, -s * scale.y, s * scale.y + offset.x,  //
                        s * scale.x, c * scale.y,  1 - c * scale.y - offset.y};
    std::copy(m, m + 6, use.transform);
  }
  return use;
}

int Materials::texture(const Json& index, bool isColor) {
  const size_t i = index.index(textures_.size(), "textures");
  const auto [entry, isNew] = textureOf_.try_emplace({i, isColor}, -1);
  if (!isNew) return entry->second;

  constexpr std::pair<int, Wrap> kWraps[] = {{10497, Wrap::kRepeat}, {33071, Wrap::kClamp}, {33648, Wrap::kMirror}};
  const Json json = textures_[i];
  Texture texture;
  if (const auto samplerIndex = json.find("sampler")) {
    const Json sampler = samplers_[samplerIndex->index(samplers_.size(), "samplers")];
    const auto wrap = [&](std::string_view key) {
      const uint64_t value = sampler.integerOr(key, 10497, 0, UINT32_MAX);
      for (const auto& [code, meaning] : kWraps)
        if (value == uint64_t(code)) return meaning;
      sampler.at(key).failExpected("10497, 33071 or 33648");
    };
    texture.wrapU = wrap("wrapS");
    texture.wrapV = wrap("wrapT");
    if (sampler.integerOr("magFilter", 9729, 0, UINT32_MAX) == 9728) texture.filter = Filter::kNearest;
  }
  if (const auto extension = json.extension(kExtension)) {
    if (const auto filter = extension->find("filter")) texture.filter = filter->choice(kFilters);
    if (const auto wrap = extension->find("wrap")) texture.wrapU = texture.wrapV = wrap->choice(kExtensionWraps);
  }
  if (const auto found = source(json)) {
    texture.image = image(*found, isColor);
  } else {
    texture.image = static_cast<int>(pending_.size());
    pending_.push_back({json, Encoding{}, user_, "has no image"});
  }
  read_.textures.push_back(texture);
  return entry->second = static_cast<int>(read_.textures.size() - 1);
}

// The image of a texture: core glTF's, which every reader knows, else that of an extension.
std::optional<size_t> Materials::source(const Json& texture) {
  std::optional<Json> found = texture.find("source");
  if (const auto extension = texture.extension("EXT_texture_webp"); extension && !found)
    found = extension->find("source");
  if (const auto extensions = texture.find("extensions"))
    extensions->forEachMember([&](std::string_view, const Json& extension) {
      if (!found && extension.isObject()) found = extension.find("source");
    });
  return found ? std::optional(found->index(images_.size(), "images")) : std::nullopt;
}

int Materials::image(size_t i, bool isColor) {
  const Json json = images_[i];
  Encoding encoding{isColor ? ColorSpace::kAuto : ColorSpace::kLinear};
  if (const auto extension = json.extension(kExtension)) {
    if (const auto given = extension->find("colorSpace")) encoding.space = given->choice(kColorSpaces);
    encoding.filterEncoded = extension->booleanOr("filterEncoded", false);
    if (const auto given = extension->find("alpha")) encoding.alpha = given->choice(kAlphas);
    encoding.halvings = static_cast<int>(extension->integerOr("halvings", 0, 0, kMostHalvings));
    encoding.limit = static_cast<int>(extension->integerOr("limit", 0, 0, kLargestImageSide));
  }
  const auto [entry, isNew] = imageOf_.try_emplace({i, encoding}, static_cast<int>(pending_.size()));
  if (isNew) pending_.push_back({json, encoding, user_});
  return entry->second;
}

// What cannot be had is no reason not to render the rest.
Bytes Materials::fetch(PendingImage& pending) {
  if (!pending.missing.empty()) return {};
  const auto uri = pending.json.find("uri"), view = pending.json.find("bufferView");
  try {
    if (bool(uri) != bool(view)) return uri ? buffers_.uri(*uri) : buffers_.view(*view);
    pending.missing = "has neither uri nor bufferView, or both";
  } catch (const Error& e) {
    pending.missing = "is not there: " + std::string(e.what());
  }
  return {};
}

DecodedImage Materials::decode(const PendingImage& pending, const Bytes& bytes, ImageBudget& budget) {
  const Json& json = pending.json;
  if (!pending.missing.empty()) return lostImage(pending.missing);
  try {
    if (json.stringOr("mimeType", "") != "application/x-wardmis-pixels")
      return decodeImage(bytes.data, pending.encoding, budget);
    const auto raw = json.extension(kExtension);
    if (!raw) json.fail("raw pixels need the extension WARDMIS_scene with their size");
    constexpr std::pair<std::string_view, bool> kTypes[] = {{"u8", false}, {"f32", true}};
    const auto number = [&](const char* key, int most) { return static_cast<int>(raw->at(key).integer(1, most)); };
    const RawLayout layout{number("width", kLargestImageSide), number("height", kLargestImageSide),
                           number("channels", 4), raw->at("type").choice(kTypes)};
    return rawImage(bytes.data, layout, pending.encoding, budget);
  } catch (const UnreadableImage& e) {
    json.fail(fmt::format("{} (needed by {})", e.what(), pending.neededBy), "export the scene again");
  }
}

// Evaluates a core material at every texel.
void Materials::bake(const Bake& bake, ImageBudget& budget) {
  const bool hasBase = bake.baseTexture.texture >= 0;
  const TextureUse& layout = hasBase ? bake.baseTexture : bake.roughnessTexture;
  const Texture like = read_.textures[layout.texture];
  int width = 0, height = 0;
  for (const TextureUse& use : {bake.baseTexture, bake.roughnessTexture})
    if (use.texture >= 0) {
      const Image& image = read_.images[read_.textures[use.texture].image];
      width = std::max(width, image.width);
      height = std::max(height, image.height);
    }
  const auto texelsOf = [](TextureUse use) {  // in the texture's own coordinates
    constexpr float kIdentity[6] = {1, 0, 0, 0, 1, 0};
    std::copy(kIdentity, kIdentity + 6, use.transform);
    return use;
  };
  const TextureUse baseUse = texelsOf(bake.baseTexture);
  TextureUse roughnessUse = texelsOf(bake.roughnessTexture);

  const size_t texels = size_t(width) * height;
  if (!budget.take(10 * texels))
    bake.json.fail("its textures are too large to be combined",
                   "give baseColorTexture and metallicRoughnessTexture one size");
  Image diffuse{"", width, height, 3, true, Texels<uint8_t>(3 * texels), {}};
  Image specular = diffuse;
  Image alpha{"", width, height, 1, false, {}, Texels<float>(texels)};
  tbb::parallel_for(0, height, [&](int y) {
    for (int x = 0; x < width; x++) {
      const Vec2f uv{(static_cast<float>(x) + 0.5f) / static_cast<float>(width),
                     (static_cast<float>(y) + 0.5f) / static_cast<float>(height)};
      const Rgb gb = notNegative(sampleRgb(read_, roughnessUse, uv));  // glTF: green is roughness, blue is metallic
      const CoreColors colors =
          coreColors(bake.base * notNegative(sampleRgb(read_, baseUse, uv)), bake.metallic * gb.z);
      const size_t i = size_t(y) * width + x;
      const auto store = [&](Image& image, Rgb c) {
        image.bytes[3 * i] = srgbByte(c.x), image.bytes[3 * i + 1] = srgbByte(c.y),
                        image.bytes[3 * i + 2] = srgbByte(c.z);
      };
      store(diffuse, colors.diffuse);
      store(specular, colors.specular);
      alpha.floats[i] = clampedAlpha(bake.roughness * gb.y * bake.roughness * gb.y);
    }
  });
  Material& m = read_.materials[bake.material];
  const auto put = [&](Image image, const char* what, TextureUse& use) {
    image.name = fmt::format("{} of '{}'", what, m.name);
    use = layout;
    use.channel = 0;
    use.texture = addImage(std::move(image), like);
  };
  m.diffuse.value = m.specular.value = {1, 1, 1};
  put(std::move(diffuse), "diffuse", m.diffuse.texture);
  put(std::move(specular), "specular", m.specular.texture);
  if (bake.roughnessTexture.texture < 0) return;
  m.alphaX.value = m.alphaY.value = 1;
  put(std::move(alpha), "alpha", m.alphaX.texture);
  m.alphaY.texture = m.alphaX.texture;
}

int Materials::addImage(Image image, const Texture& like) {
  read_.images.push_back(std::move(image));
  read_.textures.push_back(like);
  read_.textures.back().image = static_cast<int>(read_.images.size() - 1);
  return static_cast<int>(read_.textures.size() - 1);
}

// Light is never magenta: where an image is lost it is grey. Names what is lost.
void Materials::mendLight(std::vector<World>& worlds, const std::vector<DecodedImage>& decoded,
                          std::vector<std::string>& notes) {
  int grey = -1;
  std::vector<bool> shines(decoded.size()), shows(decoded.size());
  const auto isLost = [&](int texture) {
    if (texture < 0) return false;
    const auto image = static_cast<size_t>(read_.textures[texture].image);
    return image < decoded.size() && !decoded[image].damage.empty();
  };
  const auto mend = [&](int& texture) {
    if (!isLost(texture)) return;
    shines[read_.textures[texture].image] = true;
    if (grey < 0) {
      Image half{"", 1, 1, 3, false, {}, {0.5f, 0.5f, 0.5f}};
      grey = addImage(std::move(half), read_.textures[texture]);
    }
    texture = grey;
  };
  const auto show = [&](int texture) {
    if (isLost(texture)) shows[read_.textures[texture].image] = true;
  };
  for (World& w : worlds) mend(w.texture);
  for (Material& m : read_.materials) {
    mend(m.emission.texture.texture);
    Material::forEachInput(m, [&](auto& input) { show(input.texture.texture); });
    if (m.program)
      for (const uint32_t t : m.program->textures) show(static_cast<int>(t));
  }
  for (const Bake& b : bakes_)
    for (const TextureUse& use : {b.baseTexture, b.roughnessTexture}) show(use.texture);
  for (size_t i = 0; i < decoded.size(); i++) {
    if (decoded[i].damage.empty()) continue;
    const auto uri = pending_[i].json.find("uri");
    notes.push_back(fmt::format("image {}{} {} (needed by {}); {} is shown instead", pending_[i].json.described(),
                                uri ? " '" + cleaned(uri->string().substr(0, 80)) + "'" : std::string(),
                                cleaned(decoded[i].damage), pending_[i].neededBy,
                                !shines[i]  ? "magenta"
                                : !shows[i] ? "grey light"
                                            : "magenta, and grey where it gives light,"));
  }
}

void Materials::finish(Scene& scene) {
  std::vector<Bytes> bytes;
  for (PendingImage& p : pending_) bytes.push_back(fetch(p));
  ImageBudget budget(buffers_.fileBytes());
  std::vector<DecodedImage> decoded(pending_.size());
  tbb::parallel_for(size_t(0), decoded.size(), [&](size_t i) {
    decoded[i] = decode(pending_[i], bytes[i], budget);
    bytes[i].drop();
  });
  for (size_t i = 0; i < pending_.size(); i++) {
    Image image = std::move(decoded[i].image);
    image.name = pending_[i].json.name();
    if (decoded[i].mended > 0)
      leftOut_.add(fmt::format("{} values of image {}", decoded[i].mended, pending_[i].json.described()),
                   "not finite; 0 is used");
    read_.images.push_back(std::move(image));
  }
  mendLight(scene.worlds, decoded, scene.notes);
  for (const Bake& b : bakes_) bake(b, budget);

  // Keep what the materials and the world refer to now.
  std::map<int, int> newTexture, newImage;
  const auto keep = [&](int& texture) {
    if (texture < 0) return;
    const auto [t, isNewTexture] = newTexture.try_emplace(texture, static_cast<int>(scene.textures.size()));
    if (isNewTexture) {
      Texture copy = read_.textures[texture];
      const auto [im, isNewImage] = newImage.try_emplace(copy.image, static_cast<int>(scene.images.size()));
      if (isNewImage) scene.images.push_back(std::move(read_.images[copy.image]));
      copy.image = im->second;
      scene.textures.push_back(copy);
    }
    texture = t->second;
  };
  const auto keepOfProgram = [&](std::shared_ptr<const Program>& use) {
    if (!use || use->textures.empty()) return;
    auto program = std::make_shared<Program>(*use);
    for (uint32_t& t : program->textures) {
      int texture = static_cast<int>(t);
      keep(texture);
      t = static_cast<uint32_t>(texture);
    }
    use = std::move(program);
  };
  for (Material& m : read_.materials) {
    keepOfProgram(m.program);
    Material::forEachInput(m, [&](auto& input) {
      keep(input.texture.texture);
      if (input.texture.texture < 0 || std::is_same_v<decltype(input), ColorInput&>) return;
      // A channel that the image lacks: grey stands for all colours, and alpha is 1.
      const int channels = scene.images[scene.textures[input.texture.texture].image].channels;
      int& channel = input.texture.channel;
      if (channel == 3 && channels % 2 == 1)
        input.texture = {};
      else
        channel = channel == 3 ? channels - 1 : channels < 3 ? 0 : channel;
    });
  }
  for (World& w : scene.worlds) {
    keep(w.texture);
    keepOfProgram(w.program);
  }
  for (Light& light : scene.lights) keepOfProgram(light.program);
  scene.materials = std::move(read_.materials);

  for (size_t i = 0; i < materials_.size(); i++)
    if (!materialOf_.contains(i))
      leftOut_.addUnneeded("material " + materials_[i].described(), "nothing that is rendered uses it");
  for (size_t i = 0; i < images_.size(); i++)
    if (imageOf_.lower_bound({i, {}}) == imageOf_.lower_bound({i + 1, {}}))
      leftOut_.addUnneeded("image " + images_[i].described(), "nothing that is rendered uses it");
}

}  // namespace wardmis
