// SPDX-License-Identifier: GPL-3.0-or-later
// A material's inputs as plain data.
#pragma once

#include "math/vec.h"

namespace wardmis {

// One material input: a constant times, optionally, a value of the material's program, or a texture looked up at (a u +
// b v + c, d u + e v + f).
struct TextureUse {
  int texture = -1;  // -1: none
  int channel = 0;   // for scalars
  float transform[6] = {1, 0, 0, 0, 1, 0};
};
struct ColorInput {
  Rgb value{0, 0, 0};
  TextureUse texture;
  int result = -1;  // index into Program::results; -1: none
};
struct ScalarInput {
  float value = 0;
  TextureUse texture;
  int result = -1;
};

}  // namespace wardmis
