// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/spectrum.h"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace wardmis::spectrum {
namespace {

// Cycles' fit of black bodies' colours: red and green as a/t + b t + c, blue as a cubic, from each temperature on.
struct Fit {
  float from;
  float red[3], green[3], blue[4];
};
constexpr Fit kFits[] = {
    // clang-format off
    {800, {1.61919106e+03f, -2.05010916e-03f, 5.02995757e+00f}, {-4.88999748e+02f, 6.04330754e-04f, -7.55807526e-02f}, {5.96945309e-11f, -4.85742887e-08f, -9.70622247e-05f, -4.07936148e-03f}},
    {965, {2.48845471e+03f, -1.11330907e-03f, 3.22621544e+00f}, {-7.55994277e+02f, 3.16730098e-04f, 4.78306139e-01f}, {2.40430366e-11f, 5.55021075e-08f, -1.98503712e-04f, 2.89312858e-02f}},
    {1167, {3.34143193e+03f, -4.86551192e-04f, 1.76486769e+00f}, {-1.02363977e+03f, 1.20223470e-04f, 9.36662319e-01f}, {-1.40949732e-11f, 1.89878968e-07f, -3.56632824e-04f, 9.10767778e-02f}},
    {1449, {4.09461742e+03f, -1.27446582e-04f, 7.25731635e-01f}, {-1.26571316e+03f, 4.87340896e-06f, 1.27054498e+00f}, {-3.61460868e-11f, 2.84822009e-07f, -4.93211319e-04f, 1.56723440e-01f}},
    {1902, {4.67028036e+03f, 2.91258199e-05f, 1.26703442e-01f}, {-1.42529332e+03f, -4.01150431e-05f, 1.43972784e+00f}, {-1.97075738e-11f, 1.75359352e-07f, -2.50542825e-04f, -2.22783266e-02f}},
    {3315, {4.59509185e+03f, 2.87495649e-05f, 1.50345020e-01f}, {-1.17554822e+03f, -2.16378048e-05f, 1.30408023e+00f}, {-1.61997957e-13f, -1.64216008e-08f, 3.86216271e-04f, -7.38077418e-01f}},
    {6365, {3.78717450e+03f, 9.35907826e-06f, 3.99075871e-01f}, {-5.00799571e+02f, -4.59832026e-06f, 1.09098763e+00f}, {6.72650283e-13f, -2.73078809e-08f, 4.24098264e-04f, -7.52335691e-01f}},
    // clang-format on
};
constexpr float kColdest = 800, kHottest = 12000;
constexpr Rgb kCold{5.413294490189271f, -0.20319390035873933f, -0.0822535242887164f};
constexpr Rgb kHot{0.8262954810464208f, 0.9945080501520986f, 1.566307710274283f};

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

constexpr Rgb toRgb(Vec3f xyz) {
  return {3.2404542f * xyz.x - 1.5371385f * xyz.y - 0.4985314f * xyz.z,
          -0.9692660f * xyz.x + 1.8760108f * xyz.y + 0.0415560f * xyz.z,
          0.0556434f * xyz.x - 0.2040259f * xyz.y + 1.0572252f * xyz.z};
}
Rgb positive(Rgb c) { return {std::max(c.x, 0.0f), std::max(c.y, 0.0f), std::max(c.z, 0.0f)}; }

}  // namespace

Rgb blackbody(float t) {
  if (t >= kHottest) return positive(kHot);
  if (!(t >= kColdest)) return positive(kCold);
  const Fit* f = std::begin(kFits);
  while (f + 1 != std::end(kFits) && t >= f[1].from) ++f;
  const float inverse = 1 / t;
  return positive({f->red[0] * inverse + f->red[1] * t + f->red[2],
                   f->green[0] * inverse + f->green[1] * t + f->green[2],
                   ((f->blue[0] * t + f->blue[1]) * t + f->blue[2]) * t + f->blue[3]});
}

Rgb wavelength(float nm) {
  const float x = (nm - kFirst) / kStep;
  if (!(x > -1 && x < kSteps)) return {0, 0, 0};
  const int i = static_cast<int>(x);  // towards 0: what lies just below the first one is extrapolated, as in Cycles
  const float share = x - static_cast<float>(i);
  const auto at = [&](int k) {
    const float a = kMatching[k][i], b = kMatching[k][i + 1];
    return (a + share * (b - a)) / 10000;
  };
  constexpr float kBrightest = 2.52f;  // so that no part of any is above 1
  return positive(toRgb({at(0), at(1), at(2)}) * (1 / kBrightest));
}

}  // namespace wardmis::spectrum
