// SPDX-License-Identifier: GPL-3.0-or-later
// Elementary functions over the number type T, branch-free, so that a plain loop over floats vectorises.
// float: polynomials of our own (error below 2 ulp for exp and log, 2e-7 absolute for sincos, 3e-7 relative for atan2;
// shown by tests/native/math). double and long double: the standard library.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace wardmis {

template <class T>
inline constexpr T kPi = T(3.14159265358979323846264338327950288L);

template <class T>
constexpr T select(bool mask, T a, T b) {
  return mask ? a : b;
}
template <class T>
constexpr T square(T x) {
  return x * x;
}

// sin and cos of an angle in degrees, accurate also near 90.
inline double sinDegrees(double d) {
  const double unit = kPi<double> / 180;
  return d > 45 ? std::cos((90 - d) * unit) : std::sin(d * unit);
}
inline double cosDegrees(double d) {
  const double unit = kPi<double> / 180;
  return d > 45 ? std::sin((90 - d) * unit) : std::cos(d * unit);
}

// e^x; +-infinity are fine. float: 0 in place of a denormal result. Some processors take hundreds of cycles to make and
// to use one, and one in two hundred directions was enough to halve the pace of a vector loop.
template <class T>
inline T exp(T x) {
  return std::exp(x);
}
template <>
inline float exp<float>(float x) {
  const float lo = -87.3365402f, hi = 88.7228317f;  // e^lo is the least normal float, e^hi the largest
  const float c = x < lo ? lo : x;
  const float y = c > hi ? hi : c;
  const float magic = 12582912.0f;  // 1.5 * 2^23: adding it rounds to the nearest integer
  const float n = (y * 1.44269504f + magic) - magic;
  const float r = (y - n * 0.693359375f) + n * 2.12194440e-4f;  // Cody and Waite
  float p = 1.9875691500e-4f;                                   // minimax on [-ln2/2, ln2/2]
  p = p * r + 1.3981999507e-3f;
  p = p * r + 8.3334519073e-3f;
  p = p * r + 4.1665795894e-2f;
  p = p * r + 1.6666665459e-1f;
  p = p * r + 5.0000001201e-1f;
  p = p * r * r + r + 1.0f;
  const int i = static_cast<int>(n);
  const int half = i >> 1;  // in two steps, so that the largest results are reached
  const float s1 = std::bit_cast<float>((half + 127) << 23);
  const float s2 = std::bit_cast<float>((i - half + 127) << 23);
  return p * s1 * (x < lo ? 0.0f : s2);
}

// ln x for normal x > 0 (float); the standard library's domain otherwise.
template <class T>
inline T log(T x) {
  return std::log(x);
}
template <>
inline float log<float>(float x) {
  const uint32_t bits = std::bit_cast<uint32_t>(x);
  // mantissa in [sqrt(1/2), sqrt(2))
  const uint32_t shifted = bits - 0x3f3504f3u;
  const int e = static_cast<int>(shifted) >> 23;
  const float m = std::bit_cast<float>((shifted & 0x007fffffu) + 0x3f3504f3u) - 1.0f;
  const float n = static_cast<float>(e);
  float p = 7.0376836292e-2f;
  p = p * m - 1.1514610310e-1f;
  p = p * m + 1.1676998740e-1f;
  p = p * m - 1.2420140846e-1f;
  p = p * m + 1.4249322787e-1f;
  p = p * m - 1.6668057665e-1f;
  p = p * m + 2.0000714765e-1f;
  p = p * m - 2.4999993993e-1f;
  p = p * m + 3.3333331174e-1f;
  const float m2 = m * m;
  const float tail = p * m2 * m - 2.12194440e-4f * n - 0.5f * m2;
  return (m + tail) + 0.693359375f * n;
}

// -ln(1 - u) for u in [0, 1): the squared radius of a Gaussian slope. In float 1 - u is exact for u = k 2^-24.
template <class T>
inline T minusLog1m(T u) {
  return -std::log1p(-u);
}
template <>
inline float minusLog1m<float>(float u) {
  return -log(1.0f - u);
}

// sin and cos of 2 pi u for u in [0, 1].
template <class T>
inline void sincos2Pi(T u, T& s, T& c) {
  s = std::sin(2 * kPi<T> * u);
  c = std::cos(2 * kPi<T> * u);
}
template <>
inline void sincos2Pi<float>(float u, float& s, float& c) {
  const float magic = 12582912.0f;
  const float q = (u * 4.0f + magic) - magic;  // quadrant 0..4
  const float t = (u - 0.25f * q) * (2 * kPi<float>);
  const float t2 = t * t;
  const float sp = t + t * t2 * (-1.6666654611e-1f + t2 * (8.3321608736e-3f - t2 * 1.9515295891e-4f));
  const float cp =
      1.0f - 0.5f * t2 + t2 * t2 * (4.166664568298827e-2f + t2 * (-1.388731625493765e-3f + t2 * 2.443315711809948e-5f));
  const int i = static_cast<int>(q);
  const bool swap = (i & 1) != 0;
  const float ss = swap ? cp : sp;
  const float cc = swap ? sp : cp;
  s = (i & 2) != 0 ? -ss : ss;
  c = ((i + 1) & 2) != 0 ? -cc : cc;
}

// The angle of (x, y) in [-pi, pi], 0 for (0, 0).
template <class T>
inline T atan2(T y, T x) {
  return std::atan2(y, x);
}
template <>
inline float atan2<float>(float y, float x) {
  const float ax = std::fabs(x), ay = std::fabs(y);
  const bool steep = ay > ax;
  const float lesser = steep ? ax : ay, greater = steep ? ay : ax;
  const float t = lesser / (greater > 0 ? greater : 1.0f);
  // minimax of atan t / t on [0, 1], in pairs, which do not wait for each other
  const float z = t * t, z2 = z * z, z4 = z2 * z2;
  const float low = (9.9999998477e-1f - 3.3333073345e-1f * z) + z2 * (1.9992619393e-1f - 1.4203644476e-1f * z);
  const float high = (1.0640934062e-1f - 7.5042946173e-2f * z) + z2 * (4.2691520193e-2f - 1.6068629524e-2f * z);
  const float angle = t * (low + z4 * (high + z4 * 2.8498897611e-3f));
  const float upper = steep ? 0.5f * kPi<float> - angle : angle;
  return std::copysign(std::signbit(x) ? kPi<float> - upper : upper, y);
}

}  // namespace wardmis
