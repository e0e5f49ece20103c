// SPDX-License-Identifier: GPL-3.0-or-later
// Curves and spheres in files: what is read, and what is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "every_operation.h"

namespace wardmis {
namespace {

using namespace test;

std::vector<uint32_t> indicesOf(const Primitive& p) { return {p.indices.data.begin(), p.indices.data.end()}; }

TEST(GlbStrands, ReadsCurvesAndSpheres) {
  const Scene s = read(withStrands());
  ASSERT_EQ(s.meshes.size(), 1u);
  ASSERT_EQ(s.meshes[0].parts.size(), 1u);  // they share their points
  const MeshPart& part = s.meshes[0].parts[0];
  ASSERT_EQ(part.positions.size(), 5u);
  EXPECT_EQ(std::vector<float>(part.radii.data.begin(), part.radii.data.end()),
            (std::vector<float>{0.1f, 0.2f, 0, 0.1f, 0.3f}));
  ASSERT_EQ(part.primitives.size(), 4u);
  EXPECT_EQ(part.primitives[0].form, Form::kRibbons);
  EXPECT_EQ(part.primitives[0].pieces, 3);
  EXPECT_EQ(indicesOf(part.primitives[0]), (std::vector<uint32_t>{0, 1, 3}));
  EXPECT_EQ(part.primitives[1].form, Form::kTubes);
  EXPECT_EQ(part.primitives[1].pieces, 5);
  EXPECT_TRUE(part.primitives[1].inside);
  EXPECT_FALSE(part.primitives[2].inside);
  EXPECT_EQ(part.primitives[2].form, Form::kCones);
  EXPECT_EQ(part.primitives[3].form, Form::kSpheres);
  EXPECT_EQ(indicesOf(part.primitives[3]), (std::vector<uint32_t>{0, 1, 2, 3, 4}));  // none: all of them
  EXPECT_TRUE(s.leftOut.empty());
}

TEST(GlbStrands, LinesAndPointsWithoutAShapeAreLeftOut) {
  GlbBuilder b = withStrands();
  for (int i = 0; i < 4; i++) primitive(b, i).erase("extensions");
  EXPECT_TRUE(listHas(read(b).leftOut, "points and lines of mesh"));
}

TEST(GlbStrands, RefusesWhatIsNone) {
  const auto refused = [](const std::function<void(GlbBuilder&)>& spoil, const std::string& part) {
    GlbBuilder b = withStrands();
    spoil(b);
    expectHas(errorOf(b), part);
  };
  const auto shape = [](GlbBuilder& b, int i) -> json& { return primitive(b, i)["extensions"]["WARDMIS_scene"]; };
  refused([&](GlbBuilder& b) { shape(b, 0)["shape"] = "spheres"; },
          "expected one of \"ribbons\", \"tubes\", \"cones\"");
  refused([&](GlbBuilder& b) { shape(b, 3)["shape"] = "tubes"; }, "expected \"spheres\"");
  refused([&](GlbBuilder& b) { primitive(b, 1)["mode"] = 3; }, "which is for lines (mode 1) and points (mode 0)");
  refused([&](GlbBuilder& b) { primitive(b, 1)["mode"] = 4; }, "which is for lines (mode 1) and points (mode 0)");
  refused([&](GlbBuilder& b) { shape(b, 0)["pieces"] = 17; }, "pieces");
  refused([&](GlbBuilder& b) { shape(b, 0)["pieces"] = 0; }, "pieces");
  refused([&](GlbBuilder& b) { shape(b, 1)["inside"] = 1; }, "inside");
  refused([&](GlbBuilder& b) { primitive(b, 0)["attributes"].erase("_RADIUS"); }, "has no _RADIUS");
  const auto radii = [&](std::vector<float> r) {
    return [r](GlbBuilder& b) { primitive(b, 2)["attributes"]["_RADIUS"] = b.accessor<float>(r, 1); };
  };
  refused(radii({0.1f, 0.1f, 0.1f, -0.5f, 0.1f}), "radius 3 is -0.5, less than 0");
  refused(radii({0.1f, 0.1f, std::nanf(""), 0.1f, 0.1f}), "element 2 of accessor");
  refused(radii({0.1f, std::numeric_limits<float>::infinity(), 0.1f, 0.1f, 0.1f}), "element 1 of accessor");
  refused(radii({0.1f, 0.1f, 0.1f, 0.1f, 2e18f}), "point 4 reaches further than 10^18 metres");
  refused(radii({0.1f, 0.1f, 0.1f, 0.1f}), "has 4 elements, but POSITION has 5");
  refused([&](GlbBuilder& b) { primitive(b, 2)["attributes"]["_RADIUS"] = 0; }, "expected elements of one number");
  const auto indices = [&](std::vector<uint32_t> list, int i) {
    return [list, i](GlbBuilder& b) { primitive(b, i)["indices"] = b.accessor<uint32_t>(list, 1); };
  };
  refused(indices({0, 1, 2}, 0), "3 ends of segments: they are no pairs");
  refused(indices({0, 1, 1, 3}, 0), "segment 1 goes from point 1 to 3, and not to the next one");
  refused(indices({0, 1, 2, 1}, 0), "segment 1 goes from point 2 to 1");
  refused(indices({4, 5}, 0), "segment 0 begins at point 4, but there are 5");
  refused(indices({0xFFFFFFFF, 0}, 0), "segment 0 begins at point 4294967295");
  refused(indices({5}, 3), "sphere 0 begins at point 5, but there are 5");
}

}  // namespace
}  // namespace wardmis
