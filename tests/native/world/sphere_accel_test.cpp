// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/sphere_accel.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "random_points.h"

namespace wardmis {
namespace {

using test::inBox;

// Far from the origin, too, where floats are coarse.
TEST(SphereAccel, FindsAllThatARayPassesThrough) {
  for (const float away : {0.0f, 1000.0f}) {
    Stream random(5, static_cast<uint64_t>(away));
    const Vec3f at{away, -away, away};
    std::vector<SphereAccel::Sphere> spheres;
    for (int i = 0; i < 500; ++i)
      spheres.push_back({inBox(random, 20) + at, i % 10 == 0 ? 0.0f : static_cast<float>(random.square().x)});
    const SphereAccel accel(spheres);
    size_t found = 0, met = 0;
    for (int k = 0; k < 2000; ++k) {
      const Vec3f origin = inBox(random, 30) + at, direction = normalize(inBox(random, 1));
      const float tMax = k % 2 == 0 ? 1e30f : 5.0f;
      SphereAccel::Found f;
      accel.find(origin, direction, tMax, f);
      ASSERT_FALSE(f.tooMany);
      ASSERT_TRUE(std::is_sorted(f.index.begin(), f.index.begin() + static_cast<std::ptrdiff_t>(f.count)));
      found += f.count;
      for (uint32_t i = 0; i < spheres.size(); ++i) {
        const Vec3f to = spheres[i].center - origin;
        const float along = std::clamp(dot(to, direction), 0.0f, tMax);
        const Vec3f past = to - direction * along;
        if (!(dot(past, past) < spheres[i].radius * spheres[i].radius)) continue;
        ++met;
        EXPECT_TRUE(std::binary_search(f.index.begin(), f.index.begin() + static_cast<std::ptrdiff_t>(f.count), i))
            << k << " " << i;
      }
    }
    EXPECT_LT(found, 3 * met);
  }
}

TEST(SphereAccel, TellsWhereThereAreTooMany) {
  const SphereAccel accel(std::vector<SphereAccel::Sphere>(100, {{0, 0, 5}, 1}));
  SphereAccel::Found f;
  accel.find({0, 0, 0}, {0, 0, 1}, 1e30f, f);
  EXPECT_TRUE(f.tooMany);
}

}  // namespace
}  // namespace wardmis
