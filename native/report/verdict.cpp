// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "report/wording.h"

namespace wardmis {
namespace {

using nlohmann::json;

constexpr size_t kFewSeeds = 8;  // under which the line calls itself a hint
constexpr size_t kFewNames = 3;  // that are listed
constexpr double kWide = 1.5;    // upper over lower end of an interval that the line states, and that is no tie

enum class Side { kUnknown, kBetter, kWorse, kTie };

// Of a ratio of times or errors, of which less is better.
Side sideOf(const json& ratio) {
  if (!ratio.is_object()) return Side::kUnknown;
  return ratio["high"] < 1 - kAlike ? Side::kBetter : ratio["low"] > 1 + kAlike ? Side::kWorse : Side::kTie;
}
bool isWide(const json& ratio) { return ratio["high"].get<double>() >= kWide * ratio["low"].get<double>(); }

// Never 100 of what is less, nor 0 of what is more.
std::string percent(double p) {
  int digits = p < 0.1 ? 1 : 0;
  const auto said = [&] { return fmt::format("{:.{}f}", 100 * p, digits); };
  while (p < 1 && digits < 6 && (said().starts_with("100") || said().find_first_not_of("0.") == std::string::npos))
    ++digits;
  return said();
}

bool isExternal(const json& c) { return !c["estimates"].is_string(); }
bool isBiased(const json& c) { return c["bias"].is_object() && c["bias"]["verdict"] == "biased"; }

const json& baselineOf(const json& r) {
  for (const json& c : r["configurations"])
    if (c["name"] == r["baseline"]) return c;
  throw std::logic_error("a report without its baseline");
}

const json& ratioIn(const json& c, const char* column) {
  static const json none;
  return c[column].is_object() ? c[column]["ratio"] : none;
}

// "half its time", "62 % of its time"; with the interval where that is wide. A fraction in words is within the
// interval.
std::string share(const json& ratio, const char* of) {
  const double x = ratio["mean"];
  const bool wide = isWide(ratio);
  if (!wide)
    for (const auto& [part, name] :
         {std::pair(2, "half"), {3, "a third of"}, {4, "a quarter of"}, {5, "a fifth of"}, {10, "a tenth of"}})
      if (std::abs(x * part - 1) < 0.06 && ratio["low"] <= 1.0 / part && ratio["high"] >= 1.0 / part)
        return fmt::format("{} {}", name, of);
  std::string text = fmt::format("{} % of {}", percent(x), of);
  if (wide) text += fmt::format(" ({} to {} %)", percent(ratio["low"]), percent(ratio["high"]));
  return text;
}

constexpr const char* kAtItsEnd = "at the error where its curve ends";

// Where the curve of another renderer ends before the target.
bool isToItsEnd(const json& ratio) { return ratio["of"] == "time to its end"; }

// Of a tie with the baseline at the target, or where another renderer's curve ends: whether it is one at equal time
// too, or, where another renderer has no such time, by variance times seconds; and the sentence where it is not.
std::string otherColumn(const json& c, const json& base, const json& ratio) {
  const bool timed = !isExternal(c) || ratioIn(c, "equal_time").is_object();
  const Side side = sideOf(ratioIn(c, timed ? "equal_time" : "efficiency"));
  if (side != Side::kBetter && side != Side::kWorse) return "";
  const auto samples = [](const json& of) { return of["curve"].back()["spp"].get<int>(); };
  std::string text =
      fmt::format(" {} is neither surely sooner nor later than {} {}, and has {} ", c["name"].get<std::string>(),
                  base["name"].get<std::string>(), isToItsEnd(ratio) ? kAtItsEnd : "at the target",
                  side == Side::kBetter ? "less" : "more");
  if (timed) return text + "error in the same time.";
  text += "variance times seconds";
  if (samples(c) != samples(base))
    text += fmt::format(", with {} samples per pixel where {} has {}", samples(c), base["name"].get<std::string>(),
                        samples(base));
  return text + ".";
}

// What is brought against `name`: "the noise of equal in half its time", or at equal time "half the error of equal in
// the same time". Where that is no figure at the target, it says which curve's end it is of.
std::string gain(const json& ratio, const std::string& name, const std::string& ended) {
  if (ratio["of"] == "error") return fmt::format("{} in the same time", share(ratio, ("the error of " + name).c_str()));
  const std::string time = share(ratio, "its time");
  if (!isToItsEnd(ratio)) return fmt::format("the noise of {} in {}", name, time);
  return name == ended ? fmt::format("the noise that {} ends with in {}", name, time)
                       : fmt::format("the noise of {} in {}, where the curve of {} ends", name, time, ended);
}

json inverse(const json& ratio) {
  return {{"of", ratio["of"]},
          {"mean", 1 / ratio["mean"].get<double>()},
          {"low", 1 / ratio["high"].get<double>()},
          {"high", 1 / ratio["low"].get<double>()}};
}

// Every image is the reference.
bool isExact(const json& r) {
  const char* metric = r["metric"] == "relmse" ? "relmse" : "relmse_trimmed";
  return std::all_of(r["configurations"].begin(), r["configurations"].end(), [&](const json& c) {
    return std::all_of(c["curve"].begin(), c["curve"].end(), [&](const json& at) { return at[metric]["mean"] == 0; });
  });
}

std::string noChoice(const json& r) {
  const std::string base = r["baseline"];
  if (r["configurations"].size() < 2)
    return fmt::format("{} is all that was measured: there is nothing to choose from.", base);
  if (isExact(r)) return "Every image equals the reference: there is nothing to choose.";
  const auto isOut = [](const json& c) { return isExternal(c) || isBiased(c); };
  if (std::all_of(r["configurations"].begin(), r["configurations"].end(), isOut))
    return "None of WardMIS can be recommended: each differs from the reference by more than noise.";
  return isExternal(baselineOf(r))
             ? fmt::format("None can be recommended: all are compared with {}, which is another renderer.", base)
             : fmt::format(
                   "None can be recommended: {}, which all are compared with, differs from the reference by "
                   "more than noise.",
                   base);
}

// " auto is <one>.", " auto and variance are <many>.", or of more names than can be taken in " 5 others are <many>."
std::string sentence(const std::vector<std::string>& names, const std::string& one, const std::string& many) {
  if (names.empty()) return "";
  if (names.size() > kFewNames) return fmt::format(" {} others {}.", names.size(), many);
  return fmt::format(" {} {}.", listed(names), names.size() == 1 ? one : many);
}
std::string sentence(const std::vector<std::string>& names, const std::string& both) {
  return sentence(names, both, both);
}

// The other configurations, by what can be said of them beside the one to use: names, or (`ahead`, `gains`, `apart`)
// whole phrases.
struct Rivals {
  std::vector<std::string> ahead, gains, apart;
  std::vector<std::string> ties, tiesAtTheirEnd, open;  // no difference, by a narrow interval; by a wide one
  // Worse than the one to use, and, where that is not the baseline, against the baseline: better, no difference, worse.
  std::vector<std::string> second, amid, worse;
  std::vector<std::string> biased, unknown;  // not compared
};

// By the column that recommended() goes by, else by the other one.
Side againstBaseline(const json& c) {
  const json& time = ratioIn(c, "time_to_target");
  return sideOf(time.is_object() ? time : ratioIn(c, "equal_time"));
}

// Where the others stand beside the one to use alone: it is the baseline, or that is not fit for comparisons.
bool standsAlone(const json& base, const std::string& use) { return use == base["name"] || isBiased(base); }

Rivals rivalsOf(const json& r, const std::string& use, const json& ratios) {
  const json& base = baselineOf(r);
  const bool isAlone = standsAlone(base, use);
  Rivals rivals;
  for (const json& c : r["configurations"]) {
    const std::string name = c["name"];
    const bool external = isExternal(c);
    if (name == use || (!external && c["estimates"] != base["estimates"])) continue;  // other light is no rival
    const json& ratio = ratios[name];
    const Side side = sideOf(ratio);
    if (isBiased(c)) {
      rivals.biased.push_back(name);
    } else if (side == Side::kUnknown) {
      rivals.unknown.push_back(name);
    } else if (side == Side::kBetter && (external || name == base["name"])) {
      rivals.gains.insert(external ? rivals.gains.end() : rivals.gains.begin(), gain(ratio, name, name));
    } else if (side == Side::kBetter) {
      const Side other = isAlone ? Side::kWorse : againstBaseline(c);
      (other == Side::kBetter ? rivals.second : other == Side::kWorse ? rivals.worse : rivals.amid).push_back(name);
    } else if (side == Side::kWorse && external) {
      rivals.ahead.push_back(fmt::format("{} is better here: {}. ", name, gain(inverse(ratio), use, name)));
    } else if (const std::string differs =
                   use == base["name"] && ratio["of"] != "error" ? otherColumn(c, base, ratio) : "";
               !differs.empty()) {
      rivals.apart.push_back(differs);
    } else {
      (isWide(ratio) ? rivals.open : isToItsEnd(ratio) ? rivals.tiesAtTheirEnd : rivals.ties).push_back(name);
    }
  }
  return rivals;
}

// What to use and what that brings. Where it brings nothing, that nothing is better, as far as it is known.
std::string advice(const std::string& use, const Rivals& r) {
  std::string text;
  for (const std::string& each : r.ahead) text += each;
  text += fmt::format("{} {}", r.ahead.empty() ? "Use" : "Of WardMIS, use", use);
  if (!r.gains.empty()) return fmt::format("{}: {}.", text, listed(r.gains));
  if (!r.ahead.empty() || !r.apart.empty()) return text + ".";
  const bool undecided = !r.ties.empty() || !r.tiesAtTheirEnd.empty() || !r.open.empty();
  if (!undecided && r.worse.empty()) return text + ": nothing here could be compared with it.";
  return text + (undecided || !r.unknown.empty() ? ": nothing here is surely better." : ": nothing here is better.");
}

// Each of the others beside the one that is named in the sentence.
std::string others(const std::string& use, const json& base, const Rivals& r) {
  const std::string baseline = base["name"];
  std::string text = sentence(r.ties, "is a tie with " + use, "are ties with " + use);
  text += sentence(r.tiesAtTheirEnd, fmt::format("is a tie with {} {}", use, kAtItsEnd),
                   fmt::format("are ties with {} at the errors where their curves end", use));
  for (const std::string& each : r.apart) text += each;
  const std::string than =
      standsAlone(base, use) ? fmt::format("worse than {}", use) : fmt::format("worse than {} and {}", baseline, use);
  text += sentence(r.second, fmt::format("is better than {} too, but worse than {}", baseline, use),
                   fmt::format("are better than {} too, but worse than {}", baseline, use));
  text += sentence(r.amid, fmt::format("is worse than {}, and not surely better than {}", use, baseline),
                   fmt::format("are worse than {}, and not surely better than {}", use, baseline));
  text += sentence(r.worse, "is " + than, "are " + than);
  if (!r.open.empty())
    text += fmt::format(" No difference from {} was found for {}.", use,
                        r.open.size() > kFewNames ? fmt::format("{} others", r.open.size()) : listed(r.open));
  const char* differs = "differ{} from the reference by more than noise, and {} not compared";
  text +=
      sentence(r.biased, fmt::format(fmt::runtime(differs), "s", "is"), fmt::format(fmt::runtime(differs), "", "are"));
  return text + sentence(r.unknown, "cannot be compared with " + use);
}

std::string caveats(const json& r) {
  std::string text;
  if (r["metric"] != "relmse") text += " The rarest, brightest pixels are left out of this.";
  const size_t seeds = r["seeds"].size();
  if (seeds < kFewSeeds) text += fmt::format(" With {} seeds this is a hint.", seeds);
  if (r["complete"] == false) text += " It was stopped early.";
  return text;
}

}  // namespace

std::string recommended(const json& r) {
  const json& base = baselineOf(r);
  if (r["configurations"].size() < 2 || isExact(r)) return "";
  const bool timed = base["time_to_target"]["seconds"].is_object();
  std::string use = isBiased(base) || isExternal(base) ? "" : base["name"].get<std::string>();
  double best = 1;
  for (const json& c : r["configurations"]) {
    if (isExternal(c) || isBiased(c) || c["estimates"] != base["estimates"] || c["name"] == base["name"]) continue;
    const json& ratio = ratioIn(c, timed ? "time_to_target" : "equal_time");
    if (sideOf(ratio) != Side::kBetter || !(ratio["mean"] < best)) continue;
    best = ratio["mean"], use = c["name"];
  }
  return use;
}

std::string verdictText(const json& r, const std::string& use, const json& ratios) {
  if (use.empty()) return noChoice(r);
  const Rivals rivals = rivalsOf(r, use, ratios);
  return advice(use, rivals) + others(use, baselineOf(r), rivals) + caveats(r);
}

std::vector<std::string> contradictions(const json& r) {
  const json& base = baselineOf(r);
  const std::string name = base["name"];
  std::vector<std::string> said;
  for (const json& c : r["configurations"]) {
    if (isExternal(c) || c["name"] == name || c["estimates"] != base["estimates"]) continue;
    const Side target = sideOf(ratioIn(c, "time_to_target")), time = sideOf(ratioIn(c, "equal_time")),
               samples = sideOf(ratioIn(c, "equal_samples"));
    const auto any = [&](Side side) { return target == side || time == side; };
    if ((samples == Side::kBetter && any(Side::kWorse)) || (samples == Side::kWorse && any(Side::kBetter))) {
      const char* clock = r["clock"] == "cpu" ? "cpu" : "wall";
      const json &own = c["curve"].back()[clock], &other = base["curve"].back()[clock];
      const double cost = own["mean"].get<double>() / other["mean"].get<double>();
      const bool pilot = c["pilot_seconds"].is_number() && c["pilot_seconds"] > 0;
      said.push_back(
          fmt::format("{} has {} error than {} at equal samples, and is {} by the clock: its render of as many samples "
                      "takes {:.3g} "
                      "times as long{}.",
                      c["name"].get<std::string>(), samples == Side::kBetter ? "less" : "more", name,
                      samples == Side::kBetter ? "slower" : "faster", cost,
                      pilot && cost > 1 ? ", its pilot and its choosing included" : ""));
    } else if ((target == Side::kBetter && time == Side::kWorse) || (target == Side::kWorse && time == Side::kBetter)) {
      said.push_back(fmt::format(
          "{} reaches the target {} than {}, and has {} error after {:.3g} s: their curves cross between the two.",
          c["name"].get<std::string>(), target == Side::kBetter ? "sooner" : "later", name,
          time == Side::kBetter ? "less" : "more", c["equal_time"]["seconds"].get<double>()));
    }
  }
  return said;
}

}  // namespace wardmis
