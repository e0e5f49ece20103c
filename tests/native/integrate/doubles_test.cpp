// SPDX-License-Identifier: GPL-3.0-or-later
// Faces in one place that the picture shows are told, and what merely touches is not.
#include "integrate/doubles.h"

#include <gtest/gtest.h>

#include "scenes.h"

namespace wardmis {
namespace {

// A floor of 4 x 4 metres, seen from above, and a square of 2 x 2 somewhat above, on, or below it.
Doubles floorWith(float height) {
  Scene scene;
  scene.materials.push_back(test::ward({0.5f, 0.5f, 0.5f}, {0, 0, 0}, 0.1f, WardVariant::kWardGmd));
  test::addPlane(scene, 2, 0);
  test::addPlane(scene, 1, 0, height);
  test::lookFrom(scene, 0, 2, 16);
  return visibleDoubles(BuiltScene(scene, 1));
}

TEST(Doubles, AreSeenWhereTheyLie) {
  EXPECT_NEAR(floorWith(0).share, 0.25, 0.02);  // the floor's triangles reach far beyond
  EXPECT_NE(floorWith(0).told().find("'object': 25 % of the picture"), std::string::npos) << floorWith(0).told();
  Doubles unnamed = floorWith(0);
  unnamed.name.clear();
  EXPECT_EQ(unnamed.told().find("an object without a name: 25 % of the picture"), 0u) << unnamed.told();
  for (const float height : {0.01f, -0.01f}) EXPECT_EQ(floorWith(height).share, 0) << height;
}

}  // namespace
}  // namespace wardmis
