// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "gltf/light.h"

namespace wardmis {
namespace {

constexpr const char* kExtension = "WARDMIS_scene";
constexpr const char* kExportAgain = "export the scene again";
constexpr int kMostLevels = 64;
constexpr size_t kMostSteps = 129;  // of a motion, as Embree has it
constexpr size_t kMostInstances = 50'000'000;

bool isFinite(const Affine& m) {
  return wardmis::isFinite(m.x) && wardmis::isFinite(m.y) && wardmis::isFinite(m.z) && wardmis::isFinite(m.t);
}

Affine affine(Vec3f translation, Quaternion q, Vec3f scale, const Json& place) {
  const float norm2 = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
  if (!(norm2 > 1e-12f && norm2 < 1e12f)) place.fail("its rotation is not a unit quaternion", kExportAgain);
  const float s = 2 / norm2, x = q[0], y = q[1], z = q[2], w = q[3];
  return {Vec3f{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)} * scale.x,
          Vec3f{s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)} * scale.y,
          Vec3f{s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)} * scale.z, translation};
}

Affine toAffine(const Json& matrix) {
  const auto m = matrix.numbers<16>();
  const float off = std::max({std::fabs(m[3]), std::fabs(m[7]), std::fabs(m[11]), std::fabs(m[15] - 1)});
  if (off > 1e-5f) matrix.fail("its last row is not 0 0 0 1", kExportAgain);
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

Affine localMatrix(const Json& node) {
  const auto translation = node.find("translation"), rotation = node.find("rotation"), scale = node.find("scale");
  if (const auto matrix = node.find("matrix")) {
    if (translation || rotation || scale)
      node.fail("has both a matrix and translation, rotation or scale", kExportAgain);
    return toAffine(*matrix);
  }
  return affine(translation ? translation->vec3() : Vec3f{0, 0, 0},
                rotation ? rotation->numbers<4>() : Quaternion{0, 0, 0, 1}, scale ? scale->vec3() : Vec3f{1, 1, 1},
                node);
}

// The forest of nodes: each one's parent, world matrix, and whether the rendered scene holds it.
class NodeForest {
 public:
  NodeForest(const Json& root, const JsonArray& nodes, LeftOut& leftOut);
  bool isInScene(size_t node) const {
    for (uint32_t i = static_cast<uint32_t>(node); i != kNone; i = parent_[i])
      if (inScene_[i]) return true;
    return false;
  }
  const Affine& world(size_t node);
  Affine parent(size_t node) { return parent_[node] == kNone ? Affine{} : world(parent_[node]); }

 private:
  static constexpr uint32_t kNone = UINT32_MAX;
  const JsonArray& nodes_;
  std::vector<uint32_t> parent_;
  std::vector<bool> inScene_;  // of those that the scene lists: they and what hangs on them
  std::vector<bool> known_;    // whether world_ is
  std::vector<Affine> world_;
};

NodeForest::NodeForest(const Json& root, const JsonArray& nodes, LeftOut& leftOut)
    : nodes_(nodes),
      parent_(nodes.size(), kNone),
      inScene_(nodes.size(), false),
      known_(nodes.size(), false),
      world_(nodes.size()) {
  for (size_t i = 0; i < nodes.size(); i++) {
    const JsonArray children = nodes[i].array("children");
    for (size_t k = 0; k < children.size(); k++) {
      const size_t child = children[k].index(nodes.size(), "nodes");
      if (parent_[child] != kNone)
        children[k].fail(fmt::format("node {} is a child of nodes[{}] already", child, parent_[child]), kExportAgain);
      parent_[child] = static_cast<uint32_t>(i);
    }
  }
  for (size_t i = 0; i < nodes.size(); i++) {
    uint32_t top = static_cast<uint32_t>(i);
    for (int level = 1; parent_[top] != kNone; top = parent_[top])
      if (++level > kMostLevels)
        nodes[i].fail(fmt::format("has more than {} ancestors, or is its own ancestor", kMostLevels - 1),
                      "flatten the hierarchy and export again");
  }

  const JsonArray scenes = root.array("scenes");
  if (scenes.size() == 0) {
    for (size_t i = 0; i < nodes.size(); i++) inScene_[i] = parent_[i] == kNone;
    return;
  }
  const auto index = root.find("scene");
  const JsonArray roots = scenes[index ? index->index(scenes.size(), "scenes") : 0].array("nodes");
  for (size_t k = 0; k < roots.size(); k++) {
    const size_t i = roots[k].index(nodes.size(), "nodes");
    if (parent_[i] != kNone)
      leftOut.add("the root " + nodes[i].described(),
                  fmt::format("it is none, but a child of {}, and stays there", nodes[parent_[i]].described()));
    if (inScene_[i]) leftOut.addUnneeded("the second of the root " + nodes[i].described(), "the scene lists it twice");
    inScene_[i] = true;
  }
}

const Affine& NodeForest::world(size_t i) {
  if (!known_[i]) {
    const Affine local = localMatrix(nodes_[i]);
    world_[i] = parent_[i] == kNone ? local : world(parent_[i]) * local;
    if (!isFinite(world_[i])) nodes_[i].fail("its world matrix is not finite", kExportAgain);
    known_[i] = true;
  }
  return world_[i];
}

// World matrices at equal steps of the shutter's time, of a node whose parent stands at `parent`; null where it stands.
std::shared_ptr<const std::vector<Affine>> motionOf(const Json& node, const Affine& parent) {
  const auto extension = node.extension(kExtension);
  const auto json = extension ? extension->find("motion") : std::nullopt;
  if (!json) return nullptr;
  const JsonArray steps = json->array();
  if (steps.size() < 2 || steps.size() > kMostSteps) json->failExpected(fmt::format("2 to {} matrices", kMostSteps));
  auto motion = std::make_shared<std::vector<Affine>>();
  for (size_t i = 0; i < steps.size(); i++) {
    const Affine world = parent * toAffine(steps[i]);
    const float determinant = std::fabs(world.determinant());
    if (!isFinite(world) || !(determinant > 1e-37f && determinant < 1e37f))
      steps[i].fail("the matrix, as placed, is not finite or has no inverse", kExportAgain);
    motion->push_back(world);
  }
  return motion;
}

bool hasMark(const Json& node, std::string_view name) {
  const auto extension = node.extension(kExtension);
  return extension && extension->booleanOr(name, false);
}

uint8_t visibility(const Json& node) {
  const auto extension = node.extension(kExtension);
  return extension ? readVisibility(*extension) : uint8_t{kSeenByAll};
}

ShadowTerminator terminator(const Json& node) {
  const auto extension = node.extension(kExtension);
  const auto json = extension ? extension->find("shadowTerminator") : std::nullopt;
  if (!json) return {};
  const auto [geometry, shading] = json->numbers<2>();
  if (!(geometry >= 0 && geometry <= 1 && shading >= 0 && shading <= 1)) json->failExpected("two numbers from 0 to 1");
  return {geometry, shading};
}

// What programs read of the object; null where the node says nothing.
std::shared_ptr<const ObjectData> objectData(const Json& node) {
  const auto extension = node.extension(kExtension);
  if (!extension) return nullptr;
  auto data = std::make_shared<ObjectData>();
  bool any = false;
  const auto find = [&](std::string_view key) {
    const auto json = extension->find(key);
    any |= json.has_value();
    return json;
  };
  if (const auto json = find("generated")) {
    data->hasGenerated = true;
    json->numbers(data->generated);
  }
  if (const auto json = find("color")) json->numbers(data->color);
  if (const auto json = find("index")) data->index = json->number();
  if (const auto json = find("random")) data->random = json->number();
  if (const auto json = find("attributes")) {
    json->forEachMember([&](std::string_view name, const Json& value) {
      const JsonArray numbers = value.array();
      if (numbers.size() < 1 || numbers.size() > 4) value.failExpected("one to four numbers");
      ObjectData::Value v;
      v.components = static_cast<int>(numbers.size());
      for (size_t i = 0; i < numbers.size(); i++) v.numbers[i] = numbers[i].number();
      data->attributes.emplace_back(name, v);
    });
    std::ranges::sort(data->attributes, {}, [](const auto& a) -> const std::string& { return a.first; });
  }
  return any ? data : nullptr;
}

// The matrices of EXT_mesh_gpu_instancing, relative to its node.
std::vector<Affine> instanceMatrices(const Json& extension, Accessors& accessors, Buffers& buffers, LeftOut& leftOut) {
  const Json attributes = extension.at("attributes");
  Array<Vec3f> translations, scales;
  Array<Quaternion> rotations;
  std::optional<size_t> count;
  attributes.forEachMember([&](std::string_view key, const Json& value) {
    const auto take = [&](auto& array) {
      array = accessors.read<std::remove_cvref_t<decltype(array[0])>>(value);
      if (count.value_or(array.size()) != array.size())
        value.fail(fmt::format("has {} elements, but the other attributes have {}", array.size(), *count),
                   kExportAgain);
      count = array.size();
    };
    if (key == "TRANSLATION")
      take(translations);
    else if (key == "ROTATION")
      take(rotations);
    else if (key == "SCALE")
      take(scales);
    else
      leftOut.addUnneeded("instance attribute " + cleaned(key), "the renderer does not use it");
  });
  if (!count) attributes.failExpected("TRANSLATION, ROTATION or SCALE");
  buffers.budget.charge(*count * sizeof(Affine), extension);
  std::vector<Affine> out(*count);
  for (size_t i = 0; i < out.size(); i++)
    out[i] = affine(translations.empty() ? Vec3f{0, 0, 0} : translations[i],
                    rotations.empty() ? Quaternion{0, 0, 0, 1} : rotations[i],
                    scales.empty() ? Vec3f{1, 1, 1} : scales[i], extension);
  return out;
}

}  // namespace

