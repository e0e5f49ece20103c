// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/inputs.h"

#include <gtest/gtest.h>

namespace wardmis {
namespace {

TEST(Inputs, NegativeTexelsCountInTheFilterAndGiveNegativeLight) {
  Scene scene;
  scene.images = {{"", 2, 1, 1, false, {}, {-1, 3}}};
  scene.textures = {{0, Wrap::kClamp, Wrap::kClamp, Filter::kLinear}};
  TextureUse use;
  use.texture = 0;
  EXPECT_FLOAT_EQ(sampleRgb(scene, use, {0.5f, 0.5f}).x, 1);
  EXPECT_EQ(sampleRgb(scene, use, {0, 0.5f}).x, -1);
}

TEST(Inputs, AppliesItsTransform) {
  Scene scene;
  scene.images = {{"ramp", 2, 2, 1, false, {}, {0, 1, 2, 3}}};
  scene.textures = {{0, Wrap::kClamp, Wrap::kClamp, Filter::kNearest}};
  const TextureUse use{0, 0, {0, 1, 0, 1, 0, 0}};  // u and v exchanged
  EXPECT_EQ(sampleScalar(scene, use, {0.9f, 0.1f}), 2);
  EXPECT_EQ(sampleRgb(scene, TextureUse{}, {0, 0}), (Rgb{1, 1, 1}));
  EXPECT_FLOAT_EQ(evaluate(scene, {{2, 0, 1}, use}, {0.9f, 0.1f}).x, 4);
  EXPECT_FLOAT_EQ(evaluateAlpha(scene, {0.5f, use}, {0.1f, 0.1f}), 1e-6f);
}

}  // namespace
}  // namespace wardmis
