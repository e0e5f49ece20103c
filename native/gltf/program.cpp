// SPDX-License-Identifier: GPL-3.0-or-later
#include "gltf/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <map>
#include <unordered_map>

namespace wardmis {
namespace {

constexpr const char* kExportAgain = "export the scene again";

const char* word(ValueKind kind) { return kind == ValueKind::kNumber ? "a number" : "a vector"; }

const std::unordered_map<std::string_view, Operation>& operationsByName() {
  static const auto* map = [] {
    auto* m = new std::unordered_map<std::string_view, Operation>;
    for (size_t i = 0; i < kOperationCount; i++) m->emplace(kOperations[i].name, static_cast<Operation>(i));
    return m;
  }();
  return *map;
}

// Gives values their slots in order, and takes them back after their last use.
class SlotAllocator {
 public:
  // The first of so many neighbouring free slots; -1: there are none.
  int take(int floats) {
    for (size_t i = 0; i + floats <= kMostSlots; i++) {
      int n = 0;
      while (n < floats && !used_[i + n]) n++;
      if (n < floats) {
        i += n;
        continue;
      }
      std::fill_n(used_.begin() + i, floats, true);
      most_ = std::max(most_, i + floats);
      return static_cast<int>(i);
    }
    return -1;
  }
  void give(int slot, int floats) { std::fill_n(used_.begin() + slot, floats, false); }
  size_t most() const { return most_; }

