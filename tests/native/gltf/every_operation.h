// SPDX-License-Identifier: GPL-3.0-or-later
// A scene whose material needs every operation there is.
#pragma once

#include "glb_support.h"
#include "program/operation.h"

namespace wardmis::test {

inline json everyOperation() {
  json operations = {{{"op", "vector"}, {"in", {0.5}}}, {{"op", "mean"}, {"in", {{{"result", 0}}}}}};
  int vector = 0, number = 1;  // sums of what came before
  for (const OperationInfo& o : kOperations) {
    json step{{"op", o.name}, {"in", json::array()}};
    for (size_t i = 0; i < o.arguments.size(); ++i)
      if (o.arguments[i] == 'v')
        step["in"].push_back(i % 2 == 0 ? json{{"result", vector}} : json{0.25, 0.5, 1});
      else
        step["in"].push_back(i % 2 == 0 ? json{{"result", number}} : json(0.75));
    for (const Parameter& p : o.parameters) {
      if (p.name == "shift") step["shift"] = "x";
      if (!p.required) continue;
      if (p.kind == ParameterKind::kName) step[p.name] = "a";
      if (p.kind == ParameterKind::kTexture) step[p.name] = 0;
      if (p.kind == ParameterKind::kMatrix) step[p.name] = std::vector<int>(12, 1);
      if (p.kind == ParameterKind::kChoice) step[p.name] = p.choices[0];
      if (p.kind == ParameterKind::kTable && p.columns == 1) step[p.name] = {0, 1};
      if (p.kind == ParameterKind::kTable && p.columns > 1)
        step[p.name] = {std::vector<int>(static_cast<size_t>(p.columns), 0),
                        std::vector<int>(static_cast<size_t>(p.columns), 1)};
    }
    operations.push_back(step);
    int& sum = o.result == ValueKind::kVector ? vector : number;
    const auto last = static_cast<int>(operations.size()) - 1;
    operations.push_back({{"op", o.result == ValueKind::kVector ? "mix-vector" : "mix-number"},
                          {"in", {0.5, {{"result", sum}}, {{"result", last}}}}});
    sum = last + 1;
  }
  operations.push_back({{"op", "vector-scale"}, {"in", {{{"result", vector}}, {{"result", number}}}}});
  return operations;
}

inline GlbBuilder withEveryOperation() {
  const json operations = everyOperation();
  GlbBuilder b = textured(ward({{"diffuse", {{"value", {1, 1, 1}}, {"result", operations.size() - 1}}},
                                {"emission", {{"value", {1, 1, 1}}, {"result", operations.size() - 1}}},
                                {"index", 2},
                                {"program", {{"operations", operations}}}}));
  rawTexture<uint8_t>(b, 1, 1, 3, {255, 128, 0});
  primitive(b)["attributes"]["_a"] = b.accessor<float>({1, 2, 3, 4}, 1);
  b.extension() = {{"version", 1}, {"upAxis", "Z"}};
  b.root["nodes"][0]["extensions"]["WARDMIS_scene"] = {{"color", {0.1, 0.2, 0.3, 0.4}},
                                                       {"index", 3},
                                                       {"random", 0.5},
                                                       {"attributes", {{"b", {1, 2}}}},
                                                       {"generated", {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0}}};
  return b;
}

}  // namespace wardmis::test
