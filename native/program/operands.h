// SPDX-License-Identifier: GPL-3.0-or-later
// What the interpreter gives an operation.
#pragma once

#include <bit>
#include <span>

#include "program/color.h"
#include "program/image_look_up.h"
#include "program/program.h"

namespace wardmis {

// One instruction's arguments and parameters, by their positions in the table of operations.
struct Operands {
  const float* base[2];  // slots, literals
  const uint16_t* in;
  const uint32_t* words;
  float* out;
  const Program& program;

  const float* at(int i) const { return base[in[i] >> 15] + (in[i] & (kLiteral - 1)); }
  float n(int i) const { return *at(i); }
  Vec3f v(int i) const {
    const float* p = at(i);
    return {p[0], p[1], p[2]};
  }
  void set(float v) const { *out = v; }
  void set(Vec3f v) const { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

  uint32_t word(int i) const { return words[i]; }
  bool flag(int i) const { return words[i] != 0; }
  float number(int i) const { return std::bit_cast<float>(words[i]); }
  const float* table(int i) const { return program.tables.data() + words[i]; }

  // Factors of mixes are clamped, or not.
  float factor(bool clamped) const { return clamped ? arithmetic::saturate(n(0)) : n(0); }
  // A blend of Mix, f(factor, a, b), by component or of whole colours.
  template <class F>
  Rgb blendEach(F f) const {
    const float t = factor(flag(0));
    return limited(each([&](float a, float b) { return f(t, a, b); }, v(1), v(2)));
  }
  template <class F>
  Rgb blend(F f) const {
    return limited(f(factor(flag(0)), v(1), v(2)));
  }
  Rgb limited(Rgb c) const { return flag(1) ? each(arithmetic::saturate, c) : c; }

  Vec3f mixEach() const {
    const bool clamped = flag(0);
    return each(
        [=](float t, float a, float b) {
          const float s = clamped ? arithmetic::saturate(t) : t;
          return a * (1 - s) + b * s;
        },
        v(0), v(1), v(2));
  }

  template <arithmetic::Steps S>
  float mapRange(float steps) const {
    return arithmetic::mapRange<S>(n(0), n(1), n(2), n(3), n(4), steps, flag(0));
  }
  template <arithmetic::Steps S>
  Vec3f mapRangeOfVector(Vec3f steps) const {
    const Vec3f a = v(0), from = v(1), to = v(2), least = v(3), most = v(4);
    const auto f = arithmetic::mapRangeOfVector<S>;
    return {f(a.x, from.x, to.x, least.x, most.x, steps.x, flag(0)),
            f(a.y, from.y, to.y, least.y, most.y, steps.y, flag(0)),
            f(a.z, from.z, to.z, least.z, most.z, steps.z, flag(0))};
  }

  float ramp(int column) const { return color::lookUp(table(0) + column, word(1), 4, n(0), flag(2), false); }
  // p of a curve's argument, and the curve's value there mixed with the argument.
  float curve(float a, int column, uint32_t columns) const {
    const float p = (a - number(2)) / (number(3) - number(2)), t = n(0);
    return (1 - t) * a + t * color::lookUp(table(0) + column, word(1), columns, p, true, flag(4));
  }

  images::ImageUse image() const {
    const uint32_t* list = program.textures.data();
    if (word(1) == 0) return {word(0), {}, flag(2), list};
    return {0, std::span(program.tiles).subspan(word(0), word(1)), flag(2), list};
  }
};

}  // namespace wardmis
