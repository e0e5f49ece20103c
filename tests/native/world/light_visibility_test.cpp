// SPDX-License-Identifier: GPL-3.0-or-later
// What a pilot learns of hidden lights.
#include "world/light_visibility.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace wardmis {
namespace {

// An eye at the origin, which sees 64 cells a radian.
LightVisibility visibility(Projection projection = Projection::kPerspective) {
  Camera camera;
  camera.projection = projection;
  camera.left = -0.5f, camera.right = 0.5f;
  Film film;
  film.width = film.height = 4096;
  return {camera, film};
}

constexpr Vec3f kHere{3.01f, 0.01f, 0.01f}, kThere{0.01f, 3.01f, 0.01f}, kUp{0, 0, 1};

TEST(LightVisibility, KnowsWhatIsHiddenWhere) {
  LightVisibility v = visibility();
  for (int i = 0; i < 100; ++i) v.note(kHere, kUp, 0, false), v.note(kHere, kUp, 1, true);
  for (int i = 0; i < 9; ++i) v.note(kThere, kUp, 0, i < 4);
  // half of the samples are seen, and with one in 21 of those of the hidden light nearly all; there a light alone
  const double one = 200 * 0.25, other = 9 * (4 / 9.0 - 16 / 81.0);
  EXPECT_NEAR(v.learn(), (200 * (0.525 * 0.5 - 0.25) + other) / (one + other), 1e-6);
  EXPECT_FLOAT_EQ(v.at(kHere, kUp)[0], 0.05f);
  EXPECT_FLOAT_EQ(v.at(kHere, kUp)[1], 1);
  EXPECT_FLOAT_EQ(v.at(kHere, kUp)[2], 1);  // never drawn
  EXPECT_FLOAT_EQ(v.at(kThere, kUp)[0], 0.5f);
  EXPECT_FLOAT_EQ(v.at(kHere + Vec3f{0.01f, 0.01f, 0.01f}, {0.1f, 0, 0.9f})[0], 0.05f);  // the same cell
  EXPECT_FLOAT_EQ(v.at(kHere, {0, 0, 0})[0], 1);
  EXPECT_FLOAT_EQ(v.at(kHere, -kUp)[0], 1);
  EXPECT_FLOAT_EQ(v.at(kHere + Vec3f{0, 1, 0}, kUp)[0], 1);
}

TEST(LightVisibility, GainsNothingWhereAllIsSeenOrHiddenAlike) {
  for (const bool seen : {false, true}) {
    LightVisibility v = visibility();
    EXPECT_EQ(visibility().learn(), 1);
    for (size_t i = 0; i < 160; ++i) v.note(kHere, kUp, i % 16, seen);
    EXPECT_EQ(v.learn(), 1);
  }
  LightVisibility v = visibility();
  for (size_t i = 0; i < 1600; ++i) v.note(kHere, kUp, i % 16, i / 16 % 2 == 0);
  EXPECT_NEAR(v.learn(), 1, 1e-6);
}

// Whatever the threads, and wherever a place is.
TEST(LightVisibility, CountsFromAnyThreadAndAnywhere) {
  constexpr float kMost = std::numeric_limits<float>::max();
  for (const Projection projection :
       {Projection::kPerspective, Projection::kOrthographic, Projection::kEquirectangular}) {
    LightVisibility v = visibility(projection);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 1000; ++i) v.note({1, 2, 3}, kUp, 5, i % 2 == 0);
      });
    for (std::thread& t : threads) t.join();
    for (const float x : {0.0f, 1e-40f, 1e-20f, 1e10f, kMost, -kMost}) v.note({x, x, 0}, kUp, 3, true);
    v.learn();
    EXPECT_FLOAT_EQ(v.at({1, 2, 3}, kUp)[5], 2001.0f / 4001);
  }
}

}  // namespace
}  // namespace wardmis
