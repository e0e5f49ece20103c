// SPDX-License-Identifier: GPL-3.0-or-later
// Programs as they are read: what is refused and how, slots, what is dropped, and the data that they ask for.
#include "gltf/program.h"

#include <gtest/gtest.h>

#include <set>

#include "every_operation.h"
#include "program/programs.h"

namespace wardmis {
namespace {

using namespace test;

GlbBuilder withProgram(const json& operations, json inputs = {{"diffuse", {{"value", {1, 1, 1}}, {"result", 0}}}}) {
  inputs["program"] = {{"operations", operations}};
  GlbBuilder b = textured(ward(std::move(inputs)));
  rawTexture<uint8_t>(b, 1, 1, 3, {255, 128, 0});
  return b;
}
const json kOne = json::array({{{"op", "position"}}});

TEST(Programs, AreRefusedByPlaceAndName) {
  struct Bad {
    const char* expected;
    json operations;
  };
  const auto after = [](json second) { return json::array({{{"op", "position"}}, std::move(second)}); };
  std::vector<json> many(4097, {{"op", "position"}});
  const Bad bad[] = {
      {"program.operations: has 4097 operations, but 4096 are the most", many},
      {"operations[1] 'nose' .op: there is no operation \"nose\"", after({{"op", "nose"}})},
      {"operations[1]: 'op' is missing", after(json::object())},
      {"operations[1] 'mix': expected 3 arguments, found 1", after({{"op", "mix"}, {"in", {1}}})},
      {"operations[1] 'mix' .in[1]: expected a vector, [x, y, z], or the value of an earlier operation, {\"result\": "
       "its "
       "index}, found 99",
       after({{"op", "mix"}, {"in", {1, 99, 3}}})},
      {"operations[1] 'mix' .in[0]: expected a number, or the value of an earlier operation, {\"result\": its index}, "
       "found \"a\"",
       after({{"op", "mix"}, {"in", {"a", {1, 2, 3}, {1, 2, 3}}}})},
      {"operations[1] 'mix' .in[2]: expected 3 numbers, found [1]",
       after({{"op", "mix"}, {"in", {1, {1, 2, 3}, {1}}}})},
      {"operations[1] 'add' .in[0]: expected a number, or the value of an earlier operation",
       after({{"op", "add"}, {"in", {{1, 2, 3}, 2}}})},
      {"operations[1] 'add' .in[1].result: expected a number, found a vector: value 0 is of operation 'position'",
       after({{"op", "add"}, {"in", {1, {{"result", 0}}}}})},
      {"operations[1] 'x' .in[0].result: refers to value 1, which is not an earlier one",
       after({{"op", "x"}, {"in", {{{"result", 1}}}}})},
      {"operations[1] 'x' .in[0].result: refers to value 7", after({{"op", "x"}, {"in", {{{"result", 7}}}}})},
      {"operations[1] 'x' .in[0].result: expected a whole number", after({{"op", "x"}, {"in", {{{"result", -1}}}}})},
      {"operations[1] 'x' .in[0]: 'result' is missing", after({{"op", "x"}, {"in", {{{"value", 1}}}}})},
      {"operations[1] 'sin' .in[0]: expected a number of single precision", after({{"op", "sin"}, {"in", {1e60}}})},
      {"operations[1] 'sin' .foo: the operation has no parameter 'foo'",
       after({{"op", "sin"}, {"in", {1}}, {"foo", 1}})},
      {"operations[1] 'attribute': its parameter 'name' is missing", after({{"op", "attribute"}})},
      {"operations[1] 'uv' .shift: expected one of \"none\", \"x\", \"y\", found \"z\"",
       after({{"op", "uv"}, {"shift", "z"}})},
      {"operations[1] 'uv' .width: expected a number from 0 to 1000, found -1", after({{"op", "uv"}, {"width", -1}})},
      {"operations[1] 'bump' .version: expected a whole number from 3 to 5",
       after({{"op", "bump"}, {"in", {0, 0, 0, 1, 1, {0, 0, 1}}}, {"version", 2}})},
      {"operations[1] 'image' .texture: refers to textures[9], but the file has 1",
       after({{"op", "image"}, {"in", {{{"result", 0}}}}, {"texture", 9}})},
      {"operations[1] 'image' .texture[1][0]: there is such a tile already",
       after({{"op", "image"}, {"in", {{{"result", 0}}}}, {"texture", {{1001, 0}, {1001, 0}}}})},
      {"operations[1] 'image' .texture[0][0]: expected a whole number from 1001 to 10999",
       after({{"op", "image"}, {"in", {{{"result", 0}}}}, {"texture", {{7, 0}}}})},
      {"operations[1] 'image' .texture: expected at least one tile",
       after({{"op", "image"}, {"in", {{{"result", 0}}}}, {"texture", json::array()}})},
      {"operations[1] 'ramp' .table: expected at least two rows",
       after({{"op", "ramp"}, {"in", {1}}, {"table", {{1, 1, 1, 1}}}})},
      {"operations[1] 'ramp' .table[1]: expected 4 numbers",
       after({{"op", "ramp"}, {"in", {1}}, {"table", {{1, 1, 1, 1}, {1, 2}}}})},
      {"operations[1] 'curve': `from` and `to` are equal",
       after({{"op", "curve"}, {"in", {1, 1}}, {"table", {1, 2}}, {"from", 2}, {"to", 2}})},
      {"operations[1] 'mapping' .matrix: expected 12 numbers",
       after({{"op", "mapping"}, {"in", {{0, 0, 0}}}, {"matrix", {1, 2}}})},
      {"operations[1] 'curve' .table: the program's tables have more than 262144 numbers",
       after({{"op", "curve"}, {"in", {1, 1}}, {"table", std::vector<int>(262145, 1)}})},
  };
  for (const Bad& b : bad) {
    const std::string message = errorOf([&] { read(withProgram(b.operations).bytes()); });
    EXPECT_NE(message.find("materials[0] 'Plate' .extensions.WARDMIS_scene.program"), message.npos) << message;
    expectHas(message, b.expected);
  }
}

TEST(Programs, AreRefusedWithTheirInputs) {
  const auto refused = [](const char* expected, json inputs) {
    expectHas(errorOf([&] { read(withProgram(kOne, std::move(inputs)).bytes()); }), expected);
  };
  refused("diffuse.result: refers to value 3, but the program has 1", {{"diffuse", {{"result", 3}}}});
  refused("alphaX.result: expected a number, found a vector: value 0 is of operation 'position'",
          {{"alphaX", {{"result", 0}}}});
  refused("diffuse: has both a result and a texture", {{"diffuse", {{"result", 0}, {"texture", {{"index", 0}}}}}});
  refused("normal: 'result' is missing", {{"normal", json::object()}});
  GlbBuilder b = textured(ward({{"diffuse", {{"result", 0}}}}));
  expectHas(errorOf([&] { read(b.bytes()); }), "diffuse.result: refers to a value, but the material has no program");
}

// More values than slots wait for their use.
// Of a world and a light: one value each, with textures of their own.
TEST(Programs, BelongToWorldsAndLightsToo) {
  GlbBuilder b = textured(ward({{"diffuse", {{"value", {1, 1, 1}}}}}));
  rawTexture<uint8_t>(b, 1, 1, 3, {255, 128, 0});
  const json operations = {{{"op", "direction"}}, {{"op", "environment"}, {"in", {{{"result", 0}}}}, {"texture", 0}}};
  const json program = {{"operations", operations}};
  b.extension()["version"] = 1;
  b.extension()["world"] = {{"program", program}, {"result", 1}, {"cone", {{"axis", {0, 0, 2}}, {"angle", 0.5}}}};
  b.extension()["lights"] = {{{"type", "point"}, {"intensity", 2}, {"program", program}, {"result", 0}}};
  b.root["nodes"].push_back({{"extensions", {{"WARDMIS_scene", {{"light", 0}}}}}});
  if (b.root.contains("scenes")) b.root["scenes"][0]["nodes"].push_back(b.root["nodes"].size() - 1);
  const Scene s = read(b);
  ASSERT_EQ(s.worlds.size(), 1u);
  const World& world = s.worlds[0];
  EXPECT_EQ(world.radiance.x, 1);
  ASSERT_TRUE(world.program);
  EXPECT_EQ(world.program->instructions.size(), 2u);
  ASSERT_EQ(world.program->textures.size(), 1u);
  EXPECT_LT(world.program->textures[0], s.textures.size());
  EXPECT_EQ(world.result, 0);
  EXPECT_EQ(world.coneAxis.z, 1);
  EXPECT_EQ(world.coneAngle, 0.5f);
  ASSERT_EQ(s.lights.size(), 1u);
  ASSERT_TRUE(s.lights[0].program);
  EXPECT_EQ(s.lights[0].program->instructions.size(), 1u);  // what is not asked for is dropped

  const auto refused = [&](const char* expected, const char* where, const json& change) {
    GlbBuilder bad = b;
    json& owner = std::string(where) == "world" ? bad.extension()["world"] : bad.extension()["lights"][0];
    owner.merge_patch(change);
    expectHas(errorOf(bad), expected);
  };
  refused("world.result: refers to value 5, but the program has 2", "world", {{"result", 5}});
  refused("'result' is missing", "world", {{"result", nullptr}});
  refused("world.result: refers to a value, but there is no program", "world", {{"program", nullptr}});
  refused("world.texture: stands beside a program", "world", {{"texture", {{"index", 0}}}});
  refused("world.cone.axis: expected a direction", "world", {{"cone", {{"axis", {0, 0, 0}}}}});
  refused("world.cone.angle: expected a number from", "world", {{"cone", {{"angle", 7}}}});
  refused("world.program.operations[1] 'environment' .texture: refers to textures[9]", "world",
          {{"program",
            {{"operations", {operations[0], {{"op", "environment"}, {"in", {{{"result", 0}}}}, {"texture", 9}}}}}}});
  refused("lights[0].result: expected a vector, found a number: value 0 is of operation 'ray-length'", "light",
          {{"program", {{"operations", {{{"op", "ray-length"}}}}}}});
}

TEST(Programs, AreRefusedWhereTooMuchWaits) {
  json operations = json::array();
  for (int i = 0; i < 171; ++i) operations.push_back({{"op", "position"}, {"shift", "x"}, {"width", i}});
  for (int i = 0; i < 170; ++i)
    operations.push_back({{"op", "vector-add"}, {"in", {{{"result", i == 0 ? 170 : 170 + i}}, {{"result", 169 - i}}}}});
  expectHas(errorOf([&] { program(operations); }), "operations[170] 'position': more than 512 numbers are waiting");
  operations = json::array({{{"op", "position"}}});
  for (int i = 1; i < 4096; ++i) operations.push_back({{"op", "vector-add"}, {"in", {{{"result", i - 1}}, {1, 0, 0}}}});
  const std::shared_ptr<Program> chain = program(operations);
  EXPECT_LE(chain->slots, 6);
  EXPECT_EQ(chain->literals.size(), 3u);
  ShadingContext context;
  EXPECT_EQ(values(*chain, context)[0], 4095);
}

// Random programs compute the same as when no slot is used twice.
TEST(Programs, SlotsAreUsedAgainWithoutHarm) {
  uint32_t state = 1;
  const auto random = [&](int n) { return static_cast<int>((state = state * 1664525 + 1013904223) >> 16) % n; };
  for (int round = 0; round < 200; ++round) {
    json operations = json::array({{{"op", "position"}}, {{"op", "ray-length"}}});
    std::vector<bool> isVector = {true, false};
    const auto argument = [&](bool vector) -> json {
      for (int tries = 0; tries < 20; ++tries) {
        const int k = random(static_cast<int>(isVector.size()));
        if (isVector[static_cast<size_t>(k)] == vector) return {{"result", k}};
      }
      return vector ? json{0.5, 0.25, 1} : json(0.75);
    };
    for (int i = 0; i < 40; ++i) {
      const char* const kNames[] = {"vector-add", "vector-scale", "vector-dot",   "add",
                                    "combine",    "mix",          "vector-cross", "sin"};
      const std::string name = kNames[random(8)];
      for (const OperationInfo& o : kOperations) {
        if (o.name != name) continue;
        json in = json::array();
        for (size_t k = 0; k < o.arguments.size(); ++k) in.push_back(argument(o.arguments[k] == 'v'));
        operations.push_back({{"op", name}, {"in", in}});
        isVector.push_back(o.result == ValueKind::kVector);
      }
    }
    // the same, every value kept to the end
    const JsonDocument document("scene.glb", json{{"program", {{"operations", operations}}}}.dump());
    ProgramReader all(Json(document).at("program"), 0);
    const JsonDocument numbers("scene.glb", json{{"n",
                                                  [&] {
                                                    json list = json::array();
                                                    for (size_t i = 0; i < operations.size(); ++i) list.push_back(i);
                                                    return list;
                                                  }()}}
                                                .dump());
    const JsonArray list = Json(numbers).array("n");
    for (size_t i = 0; i < operations.size(); ++i)
      all.use(list[i], isVector[i] ? ValueKind::kVector : ValueKind::kNumber);
    const auto kept = all.finish([](const Json&) { return 0; });
    const auto reused = program(operations);
    EXPECT_LE(reused->slots, kept->slots);
    ShadingContext context;
    context.position.value = {0.3f, 0.7f, -0.2f};
    context.rayLength = 1.5f;
    Slots slots;
    run(*kept, context, {}, slots);
    const std::vector<float> found = values(*reused, context);
    for (size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k], slots[kept->results.back() + k]) << operations;
  }
}

TEST(Programs, KeepOnlyWhatInputsNeed) {
  const json operations = {{{"op", "uv"}, {"set", "Other"}},
                           {{"op", "image"}, {"in", {{{"result", 0}}}}, {"texture", 0}},
                           {{"op", "vector"}, {"in", {0.5}}},
                           {{"op", "camera"}}};
  const auto none = read(withProgram(operations, {{"diffuse", {{"result", 2}}}}).bytes());
  const Program& p = *none.materials[0].program;
  EXPECT_EQ(p.instructions.size(), 1u);
  EXPECT_EQ(p.reads, 0u);
  EXPECT_TRUE(p.attributes.empty());
  EXPECT_TRUE(none.textures.empty());
  const auto one = read(withProgram(operations, {{"diffuse", {{"result", 1}}}}).bytes());
  EXPECT_EQ(one.materials[0].program->textures, std::vector<uint32_t>{0});
  EXPECT_EQ(one.textures.size(), 1u);
  // inputs of one value have one result, so that they are known to be the same
  const auto shared =
      read(withProgram({{{"op", "ray-length"}}}, {{"alphaX", {{"result", 0}}}, {"alphaY", {{"result", 0}}}}).bytes());
  EXPECT_EQ(shared.materials[0].alphaX.result, shared.materials[0].alphaY.result);
  EXPECT_EQ(shared.materials[0].program->results.size(), 1u);
  // an input that is black needs nothing
  const auto black = read(withProgram(operations, {{"diffuse", {{"value", {0, 0, 0}}, {"result", 1}}}}).bytes());
  EXPECT_EQ(black.materials[0].diffuse.result, -1);
}

TEST(Programs, MayHaveEveryOperation) {
  const Scene scene = read(withEveryOperation().bytes());
  const Program& p = *scene.materials[0].program;
  std::set<Operation> used;
  for (const Instruction& i : p.instructions) used.insert(i.operation);
  EXPECT_EQ(used.size(), kOperationCount);
  EXPECT_EQ(scene.materials[0].index, 2);
  EXPECT_EQ(p.reads, kReadsShift | kReadsAttributes | kReadsGenerated | kReadsObject | kReadsCamera | kReadsRay);
}

TEST(Programs, AskForVertexDataByName) {
  const json operations = {{{"op", "uv"}, {"set", "Second"}},
                           {{"op", "attribute"}, {"name", "Wear"}},
                           {{"op", "attribute"}, {"name", "COLOR_0"}},
                           {{"op", "attribute"}, {"name", "Absent"}},
                           {{"op", "tangent-uv"}},
                           {{"op", "generated"}},
                           {{"op", "vector-multiply-add"}, {"in", {{{"result", 0}}, {{"result", 1}}, {{"result", 2}}}}},
                           {{"op", "vector-multiply-add"}, {"in", {{{"result", 3}}, {{"result", 4}}, {{"result", 5}}}}},
                           {{"op", "vector-add"}, {"in", {{{"result", 6}}, {{"result", 7}}}}}};
  GlbBuilder b = withProgram(operations, {{"diffuse", {{"result", 8}}}});
  json& p = primitive(b);
  p["extensions"]["WARDMIS_scene"]["uvSets"] = {"First", "Second"};
  p["attributes"]["TEXCOORD_1"] = b.accessor<float>({0, 0, 1, 0, 1, 0.25f, 0, 1}, 2);
  p["attributes"]["_Wear"] = b.accessor<float>({1, 2, 3, 4}, 1);
  p["attributes"]["COLOR_0"] =
      b.accessor<uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 0, 0, 0, 0}, 4, {{"normalized", true}});
  p["attributes"]["_GENERATED"] = b.accessor<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  b.root["nodes"][0]["extensions"]["WARDMIS_scene"] = {{"color", {0.1, 0.2, 0.3, 0.4}},
                                                       {"index", 3},
                                                       {"random", 0.5},
                                                       {"attributes", {{"b", {1, 2}}, {"a", {4}}}},
                                                       {"generated", {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0}}};
  const Scene scene = read(b.bytes());
  const MeshPart& part = scene.meshes[0].parts[0];
  ASSERT_EQ(part.attributes.size(), 5u);
  EXPECT_EQ(part.attributes[0].components, 2);
  EXPECT_EQ(part.attributes[0].data[5], 0.75f);  // v from the bottom
  EXPECT_EQ(part.attributes[1].components, 1);
  EXPECT_EQ(part.attributes[1].data[3], 4);
  EXPECT_EQ(part.attributes[2].components, 4);
  EXPECT_EQ(part.attributes[2].data[0], 1);
  EXPECT_EQ(part.attributes[3].components, 0);
  EXPECT_EQ(part.attributes[4].components, 2);  // UVs to compute tangents from
  EXPECT_EQ(part.generated.size(), 4u);
  const ObjectData& object = *scene.instances[0].object;
  EXPECT_EQ(object.color[3], 0.4f);
  EXPECT_EQ(object.index, 3);
  EXPECT_EQ(object.random, 0.5f);
  EXPECT_TRUE(object.hasGenerated);
  EXPECT_EQ(object.attributes[0].first, "a");
  EXPECT_EQ(object.attributes[1].second.components, 2);
  for (const std::string& left : scene.leftOut)
    for (const char* name : {"Wear", "COLOR_0", "TEXCOORD_1", "GENERATED"})
      EXPECT_EQ(left.find(name), left.npos) << left;
}

}  // namespace
}  // namespace wardmis
