// SPDX-License-Identifier: GPL-3.0-or-later
// What operations compute: against tests/golden/operations.json (numpy, double precision), and exact cases.
#include "program/run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "programs.h"

namespace wardmis {
namespace {

using namespace test;

void expectNear(const json& operations, const std::vector<double>& expected, const ShadingContext& context = {},
                TextureAccess textures = {}, double tolerance = 2e-6) {
  const std::vector<float> found = values(operations, context, textures);
  ASSERT_EQ(found.size(), expected.size()) << operations;
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], tolerance * std::max(1.0, std::abs(expected[i])))
        << operations << " [" << i << "]";
}

TEST(Run, AgreesWithNumpy) {
  std::ifstream file(WARDMIS_TEST_DATA "/golden/operations.json");
  const json cases = json::parse(file);
  std::set<std::string> names;
  for (json c : cases) {
    const json out = c["out"];
    c.erase("out");
    names.insert(c["op"]);
    const auto expected = out.is_array() ? out.get<std::vector<double>>() : std::vector<double>{out.get<double>()};
    expectNear(json::array({c}), expected, {}, {}, 3e-5);
  }
  EXPECT_GE(names.size(), 129u);
}

// By slots of two kinds and as constants, in one program.
TEST(Run, TakesArgumentsFromLiteralsAndFromValues) {
  expectNear({{{"op", "combine"}, {"in", {0.5, 2, -1}}},
              {{"op", "vector-scale"}, {"in", {{{"result", 0}}, 2}}},
              {{"op", "y"}, {"in", {{{"result", 1}}}}},
              {{"op", "combine"}, {"in", {4, {{"result", 2}}, 0}}},
              {{"op", "mix"}, {"in", {0.25, {{"result", 1}}, {{"result", 3}}}}}},
             {0.75 * 1 + 0.25 * 4, 4, -1.5});
}

}  // namespace
}  // namespace wardmis
