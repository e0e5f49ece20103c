// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors: rotations, and what the nodes Vector Math, Vector Rotate and Mapping do to them.
#pragma once

#include "program/arithmetic.h"

namespace wardmis::vectors {

inline Vec3f project(Vec3f a, Vec3f b) {
  const float l2 = dot(b, b);
  return l2 != 0 ? b * (dot(a, b) / l2) : Vec3f{0, 0, 0};
}
inline Vec3f reflect(Vec3f a, Vec3f b) {
  const Vec3f n = safeNormalize(b);
  return a - n * (2 * dot(a, n));
}
inline Vec3f refract(Vec3f a, Vec3f b, float eta) {
  const Vec3f n = safeNormalize(b);
  const float c = dot(n, a), k = 1 - eta * eta * (1 - c * c);
  return k < 0 ? Vec3f{0, 0, 0} : a * eta - n * (eta * c + std::sqrt(k));
}

// Rotation about x, then y, then z, by columns.
inline Affine euler(Vec3f angles) {
  const float sx = std::sin(angles.x), cx = std::cos(angles.x), sy = std::sin(angles.y), cy = std::cos(angles.y),
              sz = std::sin(angles.z), cz = std::cos(angles.z);
  return {{cy * cz, cy * sz, -sy},
          {sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy},
          {cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy},
          {0, 0, 0}};
}
inline Vec3f transposed(const Affine& m, Vec3f v) { return {dot(m.x, v), dot(m.y, v), dot(m.z, v)}; }

inline Vec3f rotate(Vec3f v, Vec3f center, Vec3f axis, float angle) {
  const float l = length(axis);
  if (l == 0) return v;
  const Vec3f n = axis / l, p = v - center;
  const float c = std::cos(angle), s = std::sin(angle);
  return p * c + cross(n, p) * s + n * (dot(n, p) * (1 - c)) + center;
}
inline Vec3f rotateEuler(Vec3f v, Vec3f center, Vec3f angles, bool invert) {
  const Affine m = euler(angles);
  return (invert ? transposed(m, v - center) : m.vector(v - center)) + center;
}

inline Vec3f map(const float* m, Vec3f v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z + m[3], m[4] * v.x + m[5] * v.y + m[6] * v.z + m[7],
          m[8] * v.x + m[9] * v.y + m[10] * v.z + m[11]};
}
inline Vec3f mapTexture(Vec3f v, Vec3f location, Vec3f angles, Vec3f scale) {
  return each(arithmetic::divide, transposed(euler(angles), v - location), scale);
}

// The inverse of an affine map that has one, at a point; vectors by Affine::inverseVector.
inline Vec3f inversePoint(const Affine& m, Vec3f p) { return m.inverseVector(p - m.t); }

}  // namespace wardmis::vectors
