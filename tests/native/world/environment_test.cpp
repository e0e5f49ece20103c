// SPDX-License-Identifier: GPL-3.0-or-later
// Skies that are images: what is looked up is what the texture and the table say, however it is stored.
#include "world/environment.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/warp.h"

namespace wardmis {
namespace {

// Of 3 x 2 to 64 x 32 texels, turned, some of them hundreds of times as bright as others.
Scene skyOf(int width, Wrap u, Wrap v) {
  Scene scene;
  Image& image = scene.images.emplace_back();
  image.width = width, image.height = (width + 1) / 2, image.channels = 3;
  Stream random(7, static_cast<uint64_t>(width));
  for (int i = 0; i < 3 * width * image.height; ++i)
    image.floats.push_back(static_cast<float>(std::exp(5 * random.uniform())));
  scene.textures.push_back({0, u, v, Filter::kLinear});
  World& world = scene.worlds.emplace_back();
  world.texture = 0;
  world.radiance = {0.5f, 1, 2};
  const float c = std::cos(0.4f), s = std::sin(0.4f), turned[9] = {c, 0, s, 0, 1, 0, -s, 0, c};
  std::copy_n(turned, 9, world.matrix);
  return scene;
}

TEST(Environment, ALookIsWhatTheTextureSays) {
  for (const int width : {3, 5, 64})
    for (const Wrap u : {Wrap::kRepeat, Wrap::kMirror, Wrap::kClamp})
      for (const Wrap v : {Wrap::kRepeat, Wrap::kClamp, Wrap::kClip}) {
        const Scene scene = skyOf(width, u, v);
        const Environment sky(scene, scene.worlds[0]);
        Stream random(3, 0);
        for (int k = 0; k < 1000; ++k) {
          const auto q = random.square();
          const Vec3f d = toCone(Vec2f{static_cast<float>(q.x), static_cast<float>(q.y)}, 2.0f);
          const Rgb seen = sky.look(d).radiance, texture = sky.radiance(d);
          EXPECT_EQ(seen.x, texture.x);
          EXPECT_EQ(seen.y, texture.y);
          EXPECT_EQ(seen.z, texture.z);
        }
      }
}

// Of a drawn place what is known from the draw, and of its direction what is found there; rounding may take a direction
// over the border of a cell or a texel: of one sample in 500 at most.
TEST(Environment, ADrawAndItsDirectionAgree) {
  for (const int width : {3, 8, 64}) {
    const Scene scene = skyOf(width, Wrap::kRepeat, Wrap::kClamp);
    const Environment sky(scene, scene.worlds[0]);
    Stream random(5, 0);
    int off = 0;
    for (int k = 0; k < 5000; ++k) {
      const auto q = random.square();
      const Environment::Place place = sky.sample({q.x, static_cast<float>(q.y)});
      const Environment::Look drawn = sky.look(place), found = sky.look(place.direction);
      const bool agree = std::abs(drawn.pdf / found.pdf - 1) < 1e-4f &&
                         std::abs(luminance(drawn.radiance) / luminance(found.radiance) - 1) < 1e-2f;
      off += agree ? 0 : 1;
    }
    EXPECT_LE(off, 10) << width;
  }
}

// u and v of a direction in the image, in double.
Vec2<double> uvOf(const Scene& scene, Vec3f d) {
  const float* m = scene.worlds[0].matrix;
  const Vec3f f = scene.zUp ? Vec3f{d.x, -d.z, d.y} : d;
  const double x = double(m[0]) * f.x + double(m[1]) * f.y + double(m[2]) * f.z;
  const double y = double(m[3]) * f.x + double(m[4]) * f.y + double(m[5]) * f.z;
  const double z = double(m[6]) * f.x + double(m[7]) * f.y + double(m[8]) * f.z;
  return {0.5 - std::atan2(y, x) / (2 * kPi<double>), 1 - std::atan2(std::hypot(x, y), z) / kPi<double>};
}
Vec3f directionOf(const Scene& scene, double u, double v) {
  const double phi = 2 * kPi<double> * (0.5 - u), r = std::sin(kPi<double> * v);
  const Vec3f d{static_cast<float>(r * std::cos(phi)), static_cast<float>(r * std::sin(phi)),
                static_cast<float>(-std::cos(kPi<double> * v))};
  const float* m = scene.worlds[0].matrix;  // a rotation
  const Vec3f z{m[0] * d.x + m[3] * d.y + m[6] * d.z, m[1] * d.x + m[4] * d.y + m[7] * d.z,
                m[2] * d.x + m[5] * d.y + m[8] * d.z};
  return scene.zUp ? Vec3f{z.x, z.z, -z.y} : z;
}

// The density integrates to one, and each part of a grid that is finer than the image is drawn as often as it says:
// within five standard errors, which for other seeds one of the 8192 parts passes once in 200 times. Of images that are
// drawn as they are filtered, and of others, whose filter is wider or whose edge does not go on at the other.
TEST(Environment, PartsAreDrawnAsOftenAsTheirDensitySays) {
  constexpr int kColumns = 128, kRows = 64, kDraws = 1 << 20, kPoints = 8;
  for (const bool cubic : {false, true})
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp}) {
      Scene scene = skyOf(64, wrap, wrap);
      if (cubic) scene.textures[0].filter = Filter::kCubic;
      const Environment sky(scene, scene.worlds[0]);
      std::vector<int> drawn(kColumns * kRows);
      Stream random(9, 0);
      for (int k = 0; k < kDraws; ++k) {
        const auto q = random.square();
        const Vec2<double> uv = uvOf(scene, sky.sample({q.x, static_cast<float>(q.y)}).direction);
        const int i = std::min(static_cast<int>(uv.x * kColumns), kColumns - 1),
                  j = std::min(static_cast<int>(uv.y * kRows), kRows - 1);
        ++drawn[static_cast<size_t>(j * kColumns + i)];
      }
      double sum = 0;
      int off = 0;
      for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kColumns; ++i) {
          double share = 0;
          for (int b = 0; b < kPoints; ++b)
            for (int a = 0; a < kPoints; ++a) {
              const double u = (i + (a + 0.5) / kPoints) / kColumns, v = (j + (b + 0.5) / kPoints) / kRows;
              share += double(sky.look(directionOf(scene, u, v)).pdf) * std::sin(kPi<double> * v);
            }
          share *= 2 * kPi<double> * kPi<double> / (kColumns * kRows * kPoints * kPoints);
          sum += share;
          const double expected = share * kDraws;
          off +=
              std::abs(drawn[static_cast<size_t>(j * kColumns + i)] - expected) > 5 * std::sqrt(expected) + 1 ? 1 : 0;
        }
      EXPECT_NEAR(sum, 1, 1e-3);
      EXPECT_EQ(off, 0) << cubic;
    }
}

