// SPDX-License-Identifier: GPL-3.0-or-later
// Closures as they are read, and what is refused.
#include <gtest/gtest.h>

#include "glb_support.h"

namespace wardmis {
namespace {

using namespace test;

GlbBuilder withClosures(json closures, json also = json::object()) {
  also["closures"] = std::move(closures);
  return textured(ward(std::move(also)));
}

TEST(Closures, AreReadWithTheirDefaults) {
  const Scene scene = read(
      withClosures(json::array({{{"type", "glossy"},
                                 {"version", 4},
                                 {"distribution", "beckmann"},
                                 {"weight", {{"value", {0.5, 0.5, 0.5}}}},
                                 {"alphaX", {{"value", 0.04}}}},
                                {{"type", "principled"}, {"transmissionWeight", {{"value", 0.25}}}, {"thinWall", true}},
                                {{"type", "principled"}, {"version", 3}}})));
  const auto found = std::find_if(scene.materials.begin(), scene.materials.end(),
                                  [](const Material& m) { return !m.closures.empty(); });
  ASSERT_NE(found, scene.materials.end());
  const Closure &glossy = found->closures.at(0), &principled = found->closures.at(1);
  EXPECT_EQ(glossy.type, ClosureType::kGlossy);
  EXPECT_EQ(glossy.version, 4);
  EXPECT_EQ(glossy.distribution, Glossy::kBeckmann);
  EXPECT_EQ(glossy.weight.value, (Rgb{0.5f, 0.5f, 0.5f}));
  EXPECT_EQ(glossy.colors.at(0).value, (Rgb{0.8f, 0.8f, 0.8f}));
  EXPECT_EQ(glossy.scalars.at(0).value, 0.04f);
  EXPECT_EQ(glossy.scalars.at(1).value, 0.25f);
  EXPECT_EQ(principled.type, ClosureType::kPrincipled);
  EXPECT_EQ(principled.scalars.at(principled::kTransmissionWeight).value, 0.25f);
  EXPECT_EQ(principled.scalars.at(principled::kCoatIor).value, 1.5f);
  EXPECT_TRUE(principled.thinWall);
  EXPECT_EQ(found->closures.at(2).type, ClosureType::kPrincipled3);
  EXPECT_TRUE(found->transparent);  // thin glass
}

TEST(Closures, AreRefusedByPlaceAndName) {
  const auto refused = [](json closures, const std::string& how, json also = json::object()) {
    expectHas(errorOf(withClosures(std::move(closures), std::move(also))), how);
  };
  refused(json::array({{{"type", "toon"}}}), "there is no closure 'toon' of version 5");
  refused(json::array({{{"type", "sheen"}, {"version", 3}}}), "there is no closure 'sheen' of version 3");
  refused(json::array({json::object()}), "'type' is missing");
  refused(json::array({{{"type", "glass"}, {"ior", {{"result", 0}}}}}), "the material has no program");
  refused(json::array({{{"type", "glass"}, {"distribution", "gauss"}}}), "ashikhmin-shirley");
  refused(json::array(), "stands beside 'diffuse'", {{"diffuse", {{"value", {1, 1, 1}}}}});
}

}  // namespace
}  // namespace wardmis
