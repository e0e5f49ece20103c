// SPDX-License-Identifier: GPL-3.0-or-later
// The one line that a reader may act on: ties are ties, and the intervals decide.
#include "report/verdict.h"

#include <gtest/gtest.h>

#include <functional>

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
          {"curve",
           {{{"relmse", ratio(.01, .01, .01)},
             {"relmse_trimmed", ratio(.01, .01, .01)},
             {"wall", ratio(2, 2, 2)},
             {"cpu", ratio(4, 4, 4)}}}},
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
           kTwice = of("time", ratio(1.9, 2, 2.1)), kWide = ratio(.4, 1.1, 3);

const json kSlightlyMore = ratio(1.1, 1.2, 1.3), kSlightlyLess = ratio(.7, .8, .9), kAlmostOne = ratio(.95, 1, 1.05);

json biased(json c) {
  c["bias"]["verdict"] = "biased";
  return c;
}

// A state that the line can be in: the configurations beside `equal`, and the ratios of the one to use to the others.
struct State {
  const char* what;
  std::vector<json> others;
  const char* use;
  json ratios;
  const char* text;
  std::function<void(json&)> change = [](json&) {};
};

const std::vector<State> kStates{
    // equal is to be used
    {"a tie and one that is worse",
     {configuration("auto", ratio(.8, .95, 1.01)), configuration("variance", ratio(1.3, 1.5, 1.7))},
     "equal",
     {{"auto", kTie}, {"variance", kHalf}},
     "Use equal: nothing here is surely better. auto is a tie with equal. variance is worse than equal."},
    {"all worse",
     {configuration("auto", ratio(1.9, 2, 2.1)), configuration("variance", ratio(1.9, 2, 2.1))},
     "equal",
     {{"auto", kHalf}, {"variance", kHalf}},
     "Use equal: nothing here is better. auto and variance are worse than equal."},
    {"worse by the error at equal time, where there is no time to the target",
     {configuration("variance", nullptr, ratio(2.5, 3, 3.5))},
     "equal",
     {{"variance", of("error", ratio(.3, .33, .4))}},
     "Use equal: nothing here is better. variance is worse than equal."},
    {"two ties",
     {configuration("auto", kAlmostOne), configuration("variance", kAlmostOne)},
     "equal",
     {{"auto", kTie}, {"variance", kTie}},
     "Use equal: nothing here is surely better. auto and variance are ties with equal."},
    {"more than can be listed",
     {configuration("a", kAlmostOne), configuration("b", kAlmostOne), configuration("c", kAlmostOne),
      configuration("d", kAlmostOne)},
     "equal",
     {{"a", kHalf}, {"b", kHalf}, {"c", kHalf}, {"d", kHalf}},
     "Use equal: nothing here is better. 4 others are worse than equal."},
    {"a tie at the target alone, more error",
     {configuration("auto", kAlmostOne, kSlightlyMore)},
     "equal",
     {{"auto", kTie}},
     "Use equal. auto is neither surely sooner nor later than equal at the target, and has more error in the same "
     "time."},
    {"a tie at the target alone, less error",
     {configuration("auto", kAlmostOne, kSlightlyLess)},
     "equal",
     {{"auto", kTie}},
     "Use equal. auto is neither surely sooner nor later than equal at the target, and has less error in the same "
     "time."},
    {"too wide for a tie",
     {configuration("auto", kAlmostOne, kWide), cycles()},
     "equal",
     {{"auto", of("time", kWide)}, {"Cycles", of("time", kWide)}},
     "Use equal: nothing here is surely better. No difference from equal was found for auto and Cycles."},
    // another one is
    {"the baseline and Cycles need longer",
     {configuration("variance", kSlightlyLess), configuration("auto", ratio(.55, .6, .65)), cycles()},
     "auto",
     {{"equal", of("time", ratio(.55, .6, .65))}, {"variance", kTie}, {"Cycles", kHalf}},
     "Use auto: the noise of equal in 60 % of its time and the noise of Cycles in half its time. variance is a tie "
     "with auto."},
    {"second best ones beat the baseline too",
     {configuration("variance", ratio(.91, .95, .99)), configuration("second-moment", ratio(.81, .85, .88)),
      configuration("auto", ratio(.72, .76, .8))},
     "auto",
     {{"equal", of("time", ratio(.72, .76, .8))},
      {"variance", of("time", ratio(.75, .8, .86))},
      {"second-moment", of("time", ratio(.84, .9, .95))}},
     "Use auto: the noise of equal in 76 % of its time. variance and second-moment are better than equal too, but "
     "worse than auto."},
    {"one second best, one that equals the baseline, one that loses to it",
     {configuration("variance", ratio(.992, .997, 1.002)), configuration("second-moment", ratio(1.62, 1.64, 1.66)),
      configuration("albedo", ratio(.92, .94, .96)), configuration("auto", ratio(.9, .91, .92))},
     "auto",
     {{"equal", of("time", ratio(.9, .91, .92))},
      {"variance", of("time", ratio(.9, .91, .92))},
      {"second-moment", kHalf},
      {"albedo", of("time", ratio(.95, .96, .97))}},
     "Use auto: the noise of equal in 91 % of its time. albedo is better than equal too, but worse than auto. variance "
     "is worse than auto, and not surely better than equal. second-moment is worse than equal and auto."},
    {"no time: the error at equal time decides",
     {configuration("variance", nullptr, kSlightlyLess), configuration("auto", nullptr, ratio(.2, .25, .28))},
     "auto",
     {{"equal", of("error", ratio(.2, .25, .28))}, {"variance", of("error", ratio(.3, .33, .36))}},
     "Use auto: a quarter of the error of equal in the same time. variance is better than equal too, but worse than "
     "auto.",
     [](json& r) { r["configurations"][0]["time_to_target"]["seconds"] = nullptr; }},
    {"an interval too wide to be left out",
     {configuration("auto", ratio(.2, .5, .9))},
     "auto",
     {{"equal", of("time", ratio(.2, .5, .9))}},
     "Use auto: the noise of equal in 50 % of its time (20 to 90 %)."},
    // Cycles
    {"Cycles needs longer",
     {configuration("auto", kAlmostOne), cycles()},
     "equal",
     {{"auto", kTie}, {"Cycles", kHalf}},
     "Use equal: the noise of Cycles in half its time. auto is a tie with equal."},
    {"Cycles is a tie",
     {configuration("auto", kAlmostOne), cycles()},
     "equal",
     {{"auto", kTie}, {"Cycles", kTie}},
     "Use equal: nothing here is surely better. auto and Cycles are ties with equal."},
    {"Cycles is better",
     {configuration("auto", kAlmostOne), cycles()},
     "equal",
     {{"auto", kTie}, {"Cycles", kTwice}},
     "Cycles is better here: the noise of equal in half its time. Of WardMIS, use equal. auto is a tie with equal."},
    {"Cycles is better, and auto the best of WardMIS",
     {configuration("auto", ratio(.48, .5, .53)), cycles()},
     "auto",
     {{"equal", kHalf}, {"Cycles", kTwice}},
     "Cycles is better here: the noise of auto in half its time. Of WardMIS, use auto: the noise of equal in half its "
     "time."},
    {"Cycles tells no time",
     {configuration("auto", kAlmostOne), cycles()},
     "equal",
     {{"auto", kTie}, {"Cycles", nullptr}},
     "Use equal: nothing here is surely better. auto is a tie with equal. Cycles cannot be compared with equal."},
    {"Cycles does not surely reach the target, and needs longer for what it reaches",
     {configuration("auto", ratio(.72, .76, .8)), cycles()},
     "auto",
     {{"equal", of("time", ratio(.72, .76, .8))}, {"Cycles", of("time to its end", ratio(.54, .58, .63))}},
     "Use auto: the noise of equal in 76 % of its time and the noise that Cycles ends with in 58 % of its time."},
    {"Cycles does not surely reach the target, and is sooner at what it reaches",
     {cycles()},
     "equal",
     {{"Cycles", of("time to its end", ratio(1.9, 2, 2.1))}},
     "Cycles is better here: the noise of equal in half its time, where the curve of Cycles ends. Of WardMIS, use "
     "equal."},
    {"Cycles does not surely reach the target, and is a tie at what it reaches",
     {configuration("auto", kAlmostOne), cycles()},
     "equal",
     {{"auto", kTie}, {"Cycles", of("time to its end", kAlmostOne)}},
     "Use equal: nothing here is surely better. auto is a tie with equal. Cycles is a tie with equal at the error "
     "where its curve ends."},
    {"a renderer that converges to something else is no rival",
     {configuration("auto", kAlmostOne), biased(cycles())},
     "equal",
     {{"auto", kTie}, {"Cycles", kHalf}},
     "Use equal: nothing here is surely better. auto is a tie with equal. Cycles differs from the reference by more "
     "than noise, and is not compared."},
    // little to go by
    {"nothing could be compared: a single sample",
     {configuration("auto", nullptr), cycles()},
     "equal",
     {{"auto", nullptr}, {"Cycles", nullptr}},
     "Use equal: nothing here could be compared with it. auto and Cycles cannot be compared with equal.",
     [](json& r) { r["configurations"][0]["time_to_target"]["seconds"] = nullptr; }},
    {"one is worse, one could not be compared",
     {configuration("auto", nullptr), configuration("variance", kSlightlyMore)},
     "equal",
     {{"auto", nullptr}, {"variance", kHalf}},
     "Use equal: nothing here is surely better. variance is worse than equal. auto cannot be compared with equal."},
    {"other light, and a bias",
     {biased(configuration("fast", ratio(.1, .1, .1))), configuration("direct", ratio(.1, .1, .1))},
     "equal",
     {{"fast", kTwice}, {"direct", kTwice}},
     "Use equal: nothing here could be compared with it. fast differs from the reference by more than noise, and is "
     "not compared.",
     [](json& r) { r["configurations"][2]["estimates"] = "direct light"; }},
    {"the baseline is biased",
     {configuration("auto", kSlightlyLess), configuration("variance", ratio(.7, .85, .95))},
     "auto",
     {{"equal", kHalf}, {"variance", kHalf}},
     "Use auto: nothing here is better. variance is worse than auto. equal differs from the reference by more than "
     "noise, and is not compared.",
     [](json& r) { r["configurations"][0]["bias"]["verdict"] = "biased"; }},
    {"the baseline is biased, and nothing surely sooner",
     {configuration("auto", kAlmostOne)},
     "",
     {},
     "None can be recommended: equal, which all are compared with, differs from the reference by more than noise.",
     [](json& r) { r["configurations"][0]["bias"]["verdict"] = "biased"; }},
    {"all are biased",
     {biased(configuration("auto", kAlmostOne)), cycles()},
     "",
     {},
     "None of WardMIS can be recommended: each differs from the reference by more than noise.",
     [](json& r) { r["configurations"][0]["bias"]["verdict"] = "biased"; }},
    {"another renderer is the baseline",
     {configuration("auto", kAlmostOne), cycles()},
     "",
     {},
     "None can be recommended: all are compared with Cycles, which is another renderer.",
     [](json& r) { r["baseline"] = "Cycles"; }},
    {"alone", {}, "", {}, "equal is all that was measured: there is nothing to choose from."},
    {"no error",
     {configuration("auto", nullptr)},
     "",
     {},
     "Every image equals the reference: there is nothing to choose.",
     [](json& r) {
       for (json& c : r["configurations"]) c["curve"][0]["relmse"] = ratio(0, 0, 0);
     }},
    {"few seeds, stopped, without the brightest pixels",
     {configuration("auto", ratio(.48, .5, .53))},
     "auto",
     {{"equal", kHalf}},
     "Use auto: the noise of equal in half its time. The rarest, brightest pixels are left out of this. With 2 seeds "
     "this is a hint. It was stopped early.",
     [](json& r) {
       r["seeds"] = {1, 2}, r["complete"] = false, r["metric"] = "relmse_trimmed";
     }},
};

TEST(Verdict, saysInEachStateWhatIsTrueInIt) {
  for (const State& state : kStates) {
    SCOPED_TRACE(state.what);
    json r = report(state.others);
    state.change(r);
    EXPECT_EQ(recommended(r), state.use);
    EXPECT_EQ(verdictText(r, state.use, state.ratios), state.text);
  }
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
  EXPECT_EQ(said(.00031, .00032, .00033), "Use auto: the noise of equal in 0.03 % of its time.");
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
  const std::string tie = "Use equal: nothing here is surely better. Cycles is a tie with equal",
                    apart = "Use equal. Cycles is neither surely sooner nor later than equal at the ";
  EXPECT_EQ(said(same, more, "time"), tie + ".");
  EXPECT_EQ(said(more, same, "time"), apart + "target, and has more error in the same time.");
  EXPECT_EQ(said(less, same, "time"), apart + "target, and has less error in the same time.");
  EXPECT_EQ(said(nullptr, same, "time to its end", 32), tie + " at the error where its curve ends.");
  EXPECT_EQ(said(nullptr, more, "time to its end", 32),
            apart +
                "error where its curve ends, and has more variance times seconds, with 32 samples per pixel where "
                "equal has 64.");
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
