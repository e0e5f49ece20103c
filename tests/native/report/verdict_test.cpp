// SPDX-License-Identifier: GPL-3.0-or-later
// The one line that a reader may act on: ties are ties, and the intervals decide.
#include "report/verdict.h"

#include <gtest/gtest.h>

namespace wardmis {
namespace {

using nlohmann::json;

json ratio(double low, double mean, double high) { return {{"low", low}, {"mean", mean}, {"high", high}}; }
json of(const char* what, json r) {
  r["of"] = what;
  return r;
}

json configuration(const std::string& name, const json& time, const json& error = nullptr,
                   const json& samples = nullptr) {
  return {{"name", name},
          {"estimates", "paths, depth 8"},
          {"bias", {{"verdict", "none found"}}},
          {"curve", {{{"relmse", ratio(.01, .01, .01)}, {"wall", ratio(2, 2, 2)}, {"cpu", ratio(4, 4, 4)}}}},
          {"pilot_seconds", 0.5},
          {"time_to_target", {{"seconds", ratio(1, 1, 1)}, {"ratio", time}}},
          {"equal_time", {{"seconds", 3.0}, {"ratio", error}}},
          {"equal_samples", {{"ratio", samples}}},
          {"efficiency", {{"ratio", nullptr}}}};
}

json cycles() {
  json c = configuration("Cycles", ratio(2, 2, 2));
  c["estimates"] = nullptr;
  return c;
}

json report(const std::vector<json>& others) {
  json r{{"baseline", "equal"}, {"metric", "relmse"}, {"clock", "wall"}, {"complete", true}, {"seeds", json::array()}};
  for (int i = 0; i < 16; ++i) r["seeds"].push_back(i);
  r["configurations"] = {configuration("equal", nullptr)};
  for (const json& c : others) r["configurations"].push_back(c);
  return r;
}

const json kTie = of("time", ratio(.9, 1, 1.1)), kHalf = of("time", ratio(.48, .5, .53)),
           kTwice = of("time", ratio(1.9, 2, 2.1));

TEST(Verdict, theBaselineStaysWhereNothingIsSurelySooner) {
  const json r = report({configuration("auto", ratio(.8, .95, 1.01)), configuration("variance", ratio(1.3, 1.5, 1.7))});
  EXPECT_EQ(recommended(r), "equal");
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kTie}, {"variance", kHalf}}),
            "Use equal: nothing here is surely better. auto is a tie. variance is worse.");
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kHalf}, {"variance", kHalf}}),
            "Use equal: nothing here is better. auto and variance are worse.");
}

TEST(Verdict, theSoonestIsUsedAndSaysWhatItBrings) {
  const json r =
      report({configuration("variance", ratio(.7, .8, .9)), configuration("auto", ratio(.55, .6, .65)), cycles()});
  EXPECT_EQ(recommended(r), "auto");
  EXPECT_EQ(
      verdictText(r, "auto", {{"equal", of("time", ratio(.55, .6, .65))}, {"variance", kTie}, {"Cycles", kHalf}}),
      "Use auto: the noise of equal in 60 % of its time and the noise of Cycles in half its time. variance is a tie.");
}

TEST(Verdict, cyclesIsComparedInBothDirections) {
  const json r = report({configuration("auto", ratio(.9, 1, 1.1)), cycles()});
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kTie}, {"Cycles", kHalf}}),
            "Use equal: the noise of Cycles in half its time. auto is a tie.");
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kTie}, {"Cycles", kTie}}),
            "Use equal. Against Cycles, it is a tie. auto is a tie.");
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kTie}, {"Cycles", kTwice}}),
            "Cycles is better here: the noise of equal in half its time. Of WardMIS, use equal. auto is a tie.");
  EXPECT_EQ(verdictText(r, "equal", {{"auto", kTie}, {"Cycles", nullptr}}),
            "Use equal: nothing here is surely better. auto is a tie. Cycles cannot be compared with it.");
}

TEST(Verdict, withoutATimeTheErrorAtEqualTimeDecides) {
  json r = report({configuration("auto", nullptr, ratio(.2, .25, .28))});
  r["configurations"][0]["time_to_target"]["seconds"] = nullptr;
  EXPECT_EQ(recommended(r), "auto");
  EXPECT_EQ(verdictText(r, "auto", {{"equal", of("error", ratio(.2, .25, .28))}}),
            "Use auto: a quarter of the error of equal in the same time.");
}

TEST(Verdict, saysHowUnsureItIs) {
  json r = report({configuration("auto", ratio(.2, .5, .9))});
  EXPECT_EQ(verdictText(r, "auto", {{"equal", of("time", ratio(.2, .5, .9))}}),
            "Use auto: the noise of equal in 50 % of its time (20 to 90 %).");
  r["seeds"] = {1, 2}, r["complete"] = false, r["metric"] = "relmse_trimmed";
  const std::string text = verdictText(r, "auto", {{"equal", kHalf}});
  for (const char* part : {"2 seeds this is a hint", "stopped early", "brightest pixels are left out"})
    EXPECT_NE(text.find(part), std::string::npos) << text;
}

TEST(Verdict, wordsAreWithinTheirInterval) {
  const auto said = [](double low, double mean, double high) {
    const json r = report({configuration("auto", ratio(low, mean, high))});
    return verdictText(r, "auto", {{"equal", of("time", ratio(low, mean, high))}});
  };
  EXPECT_EQ(said(.49, .51, .53), "Use auto: the noise of equal in half its time.");
  EXPECT_EQ(said(.51, .52, .53), "Use auto: the noise of equal in 52 % of its time.");
  EXPECT_EQ(said(.991, .996, .999), "Use auto: the noise of equal in 99.6 % of its time.");
  EXPECT_EQ(said(.9991, .9996, .9998), "Use auto: the noise of equal in 99.96 % of its time.");
}

