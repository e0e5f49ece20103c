// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/spectrum.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "math/rec709.h"

namespace wardmis::spectrum {
namespace {

constexpr double kColdest = 800, kHottest = 12000;  // K: beyond, the colour stays as it is, as in Cycles
constexpr double kSecondRadiation = 1.438777e7;     // nm K

// The CIE's colour matching functions of 1931, at 380, 385 ... 780 nm, times 10000.
constexpr float kFirst = 380, kStep = 5;
constexpr int kSteps = 80;
constexpr uint16_t kMatching[3][kSteps + 1] = {
    {14,   22,   42,   76,   143,  232,  435,  776,  1344,  2148,  2839,  3285,  3483,  3481, 3362, 3187, 2908,
     2511, 1954, 1421, 956,  580,  320,  147,  49,   24,    93,    291,   633,   1096,  1655, 2257, 2904, 3597,
     4334, 5121, 5945, 6784, 7621, 8425, 9163, 9786, 10263, 10567, 10622, 10456, 10026, 9384, 8544, 7514, 6424,
     5419, 4479, 3608, 2835, 2187, 1649, 1212, 874,  636,   468,   329,   227,   158,   114,  81,   58,   41,
     29,   20,   14,   10,   7,    5,    3,    2,    2,     1,     1,     1,     0},
    {0,    1,     1,    2,    4,    6,    12,   22,   40,   73,   116,  168,  230,  298,  380,  480,  600,
     739,  910,   1126, 1390, 1693, 2080, 2586, 3230, 4073, 5030, 6082, 7100, 7932, 8620, 9149, 9540, 9803,
     9950, 10000, 9950, 9786, 9520, 9154, 8700, 8163, 7570, 6949, 6310, 5668, 5030, 4412, 3810, 3210, 2650,
     2170, 1750,  1382, 1070, 816,  610,  446,  320,  232,  170,  119,  82,   57,   41,   29,   21,   15,
     10,   7,     5,    4,    2,    2,    1,    1,    1,    0,    0,    0,    0},
    {65,    105,   201,   362,  679,  1102, 2074, 3713, 6456, 10391, 13856, 16230, 17471, 17826, 17721, 17441, 16692,
     15281, 12876, 10419, 8130, 6162, 4652, 3533, 2720, 2123, 1582,  1117,  782,   573,   422,   298,   203,   134,
     87,    57,    39,    27,   21,   18,   17,   14,   11,   10,    8,     6,     3,     2,     2,     1,     0,
     0,     0,     0,     0,    0,    0,    0,    0,    0,    0,     0,     0,     0,     0,     0,     0,     0,
     0,     0,     0,     0,    0,    0,    0,    0,    0,    0,     0,     0,     0},
};

// Planck's law times the observer's functions: xyz with y 1.
Vec3f blackbodyAt(double inverse) {
  double xyz[3] = {};
  for (int i = 0; i <= kSteps; ++i) {
    const double nm = double(kFirst) + double(kStep) * i;
    const double radiance = std::pow(nm / 555, -5) / std::expm1(kSecondRadiation * inverse / nm);
    for (int k = 0; k < 3; ++k) xyz[k] += kMatching[k][i] * radiance;
  }
  const auto share = [&](int k) { return static_cast<float>(xyz[k] / xyz[1]); };
  return {share(0), 1, share(2)};
}

}  // namespace

// By a table over 1/t, whose steps are so fine that its lines are within 1e-5.
Rgb blackbody(float t, uint32_t version) {
  constexpr int kEntries = 1024;
  constexpr double kLow = 1 / kHottest, kStepOfInverse = (1 / kColdest - kLow) / (kEntries - 1);
  static const std::array<Vec3f, kEntries> table = [] {
    std::array<Vec3f, kEntries> colors;
    for (int i = 0; i < kEntries; ++i) colors[static_cast<size_t>(i)] = blackbodyAt(kLow + i * kStepOfInverse);
    return colors;
  }();
  const double kelvin = t > kColdest ? std::min(double(t), kHottest) : kColdest;  // also what is no number
  const double x = std::clamp((1 / kelvin - kLow) / kStepOfInverse, 0.0, kEntries - 1.0);
  const auto i = std::min(static_cast<size_t>(x), size_t{kEntries - 2});
  const auto share = static_cast<float>(x - static_cast<double>(i));
  return notNegative(rec709::fromXyz(table[i] * (1 - share) + table[i + 1] * share, version));
}

Rgb wavelength(float nm, uint32_t version) {
  const float x = (nm - kFirst) / kStep;
  if (!(x > -1 && x < kSteps)) return {0, 0, 0};
  const int i = static_cast<int>(x);  // towards 0: what lies just below the first one is extrapolated, as in Cycles
  const float share = x - static_cast<float>(i);
  const auto at = [&](int k) {
    const float a = kMatching[k][i], b = kMatching[k][i + 1];
    return (a + share * (b - a)) / 10000;
  };
  constexpr float kBrightest = 2.52f;  // so that no part of any is above 1
  return notNegative(rec709::fromXyz({at(0), at(1), at(2)}, version) * (1 / kBrightest));
}

}  // namespace wardmis::spectrum
