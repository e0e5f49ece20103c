// SPDX-License-Identifier: GPL-3.0-or-later
// The finding in words. It says no more than the intervals do.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "report/analysis.h"
#include "report/wording.h"

namespace wardmis {
namespace {

using nlohmann::json;

constexpr double kAlike = 1e-4;  // of ratios that are one in all that is printed

std::string number(double x) { return fmt::format("{:.3g}", x); }
// Two decimals, or as many more as keep a limit that is not 1 from looking like it.
std::string interval(const json& i) {
  const double mean = i["mean"], low = i["low"], high = i["high"];
  int decimals = 2;
  const auto looksLikeOne = [&](double x) { return x != 1 && std::abs(x - 1) < 0.5 * std::pow(10, -decimals); };
  while (decimals < 4 && (looksLikeOne(low) || looksLikeOne(high))) ++decimals;
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", mean, decimals, low, decimals, high, decimals);
}

// An interval of a ratio that spans more than a factor of ten says nothing.
bool tellsSomething(const json& ratio) { return ratio["high"].get<double>() < 10 * ratio["low"].get<double>(); }

// The comparison of a report whose metric leaves pixels out, with all of them.
std::string withAllPixels(const json& r) {
  const std::string base = r["baseline"];
  std::vector<std::string> times, unsure, errors;
  std::string target;
  for (const json& c : r["configurations"]) {
    const json& all = c["all_pixels"];
    if (!all.is_object() || c["name"] == base) continue;
    const std::string name = c["name"];
    const json &t = all["time_to_target"], &e = all["equal_samples"];
    target = number(t["target"]);
    if (t["ratio"].is_object() && tellsSomething(t["ratio"]))
      times.push_back(fmt::format("{} {}", name, interval(t["ratio"])));
    else if (t["verdict"] == "not reached")
      unsure.push_back(name);
    if (e.is_object() && e["ratio"].is_object() && tellsSomething(e["ratio"]))
      errors.push_back(fmt::format("{} {}", name, interval(e["ratio"])));
  }
  std::string text;
  if (!times.empty())
    text = fmt::format("a relMSE of {} is reached in these shares of the time of {}: {}", target, base, listed(times));
  if (!unsure.empty())
    text +=
        fmt::format("{}a relMSE of {} is not surely reached by {}", text.empty() ? "" : "; ", target, listed(unsure));
  if (!errors.empty())
    text +=
        fmt::format("{}errors at equal samples are {} of that of {}", text.empty() ? "" : "; ", listed(errors), base);
  if (text.empty()) text = "the rare large samples leave every ratio too unsure to say anything";
  return fmt::format("With all pixels, {}.", text);
}

// Whether the verdict, which stands above the finding, has a figure of what does not surely reach the target.
bool isComparedAtItsEnd(const json& r, const std::string& name) {
  if (!r.contains("verdict")) return false;
  const json ratio = r["verdict"]["ratios"].value(name, json());
  return ratio.is_object() && ratio["of"] == "time to its end";
}

// What others estimate than the baseline is another task.
std::vector<std::string> otherLight(const json& r) {
  json base;
  std::map<std::string, std::vector<std::string>> others;
  bool apart = false;
  for (const json& c : r["configurations"])
    if (c["name"] == r["baseline"]) base = c;
  for (const json& c : r["configurations"])
    if (c["estimates"].is_string() && c["estimates"] != base["estimates"]) {
      others[c["estimates"]].push_back(c["name"]);
      apart = c["reference"] != base["reference"];
    }
  std::vector<std::string> said;
  said.reserve(others.size());
  for (const auto& [light, names] : others)
    said.push_back(fmt::format(
        "{} estimate{} {}, {} {}: these are images of different light, {}, and neither is better for being sooner.",
        listed(names), names.size() == 1 ? "s" : "", light, r["baseline"].get<std::string>(),
        base["estimates"].get<std::string>(),
        apart ? "each held against its own reference" : "although both are held against the one reference given"));
  return said;
}

}  // namespace

std::vector<std::string> finding(const json& r) {
  std::vector<std::string> said;
  const std::string base = r["baseline"];
  const std::string metric = r["metric"] == "relmse" ? "relMSE" : "relMSE without the largest 0.1 %";
  const char* key = r["metric"] == "relmse" ? "relmse" : "relmse_trimmed";
  std::vector<std::string> slower, ties, unreached, ended, under, biased, unclear, heavy;
  std::vector<std::pair<double, std::string>> faster;  // by ratio
  double secondLow = 1;                                // lower end of the intervals of all but the best
  json best, baseline;
  bool baseUnreached = false, baseUnder = false;
  std::string target;
  for (const json& c : r["configurations"]) {
    const std::string name = c["name"];
    if (c["bias"].is_object() && c["bias"]["verdict"] == "biased") biased.push_back(name);
    // of a heavy tail more is said
    if (c["bias"].is_object() && c["bias"]["verdict"] == "unclear" && c["tail"]["heavy"] != true)
      unclear.push_back(name);
    if (c["tail"]["heavy"] == true) heavy.push_back(name);
    const json& t = c["time_to_target"];
    target = number(t["target"]);
    if (name == base) {
      baseUnreached = t["verdict"] == "not reached", baseUnder = t["verdict"] == "under from the start", baseline = c;
      continue;
    }
    if (t["ratio"].is_null()) {
      if (t["verdict"] == "not reached") (isComparedAtItsEnd(r, name) ? ended : unreached).push_back(name);
      if (t["verdict"] == "under from the start") under.push_back(name);
      continue;
    }
    const std::string text = fmt::format("{} {}", name, interval(t["ratio"]));
    (t["verdict"] == "slower" ? slower : ties).push_back(text);
    if (t["verdict"] != "faster") continue;
    ties.pop_back();
    faster.emplace_back(t["ratio"]["mean"], text);
    const json* other = &c;
    if (best.is_null() || t["ratio"]["mean"] < best["time_to_target"]["ratio"]["mean"]) {
      if (!best.is_null()) secondLow = std::min(secondLow, best["time_to_target"]["ratio"]["low"].get<double>());
      best = c, other = nullptr;
    }
    if (other != nullptr) secondLow = std::min(secondLow, t["ratio"]["low"].get<double>());
  }
  const size_t seeds = r["seeds"].size();
  const std::string title = r["title"];
  const char* clock = r["clock"] == "cpu" ? "processor time" : "time";
  const bool exact = std::all_of(r["configurations"].begin(), r["configurations"].end(), [&](const json& c) {
    return std::all_of(c["curve"].begin(), c["curve"].end(), [&](const json& at) { return at[key]["mean"] == 0; });
  });
  if (exact) {
    said.push_back(fmt::format("On {}, every image equals the reference: there is no error to compare.", title));
  } else if (r["configurations"].size() > 1) {
    std::sort(faster.begin(), faster.end());
    std::vector<std::string> texts;
    texts.reserve(faster.size());
    for (const auto& [ratio, text] : faster) texts.push_back(text);
    if (!faster.empty()) {
      said.push_back(
          fmt::format("On {}, a {} of {} is reached sooner than by {}, in this share of its {} (95 % intervals "
                      "over {} seeds): {}.",
                      title, metric, target, base, clock, seeds, listed(texts)));
      if (faster.size() > 1 && best["time_to_target"]["ratio"]["high"] < secondLow)
        said.push_back(fmt::format("The fastest is {}.", best["name"].get<std::string>()));
    } else if (baseUnder) {
      said.push_back(fmt::format("On {}, {} is under a {} of {} from its first checkpoint on: no time can be compared.",
                                 title, base, metric, target));
    } else if (baseUnreached) {
      said.push_back(fmt::format("On {}, {} itself does not surely reach a {} of {}: nothing can be compared with it.",
                                 title, base, metric, target));
    } else {
      said.push_back(
          fmt::format("On {}, no configuration reaches a {} of {} sooner than {} (95 % intervals over {} seeds).",
                      title, metric, target, base, seeds));
    }
    if (!ties.empty()) said.push_back(fmt::format("No difference from {} is found for {}.", base, listed(ties)));
    if (!slower.empty()) said.push_back(fmt::format("Slower than {}: {}.", base, listed(slower)));
    if (!under.empty()) said.push_back(fmt::format("Under it from their first checkpoint on: {}.", listed(under)));
    if (!unreached.empty() && !baseUnreached)
      said.push_back(fmt::format("That error is not surely reached by {}.", listed(unreached)));
    if (!ended.empty() && !baseUnreached)
      said.push_back(
          fmt::format("The curve of {} ends before that error: what stands above of it is at the error where it ends.",
                      listed(ended)));
  } else {
    const json& curve = r["configurations"][0]["curve"];
    const json& last = curve.back();
    said.push_back(fmt::format("On {}, {} reaches a {} of {} after {} s of {} ({} samples per pixel, {} seeds).", title,
                               base, metric, number(last[key]["mean"]),
                               number(last[r["clock"] == "cpu" ? "cpu" : "wall"]["mean"]), clock,
                               last["spp"].get<int>(), seeds));
  }
  std::vector<std::string> errors, disagree;
  for (const json& c : r["configurations"]) {
    if (c["name"] == base) continue;
    const std::string name = c["name"];
    const bool sooner = c["time_to_target"]["verdict"] == "faster";
    const json ratio = c["equal_samples"].is_object() ? c["equal_samples"]["ratio"] : json();
    if (ratio.is_object() && (sooner || ratio["high"] < 1 - kAlike || ratio["low"] > 1 + kAlike))
      errors.push_back(fmt::format(
          "{} {}{}", name, interval(ratio),
          c["pilot_apart"] > 0 ? fmt::format(" (its pilot of {:.3g} more not counted)", c["pilot_apart"].get<double>())
                               : ""));
    if (!sooner) continue;
    // a squared error is that of the few worst pixels; what most pixels show may say otherwise
    const json &own = c["curve"].back(), &other = baseline["curve"].back();
    if (own["spp"] == other["spp"] && own["mape"]["low"] > other["mape"]["high"])
      disagree.push_back(fmt::format("{} {}", name, number(own["mape"]["mean"])));
  }
  if (!errors.empty())
    said.push_back(fmt::format("At equal samples, errors in shares of that of {}: {}.", base, listed(errors)));
  if (!disagree.empty())
    said.push_back(
        fmt::format("By MAPE, which weighs the many small errors more, there is more error than of {} at equal samples "
                    "with {}; {} has {}.",
                    base, listed(disagree), base, number(baseline["curve"].back()["mape"]["mean"])));
  for (std::string& text : otherLight(r)) said.push_back(std::move(text));
  if (!biased.empty())
    said.push_back(fmt::format(
        "The mean over the seeds differs from the reference for {}: its error does not vanish with more samples.",
        listed(biased)));
  if (const json& reference = r["reference"]; reference["floor"]["relmse"].is_null())
    said.push_back(
        "The reference's own noise is not known for sure, and is not subtracted: curves flatten as they come near it.");
  if (!unclear.empty())
    said.push_back(
        fmt::format("Parts of the image differ from the reference for {}, as rare light does that few seeds have met: "
                    "whether it is "
                    "chance or bias, more seeds would tell.",
                    listed(unclear)));
  if (!heavy.empty())
    said.push_back(
        fmt::format("Rare large samples carry much of the error of {}: the comparison therefore leaves out the largest "
                    "0.1 % of the pixels of each image, and the curves show both.",
                    listed(heavy)));
  if (r["metric"] != "relmse" && r["configurations"].size() > 1) said.push_back(withAllPixels(r));
  if (r.contains("models"))
    for (const json& m : r["models"]) said.push_back(m["text"]);
  if (seeds < 16)
    said.push_back(fmt::format("There are only {} seeds; 16 or more make the intervals trustworthy.", seeds));
  if (r["wall_scattered"])
    said.push_back(std::string("Wall times of equal runs scattered by more than 15 % on this machine, ") +
                   (r["clock"] == "cpu" ? "so that times are the processor's."
                                        : "and not every renderer here tells its processor time: times and their "
                                          "ratios are rough, errors at equal samples are not touched by it."));
  if (r["complete"] == false) said.push_back("The study was stopped early; this is what was measured until then.");
  return said;
}

std::string mapRemark(const std::string& name, const std::string& baseline, const json& wins,
                      const json& timeToTarget) {
  if (!wins.is_object() || !timeToTarget.is_object()) return "";
  const double better = wins["better"], worse = wins["worse"];
  const bool sooner = timeToTarget["verdict"] == "faster", later = timeToTarget["verdict"] == "slower";
  if (!(sooner && worse > better) && !(later && better > worse)) return "";
  return fmt::format(
      "{} reaches the target {} than {}, although it is {} on more of the map ({:.3g} % better, {:.3g} % worse, "
      "{:.3g} % undecided): both are true, since the map counts each block alike, however small its error, "
      "whereas the target is a mean over the image, which the few blocks with the largest errors decide.",
      name, sooner ? "sooner" : "later", baseline, sooner ? "worse" : "better", 100 * better, 100 * worse,
      100 * wins["undecided"].get<double>());
}

}  // namespace wardmis
