// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/texture.h"

#include <gtest/gtest.h>

#include <limits>

namespace wardmis {
namespace {

// 2 x 2, grey: 0 1 in the bottom row, 2 3 in the top row.
Image ramp() { return {"ramp", 2, 2, 1, false, {}, {0, 1, 2, 3}}; }

TEST(Texture, InterpolatesBetweenTexelCentres) {
  const Image image = ramp();
  const Texture clamp{0, Wrap::kClamp, Wrap::kClamp, Filter::kLinear};
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {0.25f, 0.25f}, 0), 0);
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {0.75f, 0.25f}, 0), 1);
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {0.25f, 0.75f}, 0), 2);
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {0.5f, 0.5f}, 0), 1.5f);
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {-9, 9}, 0), 2);
  EXPECT_FLOAT_EQ(lookUpScalar(image, clamp, {9, -9}, 0), 1);
}

TEST(Texture, Wraps) {
  const Image image = ramp();
  const Texture repeat{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear};
  EXPECT_FLOAT_EQ(lookUpScalar(image, repeat, {0, 0.25f}, 0), 0.5f);  // half of the last, half of the first
  EXPECT_FLOAT_EQ(lookUpScalar(image, repeat, {-0.25f, 0.25f}, 0), 1);
  EXPECT_FLOAT_EQ(lookUpScalar(image, repeat, {7.75f, -2.25f}, 0), 3);
  const Texture mirror{0, Wrap::kMirror, Wrap::kMirror, Filter::kLinear};
  EXPECT_FLOAT_EQ(lookUpScalar(image, mirror, {-0.25f, 0.25f}, 0), 0);
  EXPECT_FLOAT_EQ(lookUpScalar(image, mirror, {1.25f, 0.25f}, 0), 1);
  EXPECT_FLOAT_EQ(lookUpScalar(image, mirror, {1.75f, 2.75f}, 0), 2);
}

TEST(Texture, TakesTheNearestTexel) {
  const Image image = ramp();
  for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror}) {
    const Texture nearest{0, wrap, wrap, Filter::kNearest};
    EXPECT_EQ(lookUpScalar(image, nearest, {0.49f, 0.49f}, 0), 0);
    EXPECT_EQ(lookUpScalar(image, nearest, {0.51f, 0.49f}, 0), 1);
    EXPECT_EQ(lookUpScalar(image, nearest, {0.99f, 0.99f}, 0), 3);
  }
}

TEST(Texture, DecodesBytes) {
  Image image{"", 1, 1, 4, true, {0, 128, 255, 128}, {}};
  const Texture texture{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear};
  const Rgb c = lookUpRgb(image, texture, {0.3f, 0.6f});
  EXPECT_FLOAT_EQ(c.x, 0);
  EXPECT_NEAR(c.y, 0.2158605f, 1e-6f);  // IEC 61966-2-1 of 128 / 255
  EXPECT_FLOAT_EQ(c.z, 1);
  EXPECT_NEAR(lookUpScalar(image, texture, {0, 0}, 1), 0.2158605f, 1e-6f);
  EXPECT_NEAR(lookUpScalar(image, texture, {0, 0}, 3), 128 / 255.0f, 1e-6f);  // alpha is never sRGB
  image.srgb = false;
  EXPECT_NEAR(lookUpRgb(image, texture, {0, 0}).y, 128 / 255.0f, 1e-6f);
  for (int i = 0; i < 256; i++) EXPECT_NEAR(linearToSrgb(kByteToLinear[1][i]) * 255, i, 1e-3);
}

TEST(Texture, GreyStandsForAllColours) {
  const Texture texture{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kLinear};
  const Image grey{"", 1, 1, 2, false, {}, {0.25f, 0.5f}};
  EXPECT_EQ(lookUpRgb(grey, texture, {0, 0}), (Rgb{0.25f, 0.25f, 0.25f}));
}

