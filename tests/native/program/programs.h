// SPDX-License-Identifier: GPL-3.0-or-later
// Programs from their JSON, by the reader that files are read with.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gltf/program.h"
#include "program/run.h"
#include "scene/scene.h"

namespace wardmis::test {

using nlohmann::json;

// {"operations": [...]} of these; their inputs refer to the last of them.
inline std::shared_ptr<Program> program(const json& operations, size_t textures = 0) {
  const json text{{"operations", operations}, {"last", operations.size() - 1}};
  const JsonDocument document("scene.glb",
                              json{{"program", {{"operations", operations}}}, {"last", text["last"]}}.dump());
  const Json root(document);
  ProgramReader reader(root.at("program"), textures);
  const std::string name = operations.back().at("op");
  for (const OperationInfo& o : kOperations)
    if (o.name == name) reader.use(root.at("last"), o.result);
  return reader.finish([](const Json& index) { return static_cast<int>(index.integer(0, 1000)); });
}

// The material's program, with one result after the other by the numbers of its values.
inline void setProgram(Material& m, const json& operations, const std::vector<int>& results) {
  const JsonDocument document("scene.glb",
                              json{{"program", {{"operations", operations}}}, {"results", results}}.dump());
  const Json root(document);
  ProgramReader reader(root.at("program"), 0);
  const JsonArray list = root.array("results");
  for (size_t i = 0; i < list.size(); ++i)
    for (const OperationInfo& o : kOperations)
      if (operations[static_cast<size_t>(results[i])].at("op").get<std::string>() == o.name)
        reader.use(list[i], o.result);
  m.program = reader.finish([](const Json&) { return 0; });
}

// What the last of the operations makes: one number or three.
inline std::vector<float> values(const Program& p, ShadingContext context = {}, TextureAccess textures = {}) {
  Slots slots;
  slots.fill(-12345);
  run(p, context, textures, slots);
  const int n = floatsOf(info(p.instructions.back().operation).result);
  return {slots.begin() + p.results[0], slots.begin() + p.results[0] + n};
}
inline std::vector<float> values(const json& operations, const ShadingContext& context = {},
                                 TextureAccess textures = {}) {
  return values(*program(operations, 1000), context, textures);
}

}  // namespace wardmis::test