 private:
  std::array<bool, kMostSlots> used_{};
  size_t most_ = 0;
};

}  // namespace

ProgramReader::ProgramReader(const Json& program, size_t textures) : place_(program) {
  const Json list = program.at("operations");
  const JsonArray operations = list.array();
  if (operations.size() > kMostOperations)
    list.fail(fmt::format("has {} operations, but {} are the most", operations.size(), kMostOperations),
              "simplify the material, or bake parts of it");
  program.forEachMember([&](std::string_view key, const Json& member) {
    if (key != "operations") member.fail("a program has `operations` alone", kExportAgain);
  });
  steps_.reserve(operations.size());
  for (size_t i = 0; i < operations.size(); i++) steps_.push_back(read(operations[i], textures));
}

ProgramReader::Step ProgramReader::read(const Json& json, size_t textures) {
  const std::string_view name = json.at("op").string();
  const auto found = operationsByName().find(name);
  if (found == operationsByName().end())
    json.at("op").fail(fmt::format("there is no operation \"{}\"", cleaned(name)),
                       "use a newer renderer for newer files");
  const OperationInfo& op = info(found->second);
  Step step{found->second, json, {}, {}};

  const JsonArray in = json.array("in");
  if (in.size() != op.arguments.size())
    json.fail(fmt::format("expected {} arguments, found {}", op.arguments.size(), in.size()), kExportAgain);
  for (size_t i = 0; i < in.size(); i++) step.arguments.push_back(argument(in[i], argumentKind(op, i)));

  for (const Parameter& p : op.parameters) {
    const auto given = json.find(p.name);
    if (!given && p.required) json.fail(fmt::format("its parameter '{}' is missing", p.name), kExportAgain);
    Setting setting;
    if (given)
      setting = this->setting(*given, p, textures);
    else if (p.kind == ParameterKind::kNumber)
      setting.word = std::bit_cast<uint32_t>(p.fallback);
    else
      setting.word = static_cast<uint32_t>(p.fallback);
    step.settings.push_back(std::move(setting));
  }
  json.forEachMember([&](std::string_view key, const Json& member) {
    const auto known = [&](const Parameter& p) { return p.name == key; };
    if (key != "op" && key != "in" && std::ranges::none_of(op.parameters, known))
      member.fail(fmt::format("the operation has no parameter '{}'", cleaned(key)), kExportAgain);
  });
  if (found->second == Operation::kCurve || found->second == Operation::kCurves)
    if (step.settings[1].word == step.settings[2].word) json.fail("`from` and `to` are equal", kExportAgain);
  return step;
}

ProgramReader::Argument ProgramReader::argument(const Json& json, ValueKind kind) const {
  Argument out{-1, {0, 0, 0}};
  if (json.isObject()) {
    const Json result = json.at("result");
    const uint64_t j = result.integer(0, UINT64_MAX);
    if (j >= steps_.size())
      result.fail(fmt::format("refers to value {}, which is not an earlier one: {} are", j, steps_.size()),
                  kExportAgain);
    const OperationInfo& source = info(steps_[j].operation);
    if (source.result != kind)
      result.fail(fmt::format("expected {}, found {}: value {} is of operation '{}'", word(kind), word(source.result),
                              j, source.name),
                  kExportAgain);
    out.value = static_cast<int>(j);
  } else if (kind == ValueKind::kVector ? !json.isArray() : !json.isNumber()) {
    const char* constant = kind == ValueKind::kVector ? "a vector, [x, y, z]" : "a number";
    json.failExpected(fmt::format("{}, or the value of an earlier operation, {{\"result\": its index}}", constant));
  } else if (kind == ValueKind::kNumber) {
    out.literal[0] = json.number();
  } else {
    json.numbers(out.literal);
  }
  return out;
}

ProgramReader::Setting ProgramReader::setting(const Json& json, const Parameter& p, size_t textures) {
  Setting out;
  const auto charge = [&](size_t numbers) {
    tableNumbers_ += numbers;
    if (tableNumbers_ > kMostTableNumbers)
      json.fail(fmt::format("the program's tables have more than {} numbers", kMostTableNumbers), kExportAgain);
  };
  switch (p.kind) {
    case ParameterKind::kBoolean:
      out.word = json.boolean();
      break;
    case ParameterKind::kInteger:
      out.word = static_cast<uint32_t>(json.integer(static_cast<uint64_t>(p.low), static_cast<uint64_t>(p.high)));
      break;
    case ParameterKind::kNumber:
      out.word = std::bit_cast<uint32_t>(json.number(p.low, p.high) + 0.0f);  // not -0
      break;
    case ParameterKind::kChoice: {
      const std::string_view given = json.string();
      std::string expected;
      for (size_t i = 0; i < p.choices.size() && !p.choices[i].empty(); i++) {
        if (p.choices[i] == given) return out.word = static_cast<uint32_t>(i), out;
        expected += fmt::format("{}\"{}\"", i > 0 ? ", " : "", p.choices[i]);
      }
      json.failExpected("one of " + expected);
    }
    case ParameterKind::kName:
      out.name = json.string();
      break;
    case ParameterKind::kTexture:
      readTextures(json, textures, out);
      break;
    case ParameterKind::kTable: {
      const JsonArray rows = json.array();
      if (rows.size() < 2) json.failExpected("at least two rows");
      charge(rows.size() * static_cast<size_t>(p.columns));
      out.numbers.resize(rows.size() * static_cast<size_t>(p.columns));
      for (size_t i = 0; i < rows.size(); i++) {
        if (p.columns == 1)
          out.numbers[i] = rows[i].number();
        else
          rows[i].numbers(std::span(out.numbers).subspan(i * p.columns, p.columns));
      }
      break;
    }
    case ParameterKind::kMatrix:
      charge(12);
      out.numbers.resize(12);
      json.numbers(out.numbers);
      break;
  }
  return out;
}

void ProgramReader::readTextures(const Json& json, size_t textures, Setting& out) const {
  if (!json.isArray()) {
    json.index(textures, "textures");
    out.textures.push_back(json);
    return;
  }
  constexpr uint64_t kFirst = 1001, kLast = 10999;  // UDIM
  const JsonArray tiles = json.array();
  if (tiles.size() == 0) json.failExpected("at least one tile");
  std::map<uint32_t, Json> sorted;
  for (size_t i = 0; i < tiles.size(); i++) {
    const JsonArray pair = tiles[i].array();
    if (pair.size() != 2) tiles[i].failExpected("a tile's number and its texture");
    const auto number = static_cast<uint32_t>(pair[0].integer(kFirst, kLast));
    pair[1].index(textures, "textures");
    if (!sorted.emplace(number, pair[1]).second) pair[0].fail("there is such a tile already", kExportAgain);
  }
  for (const auto& [number, texture] : sorted) {
    out.tiles.push_back(number);
    out.textures.push_back(texture);
  }
}

int ProgramReader::use(const Json& result, ValueKind kind) {
  const size_t k = result.integer(0, UINT64_MAX);
  if (k >= steps_.size())
    result.fail(fmt::format("refers to value {}, but the program has {}", k, steps_.size()), kExportAgain);
  const OperationInfo& op = info(steps_[k].operation);
  if (op.result != kind)
    result.fail(
        fmt::format("expected {}, found {}: value {} is of operation '{}'", word(kind), word(op.result), k, op.name),
        kExportAgain);
  const auto found = std::ranges::find(roots_, static_cast<int>(k));  // inputs of one value are known to be the same
  const auto root = static_cast<int>(found - roots_.begin());
  if (found == roots_.end()) roots_.push_back(static_cast<int>(k));
  return root;
}

std::shared_ptr<Program> ProgramReader::finish(const std::function<int(const Json&)>& texture) const {
  auto program = std::make_shared<Program>();
  const size_t n = steps_.size();
  constexpr size_t kNever = SIZE_MAX;
  std::vector<size_t> lastUse(n, kNever);  // the last step that needs the value; n: an input does
  for (const int root : roots_) lastUse[root] = n;
  for (size_t i = n; i-- > 0;) {
    if (lastUse[i] == kNever && steps_[i].operation == Operation::kBend) lastUse[i] = n;  // what follows sees it
    if (lastUse[i] == kNever) continue;
    for (const Argument& a : steps_[i].arguments)
      if (a.value >= 0 && lastUse[a.value] == kNever) lastUse[a.value] = i;
  }

  SlotAllocator slots;
  std::vector<int> slot(n, -1);
  std::map<std::vector<float>, uint16_t> literals;
  std::map<uint32_t, uint32_t> textureIndex;
  for (size_t i = 0; i < n; i++) {
    if (lastUse[i] == kNever) continue;
    const Step& step = steps_[i];
    const OperationInfo& op = info(step.operation);
    Instruction instruction{step.operation, 0, static_cast<uint16_t>(program->arguments.size()),
                            static_cast<uint16_t>(program->parameters.size())};
    for (size_t k = 0; k < step.arguments.size(); k++) {
      const Argument& a = step.arguments[k];
      if (a.value >= 0) {
        program->arguments.push_back(static_cast<uint16_t>(slot[a.value]));
        continue;
      }
      const std::vector<float> numbers(a.literal, a.literal + floatsOf(argumentKind(op, k)));
      const auto [entry, isNew] = literals.try_emplace(numbers, static_cast<uint16_t>(program->literals.size()));
      if (isNew) {
        program->literals.insert(program->literals.end(), numbers.begin(), numbers.end());
        if (program->literals.size() > kMostLiterals)
          step.place.fail(fmt::format("the program has more than {} different constants", kMostLiterals), kExportAgain);
      }
      program->arguments.push_back(entry->second | kLiteral);
    }
    // The result may take the place of arguments that are used for the last time: they are read before it is written.
    for (const Argument& a : step.arguments)
      if (a.value >= 0 && lastUse[a.value] == i && slot[a.value] >= 0) {
        slots.give(slot[a.value], floatsOf(info(steps_[a.value].operation).result));
        slot[a.value] = -1;
      }
    slot[i] = slots.take(floatsOf(op.result));
    if (slot[i] < 0)
      step.place.fail(fmt::format("more than {} numbers are waiting to be used here", kMostSlots),
                      "simplify the material, or bake parts of it");
    instruction.result = static_cast<uint16_t>(slot[i]);

    for (size_t k = 0; k < step.settings.size(); k++) {
      const Setting& s = step.settings[k];
      const Parameter& p = op.parameters[k];
      auto& words = program->parameters;
      switch (p.kind) {
        case ParameterKind::kName:
          words.push_back(attribute(*program, step, s.name));
          break;
        case ParameterKind::kTexture: {
          const auto index = [&](const Json& place) {
            const auto scene = static_cast<uint32_t>(texture(place));
            const auto [entry, isNew] =
                textureIndex.try_emplace(scene, static_cast<uint32_t>(program->textures.size()));
            if (isNew) program->textures.push_back(scene);
            return entry->second;
          };
          if (s.tiles.empty()) {
            words.insert(words.end(), {index(s.textures[0]), 0});
            break;
          }
          words.insert(words.end(),
                       {static_cast<uint32_t>(program->tiles.size()), static_cast<uint32_t>(s.tiles.size())});
          for (size_t t = 0; t < s.tiles.size(); t++) program->tiles.push_back({s.tiles[t], index(s.textures[t])});
          break;
        }
        case ParameterKind::kTable:
        case ParameterKind::kMatrix:
          words.push_back(static_cast<uint32_t>(program->tables.size()));
          if (p.kind == ParameterKind::kTable)
            words.push_back(static_cast<uint32_t>(s.numbers.size()) / static_cast<uint32_t>(p.columns));
          program->tables.insert(program->tables.end(), s.numbers.begin(), s.numbers.end());
          break;
        case ParameterKind::kChoice:
          if (p.name == parameters::kShift.name && s.word != 0) program->reads |= kReadsShift;
          words.push_back(s.word);
          break;
        default:
          words.push_back(s.word);
      }
    }
    program->reads |= op.reads;
    program->instructions.push_back(instruction);
  }
  for (const int root : roots_) program->results.push_back(static_cast<uint16_t>(slot[root]));
  program->slots = static_cast<uint16_t>(slots.most());
  return program;
}

uint32_t ProgramReader::attribute(Program& program, const Step& step, const std::string& name) {
  using Kind = ProgramAttribute::Kind;
  const Kind kind = step.operation == Operation::kUv ? Kind::kUvs
                    : step.operation == Operation::kTangentUv || step.operation == Operation::kNormalMapTangent ||
                            step.operation == Operation::kVectorDisplacement
                        ? Kind::kTangents
                        : Kind::kNamed;
  const ProgramAttribute wanted{kind, name};
  const auto found = std::ranges::find(program.attributes, wanted);
  const auto index = static_cast<uint32_t>(found - program.attributes.begin());
  if (found == program.attributes.end()) {
    if (index == kMostAttributes)
      step.place.fail(fmt::format("the program reads more than {} attributes and UV sets", kMostAttributes),
                      "use fewer of them in one material");
    program.attributes.push_back(wanted);
  }
  return index;
}

}  // namespace wardmis
