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

// The density integrates to one, and each cell is drawn as often as it says: within five standard errors, which for
// other seeds one of the 2048 cells passes once in 800 times.
TEST(Environment, CellsAreDrawnAsOftenAsTheirDensitySays) {
  constexpr int kWidth = 64, kHeight = 32, kDraws = 1 << 20;
  const Scene scene = skyOf(kWidth, Wrap::kRepeat, Wrap::kClamp);
  const Environment sky(scene, scene.worlds[0]);
  std::vector<int> drawn(kWidth * kHeight);
  std::vector<double> share(drawn.size());
  const auto cellOf = [&](Vec3f d) {
    const float* m = scene.worlds[0].matrix;
    const Vec3f f = scene.zUp ? Vec3f{d.x, -d.z, d.y} : d;
    const double x = double(m[0]) * f.x + double(m[1]) * f.y + double(m[2]) * f.z;
    const double y = double(m[3]) * f.x + double(m[4]) * f.y + double(m[5]) * f.z;
    const double z = double(m[6]) * f.x + double(m[7]) * f.y + double(m[8]) * f.z;
    const double u = 0.5 - std::atan2(y, x) / (2 * kPi<double>);
    const double v = 1 - std::atan2(std::hypot(x, y), z) / kPi<double>;
    const int i = std::min(static_cast<int>(u * kWidth), kWidth - 1),
              j = std::min(static_cast<int>(v * kHeight), kHeight - 1);
    return static_cast<size_t>(j) * kWidth + static_cast<size_t>(i);
  };
  Stream random(9, 0);
  for (int k = 0; k < kDraws; ++k) {
    const auto q = random.square();
    const Environment::Place place = sky.sample({q.x, static_cast<float>(q.y)});
    const size_t cell = cellOf(place.direction);
    ++drawn[cell];
    const size_t row = cell / kWidth;
    const double top = kPi<double> * (1 - double(row) / kHeight), bottom = top - kPi<double> / kHeight;
    share[cell] = double(sky.look(place).pdf) * 2 * kPi<double> / kWidth * (std::cos(bottom) - std::cos(top));
  }
  double sum = 0;
  int off = 0;
  for (size_t i = 0; i < share.size(); ++i) {
    sum += share[i];
    const double expected = share[i] * kDraws;
    off += std::abs(drawn[i] - expected) > 5 * std::sqrt(expected) + 1 ? 1 : 0;
  }
  EXPECT_NEAR(sum, 1, 1e-3);
  EXPECT_EQ(off, 0);
}

}  // namespace
}  // namespace wardmis