uint8_t readVisibility(const Json& json) {
  constexpr std::pair<std::string_view, Visibility> kKinds[] = {{"camera", kSeenByCamera},
                                                                {"diffuse", kSeenByDiffuse},
                                                                {"glossy", kSeenByGlossy},
                                                                {"transmission", kSeenByTransmission},
                                                                {"shadow", kCastsShadow}};
  const auto list = json.find("visibility");
  if (!list) return kSeenByAll;
  uint8_t bits = 0;
  const JsonArray kinds = list->array();
  for (size_t i = 0; i < kinds.size(); i++) bits |= kinds[i].choice(kKinds);
  return bits;
}

void readNodes(const Json& root, Accessors& accessors, Buffers& buffers, Materials& materials, Meshes& meshes,
               LeftOut& leftOut, bool needsCamera, Scene& scene) {
  const JsonArray nodes = root.array("nodes");
  NodeForest forest(root, nodes, leftOut);
  const auto own = root.extension(kExtension);
  const JsonArray lights = own ? own->array("lights") : JsonArray(root);
  const auto punctual = root.extension("KHR_lights_punctual");
  const JsonArray punctualLights = punctual ? punctual->array("lights") : JsonArray(root);
  const JsonArray cameras = root.array("cameras");

  const auto addInstance = [&](const Json& node, Instance instance) {
    if (!isFinite(instance.toWorld)) node.fail("its world matrix is not finite", kExportAgain);
    // The inverse must exist in single precision too.
    const float determinant = std::fabs(instance.toWorld.determinant());
    if (!(determinant > 1e-37f && determinant < 1e37f)) {
      leftOut.add("object " + node.described(), "its scale is 0 or too small or large for single precision");
      return;
    }
    if (scene.instances.size() == kMostInstances)
      node.fail("the scene has more than 50 million instances", "split the scene");
    buffers.budget.charge(sizeof(Instance) + instance.name.size(), node);
    scene.instances.push_back(std::move(instance));
  };

  std::optional<size_t> cameraNode;
  if (const auto camera = own ? own->find("camera") : std::nullopt) {
    cameraNode = camera->index(nodes.size(), "nodes");
    if (!nodes[*cameraNode].find("camera"))
      camera->fail(fmt::format("nodes[{}] has no camera", *cameraNode), kExportAgain);
  }
  for (size_t i = 0; i < nodes.size() && !cameraNode; i++)
    if (nodes[i].find("camera") && forest.isInScene(i)) cameraNode = i;
  if (!cameraNode && needsCamera)
    throw Error(ExitCode::kScene, scene.path + ": the scene has no camera",
                "add a camera, or make one active, or let the command choose a view");
  for (size_t i = 0; i < nodes.size(); i++) {
    if (!forest.isInScene(i)) {
      leftOut.addUnneeded("nodes of other scenes", "only one scene is rendered");
      continue;
    }
    const Json node = nodes[i];
    if (node.find("skin")) leftOut.add("skin of " + node.described(), "the mesh is rendered at rest");
    if (const auto use = node.find("mesh")) {
      const int mesh = meshes.use(*use);
      if (mesh < 0)
        leftOut.add("object " + node.described(), "its mesh has nothing to render");
      else {
        Instance instance{node.name(),
                          mesh,
                          forest.world(i),
                          visibility(node),
                          hasMark(node, "holdout"),
                          hasMark(node, "shadowCatcher"),
                          terminator(node),
                          objectData(node),
                          motionOf(node, forest.parent(i))};
        if (const auto many = node.extension("EXT_mesh_gpu_instancing")) {
          if (instance.motion) node.fail("has both motion and EXT_mesh_gpu_instancing", kExportAgain);
          const Affine base = instance.toWorld;
          for (const Affine& matrix : instanceMatrices(*many, accessors, buffers, leftOut)) {
            instance.toWorld = base * matrix;
            addInstance(node, instance);
          }
        } else {
          addInstance(node, std::move(instance));
        }
      }
    }
    // A node's own light is the better one where a file has both.
    const auto extension = node.extension(kExtension);
    const auto ownLight = extension ? extension->find("light") : std::nullopt;
    const auto core = node.extension("KHR_lights_punctual");
    if (ownLight || core) {
      std::optional<Light> light =
          ownLight ? readLight(lights[ownLight->index(lights.size(), "lights")], forest.world(i), materials)
                   : readPunctualLight(punctualLights[core->at("light").index(punctualLights.size(), "lights")],
                                       forest.world(i));
      if (light) {
        if (light->name.empty()) light->name = node.name();
        light->visibility = visibility(node);
        scene.lights.push_back(std::move(*light));
      } else {
        leftOut.addUnneeded("light " + node.described(), "its power is 0");
      }
    }
  }
  if (!cameraNode) return;
  const Json node = nodes[*cameraNode];
  const size_t camera = node.at("camera").index(cameras.size(), "cameras");
  scene.camera = readCamera(cameras[camera], node, forest.world(*cameraNode), scene.film);
  if (const auto motion = motionOf(node, forest.parent(*cameraNode)))
    for (const Affine& m : *motion)
      scene.camera->motion.push_back({normalize(m.x), normalize(m.y), normalize(m.z), m.t});
}

}  // namespace wardmis
