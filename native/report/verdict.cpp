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

// Never 100 of what is less.
std::string percent(double p) {
  int digits = p < 0.1 ? 1 : 0;
  while (p < 1 && digits < 4 && fmt::format("{:.{}f}", 100 * p, digits).starts_with("100")) ++digits;
  return fmt::format("{:.{}f}", 100 * p, digits);
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

// Where the curve of another renderer ends before the target.
bool isToItsEnd(const json& ratio) { return ratio["of"] == "time to its end"; }

// Of a tie with another renderer at the target, or where its curve ends: whether it is one at equal time too, or, where
// that is not known, by variance times seconds; and the sentence where it is not.
std::string otherColumn(const json& c, const json& base, const json& ratio) {
  const bool timed = ratioIn(c, "equal_time").is_object();
  const Side side = sideOf(ratioIn(c, timed ? "equal_time" : "efficiency"));
  if (side != Side::kBetter && side != Side::kWorse) return "";
  const auto samples = [](const json& of) { return of["curve"].back()["spp"].get<int>(); };
  std::string text = fmt::format(" {} is neither surely sooner nor later {}, and has {} ", c["name"].get<std::string>(),
                                 isToItsEnd(ratio) ? "at the error where its curve ends" : "at the target",
                                 side == Side::kBetter ? "less" : "more");
  if (timed) return text + "error in the same time.";
  text += "variance times seconds";
  if (samples(c) != samples(base))
    text += fmt::format(", with {} samples per pixel where {} has {}", samples(c), base["name"].get<std::string>(),
                        samples(base));
  return text + ".";
}

// "the noise of equal in half its time", or at equal time "half the error of equal in the same time"
std::string gain(const json& ratio, const std::string& name) {
  return ratio["of"] == "error" ? fmt::format("{} in the same time", share(ratio, ("the error of " + name).c_str()))
                                : fmt::format("the noise of {} in {}", name, share(ratio, "its time"));
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
  if (r["configurations"].size() < 2)
    return fmt::format("{} is all that was measured: there is nothing to choose from.",
                       r["baseline"].get<std::string>());
  return isExact(r) ? "Every image equals the reference: there is nothing to choose."
                    : "None can be recommended: each differs from the reference by more than noise.";
}

// "auto is a tie.", "auto and variance are ties."
std::string sentence(const std::vector<std::string>& names, const char* one, const char* many) {
  if (names.empty()) return "";
  if (names.size() > kFewNames) return fmt::format(" {} others {}.", names.size(), many);
  return fmt::format(" {} {}.", listed(names), names.size() == 1 ? one : many);
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
  const json& base = baselineOf(r);
  std::vector<std::string> brings, ties, slower, unsure, ahead, even, evenToEnd, open;
  std::string apart;  // of what is a tie at the target, and none in the other column
  for (const json& c : r["configurations"]) {
    const std::string name = c["name"];
    if (name == use) continue;
    const json& ratio = ratios[name];
    const Side side = sideOf(ratio);
    if (isExternal(c)) {
      if (side == Side::kBetter) brings.push_back(gain(ratio, name));
      if (side == Side::kWorse) ahead.push_back(fmt::format("{} is better here: {}.", name, gain(inverse(ratio), use)));
      if (side == Side::kUnknown) unsure.push_back(name);
      if (side != Side::kTie) continue;
      const std::string differs = use == base["name"] && ratio["of"] != "error" ? otherColumn(c, base, ratio) : "";
      apart += differs;
      if (differs.empty()) (isWide(ratio) ? open : isToItsEnd(ratio) ? evenToEnd : even).push_back(name);
    } else if (c["estimates"] != base["estimates"]) {
      continue;  // no rival
    } else if (isBiased(c) || side == Side::kUnknown) {
      unsure.push_back(name);
    } else if (side == Side::kBetter && name == base["name"]) {
      brings.insert(brings.begin(), gain(ratio, name));
    } else if (side == Side::kBetter) {
      slower.push_back(name);
    } else if (const Side error =
                   use == base["name"] && ratio["of"] == "time" ? sideOf(ratioIn(c, "equal_time")) : Side::kTie;
               error == Side::kBetter || error == Side::kWorse) {
      apart += fmt::format(" {} is no sooner at the target, and has {} error in the same time.", name,
                           error == Side::kBetter ? "less" : "more");
    } else {
      (isWide(ratio) ? open : ties).push_back(name);
    }
  }
  const bool undecided = !ties.empty() || !open.empty() || !apart.empty() || !unsure.empty();
  std::string text;
  for (const std::string& each : ahead) text += each + " ";
  text += fmt::format("{} {}", ahead.empty() ? "Use" : "Of WardMIS, use", use);
  if (!brings.empty())
    text += ": " + listed(brings);
  else if (ahead.empty() && even.empty() && evenToEnd.empty() &&
           (undecided ? ties.size() + open.size() + slower.size() > 0 : !slower.empty()))
    text += undecided ? ": nothing here is surely better" : ": nothing here is better";
  text += ".";
  if (!even.empty()) text += fmt::format(" Against {}, it is a tie.", listed(even));
  if (!evenToEnd.empty())
    text += fmt::format(" Against {}, it is a tie at the error where its curve ends.", listed(evenToEnd));
  text += sentence(ties, "is a tie", "are ties") + apart + sentence(slower, "is worse", "are worse");
  if (!open.empty())
    text += open.size() > kFewNames ? fmt::format(" To {} others no difference was found.", open.size())
                                    : fmt::format(" No difference to {} was found.", listed(open));
  text += sentence(unsure, "cannot be compared with it", "cannot be compared with it");
  if (r["metric"] != "relmse") text += " The rarest, brightest pixels are left out of this.";
  const size_t seeds = r["seeds"].size();
  if (seeds < kFewSeeds) text += fmt::format(" With {} seeds this is a hint.", seeds);
  if (r["complete"] == false) text += " It was stopped early.";
  return text;
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
