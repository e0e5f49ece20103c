// SPDX-License-Identifier: GPL-3.0-or-later
// Reads a program (docs/scene-format.md, "Programs"), checks it, and makes a Program of what its user needs.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gltf/json.h"
#include "program/program.h"

namespace wardmis {

class ProgramReader {
 public:
  // textures: how many the file has. Throws Error(kScene) that names the operation for whatever is wrong.
  ProgramReader(const Json& program, size_t textures);

  // An input that is a value of this kind: `result` is the value's number. Its index in Program::results.
  int use(const Json& result, ValueKind kind);

  // texture: the index in Scene::textures of the one that the number at this place refers to.
  std::shared_ptr<Program> finish(const std::function<int(const Json&)>& texture) const;

 private:
  struct Argument {
    int value;  // -1: a literal
    float literal[3];
  };
  struct Setting {  // of a parameter
    uint32_t word = 0;
    std::string name;
    std::vector<float> numbers;
    std::vector<Json> textures;
    std::vector<uint32_t> tiles;  // numbers of theirs, where they are tiles
  };
  struct Step {
    Operation operation;
    Json place;
    std::vector<Argument> arguments;
    std::vector<Setting> settings;
  };

  Step read(const Json& json, size_t textures);
  Argument argument(const Json& json, ValueKind kind) const;
  Setting setting(const Json& json, const Parameter& parameter, size_t textures);
  static uint32_t attribute(Program& program, const Step& step, const std::string& name);
  void readTextures(const Json& json, size_t textures, Setting& out) const;

  std::vector<Step> steps_;
  std::vector<int> roots_;
  Json place_;
  size_t tableNumbers_ = 0;
};

}  // namespace wardmis
