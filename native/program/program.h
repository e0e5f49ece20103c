// SPDX-License-Identifier: GPL-3.0-or-later
// A checked program as plain data: a straight list of instructions over a small array of floats (slots).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "program/operation.h"

namespace wardmis {

inline constexpr size_t kMostOperations = 4096;
inline constexpr size_t kMostSlots = 512;         // floats alive at once
inline constexpr size_t kMostLiterals = 1 << 15;  // floats
inline constexpr size_t kMostTableNumbers = 1 << 18;
inline constexpr size_t kMostAttributes = 16;

// Where an argument's floats are: a slot, or, with this bit, among the literals.
inline constexpr uint16_t kLiteral = 1 << 15;

struct Instruction {
  Operation operation;
  uint16_t result;      // slot
  uint16_t arguments;   // the first of them in Program::arguments
  uint16_t parameters;  // the first word of them in Program::parameters
};

// What a program reads of the mesh, by name.
struct ProgramAttribute {
  enum class Kind : uint8_t { kUvs, kTangents, kNamed };
  Kind kind;
  std::string name;  // of a UV set, empty: the first one; of an attribute
  bool operator==(const ProgramAttribute&) const = default;
};

// One tile of a UDIM image.
struct ProgramTile {
  uint32_t number, texture;  // index into Program::textures
};

struct Program {
  std::vector<Instruction> instructions;
  std::vector<uint16_t> arguments;
  std::vector<float> literals;
  std::vector<uint32_t> parameters;  // words, as ParameterKind says
  std::vector<float> tables;
  std::vector<ProgramTile> tiles;  // sorted by number within each image
  std::vector<uint32_t> textures;  // the scene's, by the indices that instructions have
  std::vector<ProgramAttribute> attributes;
  std::vector<uint16_t> results;  // slots of the values that inputs refer to
  uint32_t reads = 0;             // Reads
  uint16_t slots = 0;
};

}  // namespace wardmis
