// SPDX-License-Identifier: GPL-3.0-or-later
// Small fixed-size vectors and matrices over a number type T. No alignment, no padding: a Vec3<float> is glTF's VEC3.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace wardmis {

template <class T>
struct Vec2 {
  T x{}, y{};
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3 operator+(Vec3 b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr Vec3 operator-(Vec3 b) const { return {x - b.x, y - b.y, z - b.z}; }
  constexpr Vec3 operator*(Vec3 b) const { return {x * b.x, y * b.y, z * b.z}; }
  constexpr Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
  constexpr Vec3 operator/(T s) const { return *this * (T(1) / s); }
  constexpr Vec3 operator/(Vec3 o) const { return {x / o.x, y / o.y, z / o.z}; }
  constexpr Vec3 operator-() const { return {-x, -y, -z}; }
  constexpr Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  constexpr Vec3& operator*=(Vec3 b) { return *this = *this * b; }
  constexpr Vec3& operator*=(T s) { return *this = *this * s; }
  constexpr bool operator==(const Vec3&) const = default;
};
template <class T>
constexpr Vec3<T> operator*(T s, Vec3<T> v) {
  return v * s;
}

using Vec2f = Vec2<float>;
using Vec3f = Vec3<float>;
using Rgb = Vec3f;  // linear Rec. 709

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
T length(Vec3<T> v) {
  return std::sqrt(dot(v, v));
}
template <class T>
Vec3<T> normalize(Vec3<T> v) {
  return v / length(v);
}
template <class T>
constexpr T maxComponent(Vec3<T> v) {
  return std::max(v.x, std::max(v.y, v.z));
}
template <class T>
bool isFinite(Vec3<T> v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Component by component: the corners of a box around both.
constexpr Vec3f least(Vec3f a, Vec3f b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
constexpr Vec3f most(Vec3f a, Vec3f b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
constexpr Rgb notNegative(Rgb c) { return {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f)}; }
// The amounts of its colours, whatever their signs.
constexpr Rgb absolute(Rgb c) { return {c.x < 0 ? -c.x : c.x, c.y < 0 ? -c.y : c.y, c.z < 0 ? -c.z : c.z}; }

// Luminance of linear Rec. 709.
// Light may be negative, as in Blender: it is none where all of it is 0.
constexpr bool isBlack(Rgb c) { return c.x == 0 && c.y == 0 && c.z == 0; }
constexpr float luminance(Rgb c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
// What it weighs when emitters are chosen between.
constexpr float strength(Rgb c) { return luminance(absolute(c)); }

// Orthonormal basis whose z axis is n (a unit vector); x and y continuous except at n.z = 0 (Duff et al. 2017).
template <class T>
struct Frame {
  Vec3<T> x, y, z;

  static Frame around(Vec3<T> n) {
    const T sign = std::copysign(T(1), n.z);
    const T a = T(-1) / (sign + n.z);
    const T b = n.x * n.y * a;
    return {{T(1) + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
  }
  // Basis around n whose x axis is the part of `tangent` orthogonal to n; any basis where that vanishes (within
  // rounding: a thousandth of the tangent, whatever its length).
  static Frame around(Vec3<T> n, Vec3<T> tangent) {
    const Vec3<T> t = tangent - n * dot(n, tangent);
    const T l2 = dot(t, t);
    if (!(l2 > T(1e-6) * dot(tangent, tangent))) return around(n);
    const Vec3<T> tx = t / std::sqrt(l2);
    return {tx, cross(n, tx), n};
  }
  constexpr Vec3<T> toLocal(Vec3<T> v) const { return {dot(v, x), dot(v, y), dot(v, z)}; }
  constexpr Vec3<T> toWorld(Vec3<T> v) const { return x * v.x + y * v.y + z * v.z; }
};
using Framef = Frame<float>;

// Affine map p -> x p.x + y p.y + z p.z + t (columns as in glTF's and Embree's 3x4 column-major matrices).
struct Affine {
  Vec3f x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, t{0, 0, 0};

  constexpr Vec3f vector(Vec3f v) const { return x * v.x + y * v.y + z * v.z; }
  constexpr Vec3f point(Vec3f p) const { return vector(p) + t; }
  // A normal: by the cofactor matrix, so no division and right for mirrored transforms up to sign and length.
  constexpr Vec3f normal(Vec3f n) const { return cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z; }
  constexpr float determinant() const { return dot(x, cross(y, z)); }
  constexpr Affine operator*(const Affine& b) const { return {vector(b.x), vector(b.y), vector(b.z), point(b.t)}; }
  // Inverse of the linear part applied to v; the map must not be singular.
  constexpr Vec3f inverseVector(Vec3f v) const {
    const float inv = 1 / determinant();
    return {dot(cross(y, z), v) * inv, dot(cross(z, x), v) * inv, dot(cross(x, y), v) * inv};
  }
  constexpr bool operator==(const Affine&) const = default;
};

}  // namespace wardmis