TEST(Texture, CubicIsABSpline) {
  // at the centre of a texel 1/6, 4/6, 1/6; half way between two 1/48, 23/48, 23/48, 1/48
  const Image step{"", 4, 1, 1, false, {}, {0, 6, 0, 0}};
  const Texture cubic{0, Wrap::kRepeat, Wrap::kRepeat, Filter::kCubic};
  EXPECT_NEAR(lookUpScalar(step, cubic, {1.5f / 4, 0.5f}, 0), 4, 1e-5f);
  EXPECT_NEAR(lookUpScalar(step, cubic, {2.5f / 4, 0.5f}, 0), 1, 1e-5f);
  EXPECT_NEAR(lookUpScalar(step, cubic, {2 / 4.0f, 0.5f}, 0), 6 * 23 / 48.0f, 1e-5f);
  EXPECT_NEAR(lookUpScalar(step, cubic, {0, 0.5f}, 0), 6 / 48.0f, 1e-5f);  // of the four about 0 the last one: 1
  const Texture clamp{0, Wrap::kClamp, Wrap::kClamp, Filter::kCubic};
  const Image edge{"", 2, 1, 1, false, {}, {48, 0}};
  EXPECT_NEAR(lookUpScalar(edge, clamp, {0, 0.5f}, 0), 47, 1e-4f);   // of the four about 0 one is the second
  EXPECT_NEAR(lookUpScalar(edge, clamp, {-1, 0.5f}, 0), 48, 1e-4f);  // further out none
  const Texture mirror{0, Wrap::kMirror, Wrap::kMirror, Filter::kCubic};
  EXPECT_NEAR(lookUpScalar(step, mirror, {0, 0.5f}, 0), 2 * 6 / 48.0f, 1e-5f);  // 1 0 | 0 1
}

TEST(Texture, ClipsToNothing) {
  const Image image{"", 2, 1, 1, false, {}, {4, 8}};
  for (const Filter filter : {Filter::kLinear, Filter::kNearest, Filter::kCubic}) {
    const Texture clip{0, Wrap::kClip, Wrap::kClip, filter};
    for (const float u : {-1.5f, 2.5f, 1e30f, -1e30f}) EXPECT_EQ(lookUpScalar(image, clip, {u, 0.5f}, 0), 0);
  }
  const Texture linear{0, Wrap::kClip, Wrap::kClip, Filter::kLinear};
  EXPECT_FLOAT_EQ(lookUpScalar(image, linear, {0, 0.5f}, 0), 2);       // half of nothing
  EXPECT_FLOAT_EQ(lookUpScalar(image, linear, {1.125f, 0.5f}, 0), 2);  // a quarter of the last
  const Texture nearest{0, Wrap::kClip, Wrap::kClip, Filter::kNearest};
  EXPECT_FLOAT_EQ(lookUpScalar(image, nearest, {0.99f, 0.5f}, 0), 8);
  EXPECT_FLOAT_EQ(lookUpScalar(image, nearest, {-0.01f, 0.5f}, 0), 0);
}

TEST(Texture, FiltersEncodedAndDecodesAfter) {
  const Texture linear{0, Wrap::kClamp, Wrap::kClamp, Filter::kLinear};
  const Image bytes{"", 2, 1, 4, true, {0, 51, 255, 0, 255, 204, 255, 255}, {}, true};
  const Rgb c = lookUpRgb(bytes, linear, {0.5f, 0.5f});
  EXPECT_NEAR(c.x, srgbToLinear(0.5f), 1e-6f);
  EXPECT_NEAR(c.y, srgbToLinear(0.5f), 1e-6f);
  EXPECT_FLOAT_EQ(c.z, 1);
  EXPECT_NEAR(lookUpScalar(bytes, linear, {0.5f, 0.5f}, 1), srgbToLinear(0.5f), 1e-6f);
  EXPECT_FLOAT_EQ(lookUpScalar(bytes, linear, {0.5f, 0.5f}, 3), 0.5f);  // alpha is never sRGB
  EXPECT_NEAR(texelRgb(bytes, 0).y, srgbToLinear(0.2f), 1e-6f);
  const Image floats{"", 2, 1, 1, true, {}, {-0.2f, 3}, true};  // beyond [0, 1], too
  EXPECT_NEAR(lookUpScalar(floats, linear, {0.5f, 0.5f}, 0), srgbToLinear(1.4f), 1e-5f);
  EXPECT_EQ(texelRgb(floats, 0).x, 0);  // as in Cycles
  for (int i = 0; i <= 1000; i++) EXPECT_NEAR(decodeFiltered(i / 1000.0f), srgbToLinear(i / 1000.0f), 5e-7f);
}

TEST(Texture, IsDefinedEverywhere) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  const float kStrange[] = {kNan,          kInfinity,      -kInfinity,  3e38f, -3e38f, 1e-45f,     -1e-45f,
                            2147483648.0f, -2147483648.0f, 0.99999994f, 1,     -0.0f,  16777216.0f};
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(2, 2), std::pair(3, 1), std::pair(65536, 1)}) {
    const Image image{"", width, height, 1, false, {}, Texels<float>(size_t(width) * height, 0.5f)};
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror})
      for (const Filter filter : {Filter::kLinear, Filter::kNearest, Filter::kCubic})
        for (const float u : kStrange)
          for (const float v : kStrange)
            EXPECT_FLOAT_EQ(lookUpScalar(image, {0, wrap, wrap, filter}, {u, v}, 0), 0.5f) << u << ' ' << v;
  }
}

}  // namespace
}  // namespace wardmis
