// SPDX-License-Identifier: GPL-3.0-or-later
// What is said in words, of figures that are made up.
#include <gtest/gtest.h>

#include "report/analysis.h"

namespace wardmis {
namespace {

using nlohmann::json;

std::string remark(double better, double worse, const char* verdict) {
  return mapRemark("auto", "equal", {{"better", better}, {"worse", worse}, {"undecided", 1 - better - worse}},
                   {{"verdict", verdict}});
}

TEST(MapRemark, explainsAMapThatSeemsToContradictTheFinding) {
  const std::string sooner = remark(0.125, 0.625, "faster");
  EXPECT_NE(sooner.find("auto reaches the target sooner than equal, although it is worse on more of the map "
                        "(12.5 % better, 62.5 % worse, 25 % undecided)"),
            sooner.npos)
      << sooner;
  EXPECT_NE(sooner.find("the map counts each block alike"), sooner.npos) << sooner;
  const std::string later = remark(0.5, 0.25, "slower");
  EXPECT_NE(later.find("later than equal, although it is better on more of the map"), later.npos) << later;
}

// `ratio` is what the verdict above has of Cycles, which does not surely reach the target.
std::string findingOf(const json& ratio) {
  const auto configuration = [](const char* name, const char* verdict) -> json {
    return {{"name", name},
            {"estimates", "paths"},
            {"bias", nullptr},
            {"tail", {{"heavy", false}}},
            {"curve", {{{"relmse", {{"mean", .01}}}}}},
            {"equal_samples", nullptr},
            {"time_to_target", {{"target", .02}, {"ratio", nullptr}, {"verdict", verdict}}}};
  };
  const json seeds(16, 1);
  const json r{{"baseline", "equal"},
               {"metric", "relmse"},
               {"clock", "wall"},
               {"title", "x"},
               {"seeds", seeds},
               {"complete", true},
               {"wall_scattered", false},
               {"reference", {{"floor", {{"relmse", 1e-6}}}}},
               {"verdict", {{"ratios", {{"Cycles", ratio}}}}},
               {"configurations", {configuration("equal", "baseline"), configuration("Cycles", "not reached")}}};
  std::string text;
  for (const std::string& sentence : finding(r)) text += sentence + " ";
  return text;
}

TEST(Finding, saysWhereAFigureOfWhatDoesNotReachTheTargetIsFrom) {
  EXPECT_NE(
      findingOf({{"of", "time to its end"}, {"mean", .58}})
          .find("The curve of Cycles ends before that error: what stands above of it is at the error where it ends."),
      std::string::npos);
  EXPECT_NE(findingOf(nullptr).find("That error is not surely reached by Cycles."), std::string::npos);
}

TEST(MapRemark, isSilentWhereBothAgreeOrNothingIsKnown) {
  EXPECT_EQ(remark(0.5, 0.25, "faster"), "");
  EXPECT_EQ(remark(0.25, 0.5, "slower"), "");
  EXPECT_EQ(remark(0.25, 0.25, "faster"), "");
  EXPECT_EQ(remark(0.25, 0.5, "tie"), "");
  EXPECT_EQ(remark(0.25, 0.5, "not reached"), "");
  EXPECT_EQ(mapRemark("auto", "equal", json(), {{"verdict", "faster"}}), "");
}

}  // namespace
}  // namespace wardmis
