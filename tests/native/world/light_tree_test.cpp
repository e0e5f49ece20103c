// SPDX-License-Identifier: GPL-3.0-or-later
// Which lights a point draws from.
#include "world/light_tree.h"

#include <gtest/gtest.h>

#include "random_points.h"

namespace wardmis {
namespace {

using test::inBox;
Vec3f direction(Stream& random) { return normalize(inBox(random, 1)); }

// Lamps of all kinds, and more distant ones than are entries of their own.
std::vector<LightBounds> lights(Stream& random, int finite, int distant) {
  std::vector<LightBounds> all;
  for (int i = 0; i < finite + distant; ++i) {
    LightBounds b;
    b.lower = b.upper = inBox(random, 10);
    b.upper = b.upper + Vec3f{0.1f, 0.2f, 0.05f};
    b.axis = direction(random);
    b.cosO = i % 3 == 0 ? -1.0f : i % 3 == 1 ? 1.0f : 0.7f;
    b.cosE = i % 4 == 0 ? 0.9f : 0;
    b.twoSided = i % 2 == 0;
    b.distant = i >= finite;
    b.intensity = b.power = i % 17 == 5 ? 0 : static_cast<float>(random.square().x) + 0.01f;
    all.push_back(b);
  }
  return all;
}

TEST(LightTree, ProbabilitiesAreThoseOfWhatIsDrawn) {
  for (const auto& [finite, distant] :
       {std::pair{1, 0}, {0, 1}, {2, 0}, {9, 0}, {40, 3}, {300, 0}, {3, 20}, {0, 12}, {2000, 2}}) {
    Stream random(7, static_cast<uint64_t>(finite * 100 + distant));
    const std::vector<LightBounds> all = lights(random, finite, distant);
    const LightTree tree(all);
    for (int point = 0; point < 20; ++point) {
      const Vec3f n = point % 3 == 0 ? Vec3f{0, 0, 0} : direction(random);
      LightTree::Factors known;
      for (float& factor : known) factor = 0.05f + 0.95f * static_cast<float>(random.square().x);
      const LightTree::View view = tree.from(inBox(random, point % 2 == 0 ? 12.0f : 100.0f), n,
                                             static_cast<float>(point % 4) / 3, point % 5 < 2 ? &known : nullptr);
      double sum = 0;
      for (uint32_t i = 0; i < all.size(); ++i) {
        const float p = tree.probability(view, i);
        ASSERT_GE(p, 0);
        if (!(all[i].intensity > 0)) {
          EXPECT_EQ(p, 0);
        }
        sum += double(p);
      }
      EXPECT_LE(sum, 1 + 1e-5);
      // by chance, and with u spread evenly: what is left of it is even, too
      constexpr int kDraws = 4000;
      std::vector<int> drawn(all.size(), 0);
      int none = 0;
      double left = 0;
      for (int k = 0; k < kDraws; ++k) {
        double u = (k + random.square().x) / kDraws;
        const LightTree::Choice c = tree.choose(view, u);
        ASSERT_TRUE(u >= 0 && u < 1);
        left += u;
        if (!(c.probability > 0)) {
          ++none;
          continue;
        }
        ++drawn[c.light];
        ASSERT_NEAR(c.probability / tree.probability(view, c.light), 1, 1e-5);
      }
      EXPECT_NEAR(left / kDraws, 0.5, 5 * 0.289 / std::sqrt(double(kDraws)));
      // points spread evenly fall into an interval of u as often as its length says, but for its two ends; one light
      // has one interval
      for (uint32_t i = 0; i < all.size(); ++i)
        EXPECT_NEAR(drawn[i], double(tree.probability(view, i)) * kDraws, 3) << finite << " " << distant << " " << i;
      EXPECT_NEAR(none, (1 - sum) * kDraws, 10 + 1e-5 * kDraws);
    }
  }
}

// The variance of one draw, as a share of the squared sum, for points among lamps and lamps about them: the tree is
// compared with what it was measured to have, and drawing evenly with 2 to 130.
TEST(LightTree, VarianceIsThatOfTheMeasuredTree) {
  struct Case {
    const char* name;
    bool ceiling;    // the lamps lie in a plane and look down, else they are points in a cube
    float height;    // of the points; below -1: anywhere in the cube
    double most[3];  // of 20, 1000 and 5000 lamps
  };
  for (const Case& c :
       {Case{"among them", false, -2, {0.2, 0.4, 0.4}}, Case{"below them", false, -1, {0.2, 0.3, 0.4}},
        Case{"floor", true, 0, {0.2, 0.25, 0.25}}, Case{"near the ceiling", true, 2.7f, {0.5, 2.5, 3.5}}})
    for (size_t k = 0; k < 3; ++k) {
      constexpr std::array kLamps{20, 1000, 5000};
      Stream random(1, k);
      std::vector<LightBounds> all(kLamps[k]);
      for (LightBounds& b : all) {
        b.lower = inBox(random, 10);
        if (c.ceiling) b.lower.z = 3;
        b.upper = b.lower;
        b.axis = {0, 0, -1}, b.cosO = c.ceiling ? 1.0f : -1.0f, b.intensity = 1;
      }
      const LightTree tree(all);
      const bool faces = c.ceiling || c.height >= -1;
      double variance = 0;
      constexpr int kPoints = 40;
      for (int i = 0; i < kPoints; ++i) {
        Vec3f p = inBox(random, 10);
        if (c.ceiling || c.height >= -1) p.z = c.ceiling ? c.height : -6;
        const Vec3f n = faces ? Vec3f{0, 0, 1} : Vec3f{0, 0, 0};
        const LightTree::View view = tree.from(p, n, 1);
        double sum = 0, square = 0;
        for (uint32_t l = 0; l < all.size(); ++l) {
          const Vec3f d = all[l].lower - p;
          const double d2 = double(dot(d, d)), cosine = double(d.z) / std::sqrt(d2);
          const double f = (faces ? std::max(cosine, 0.0) : 1) * (c.ceiling ? std::max(cosine, 0.0) : 1) / d2;
          sum += f;
          if (f > 0) square += f * f / double(tree.probability(view, l));
        }
        variance += square / (sum * sum) - 1;
      }
      EXPECT_LT(variance / kPoints, c.most[k]) << c.name << " " << kLamps[k];
    }
}

// One that looks away is never drawn, and one that a point is to the side of may be.
TEST(LightTree, LampsThatLookAwayAreNotDrawn) {
  std::vector<LightBounds> all(40);
  for (size_t i = 0; i < all.size(); ++i) {
    all[i].lower = {static_cast<float>(i), -1, 0}, all[i].upper = {static_cast<float>(i) + 0.9f, 1, 0};
    all[i].axis = {0, 0, i % 2 == 0 ? 1.0f : -1.0f}, all[i].intensity = 1;
  }
  const LightTree tree(all);
  for (uint32_t i = 0; i < all.size(); ++i) {
    const LightTree::View above = tree.from({20, 0, 5}, {0, 0, -1}, 1),
                          beside = tree.from({-9, 0, 0.01f}, {1, 0, 0}, 1);
    EXPECT_EQ(tree.probability(above, i) > 0, i % 2 == 0) << i;
    if (i % 2 == 0) {
      EXPECT_GT(tree.probability(beside, i), 0) << i;
    }
  }
}

// By what arrives, and of what may be hidden, and of gloss, by power.
TEST(LightTree, GlossDrawsMoreByPower) {
  std::vector<LightBounds> all(3);
  for (size_t i = 0; i < 3; ++i) {
    all[i].lower = all[i].upper = {5 * static_cast<float>(i), 0, 0};
    all[i].cosO = -1, all[i].intensity = all[i].power = static_cast<float>(1 << i);
  }
  const LightTree tree(all);
  const Vec3f p{0, 0, 1}, n{0, 0, -1};
  double sum = 0;
  for (const LightBounds& b : all) sum += double(b.importance(p, n));
  for (uint32_t i = 0; i < 3; ++i) {
    const double power = double(all[i].power) / 7, arrives = double(all[i].importance(p, n)) / sum;
    for (const double matte : {0.0, 0.5, 1.0}) {
      const double known = 0.8 * (0.5 + 0.5 * matte);
      EXPECT_NEAR(tree.probability(tree.from(p, n, static_cast<float>(matte)), i),
                  known * arrives + (1 - known) * power, 1e-6)
          << i;
    }
  }
}

// The bounds of two hold each of them: no point that one lights is dark for both together.
TEST(LightTree, JoinedBoundsAreNeverDarkWhereOneShines) {
  Stream random(3, 1);
  for (int k = 0; k < 20000; ++k) {
    const std::vector<LightBounds> two = lights(random, 2, 0);
    const LightBounds both = LightBounds::join(two[0], two[1]);
    const Vec3f p = inBox(random, 30), n = direction(random);
    for (const LightBounds& one : two)
      if (one.importance(p, n) > 0) {
        EXPECT_GT(both.importance(p, n), 0) << k;
      }
  }
}

}  // namespace
}  // namespace wardmis