TEST(Verdict, aTieIsOneInBothColumnsAndNarrow) {
  const json wide = of("time", ratio(.4, 1.1, 3));
  const auto said = [](const json& error, const json& time) {
    return verdictText(report({configuration("auto", ratio(.9, 1, 1.1), error)}), "equal", {{"auto", time}});
  };
  EXPECT_EQ(said(ratio(.95, 1, 1.05), kTie), "Use equal: nothing here is surely better. auto is a tie.");
  EXPECT_EQ(said(ratio(1.1, 1.2, 1.3), kTie),
            "Use equal. auto is no sooner at the target, and has more error in the same time.");
  EXPECT_EQ(said(ratio(.7, .8, .9), kTie),
            "Use equal. auto is no sooner at the target, and has less error in the same time.");
  EXPECT_EQ(said(ratio(.4, 1.1, 3), wide),
            "Use equal: nothing here is surely better. No difference to auto was found.");
  EXPECT_EQ(verdictText(report({cycles()}), "equal", {{"Cycles", wide}}),
            "Use equal: nothing here is surely better. No difference to Cycles was found.");
}

TEST(Verdict, aTieWithAnotherRendererIsOneInBothColumnsToo) {
  const auto said = [](const json& error, const json& product, const char* of, int samples = 64) {
    json c = cycles();
    c["equal_time"]["ratio"] = error, c["efficiency"] = {{"ratio", product}}, c["curve"][0]["spp"] = samples;
    json r = report({c});
    r["configurations"][0]["curve"][0]["spp"] = 64;
    return verdictText(r, "equal", {{"Cycles", wardmis::of(of, ratio(.78, .9, 1.03))}});
  };
  const json same = ratio(.9, 1, 1.1), more = ratio(1.5, 1.67, 1.86), less = ratio(.5, .6, .7);
  EXPECT_EQ(said(same, more, "time"), "Use equal. Against Cycles, it is a tie.");
  EXPECT_EQ(said(more, same, "time"),
            "Use equal. Cycles is neither surely sooner nor later at the target, and has more error in the same time.");
  EXPECT_EQ(said(less, same, "time"),
            "Use equal. Cycles is neither surely sooner nor later at the target, and has less error in the same time.");
  EXPECT_EQ(said(nullptr, same, "time to its end", 32),
            "Use equal. Against Cycles, it is a tie at the error where its curve ends.");
  EXPECT_EQ(said(nullptr, more, "time to its end", 32),
            "Use equal. Cycles is neither surely sooner nor later at the error where its curve ends, and has more "
            "variance times "
            "seconds, with 32 samples per pixel where equal has 64.");
}

TEST(Verdict, neitherBiasedNorOtherLightIsUsed) {
  json biased = configuration("fast", ratio(.1, .1, .1)), direct = configuration("direct", ratio(.1, .1, .1));
  biased["bias"]["verdict"] = "biased", direct["estimates"] = "direct light";
  json r = report({biased, direct});
  EXPECT_EQ(recommended(r), "equal");
  EXPECT_EQ(verdictText(r, "equal", {{"fast", kTwice}, {"direct", kTwice}}),
            "Use equal. fast cannot be compared with it.");
  r["configurations"][0]["bias"]["verdict"] = "biased";
  EXPECT_EQ(recommended(r), "");
  EXPECT_NE(verdictText(r, "", {}).find("None can be recommended"), std::string::npos);
}

TEST(Verdict, nothingToChoose) {
  EXPECT_EQ(recommended(report({})), "");
  EXPECT_NE(verdictText(report({}), "", {}).find("equal is all that was measured"), std::string::npos);
  json r = report({configuration("auto", nullptr)});
  for (json& c : r["configurations"]) c["curve"][0]["relmse"] = ratio(0, 0, 0);
  EXPECT_EQ(recommended(r), "");
  EXPECT_NE(verdictText(r, "", {}).find("equals the reference"), std::string::npos);
}

TEST(Contradictions, areExplainedAndNothingElseIs) {
  const json less = ratio(.4, .5, .6), more = ratio(1.4, 1.5, 1.6), same = ratio(.9, 1, 1.1);
  json slow = configuration("auto", more, more, less);
  slow["curve"][0]["wall"] = ratio(7, 7, 7);
  ASSERT_EQ(contradictions(report({slow})).size(), 1);
  EXPECT_EQ(
      contradictions(report({slow}))[0],
      "auto has less error than equal at equal samples, and is slower by the clock: its render of as many samples "
      "takes 3.5 times as long, its pilot and its choosing included.");
  EXPECT_EQ(contradictions(report({configuration("auto", more, less, less)}))[0].substr(0, 40),
            "auto has less error than equal at equal ");
  EXPECT_EQ(
      contradictions(report({configuration("auto", more, less, same)}))[0],
      "auto reaches the target later than equal, and has less error after 3 s: their curves cross between the two.");
  EXPECT_TRUE(
      contradictions(report({configuration("auto", more, more, same), configuration("variance", less, less, less),
                             configuration("albedo", same, same, same), cycles()}))
          .empty());
}

}  // namespace
}  // namespace wardmis