// An image is drawn as it is filtered, so that radiance over density is one number but for the sine of the polar angle
// within a row: a table of a number for each texel made that of a sun's edge vary from 0 to 4.
TEST(Environment, AnImageIsDrawnAsItIsFiltered) {
  Scene scene = skyOf(64, Wrap::kRepeat, Wrap::kClamp);
  scene.worlds[0].radiance = {1, 1, 1};
  Image& image = scene.images[0];
  for (size_t i = 0; i < image.floats.size(); ++i)  // grey, with a sun
    image.floats[i] = i / 3 / 64 > 18 && i / 3 / 64 < 22 && i / 3 % 64 > 40 && i / 3 % 64 < 44 ? 1000.0f : 1.0f;
  const Environment sky(scene, scene.worlds[0]);
  Stream random(4, 0);
  double sum = 0, squares = 0;
  constexpr int kDraws = 10000;
  for (int k = 0; k < kDraws; ++k) {
    const auto q = random.square();
    const Environment::Look look = sky.look(sky.sample({q.x, static_cast<float>(q.y)}));
    const double ratio = double(look.radiance.x) / double(look.pdf);
    sum += ratio, squares += ratio * ratio;
  }
  const double mean = sum / kDraws;
  EXPECT_NEAR(mean / double(sky.integral()), 1, 1e-2);
  EXPECT_LT(squares / kDraws / (mean * mean) - 1, 5e-3);
}

}  // namespace
}  // namespace wardmis
