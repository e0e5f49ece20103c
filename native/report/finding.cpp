// SPDX-License-Identifier: GPL-3.0-or-later
// The finding in words. It says no more than the intervals do.
#include <fmt/format.h>

#include <algorithm>

#include "report/analysis.h"

namespace wardmis {
namespace {

using nlohmann::json;

std::string number(double x) { return fmt::format("{:.3g}", x); }
std::string interval(const json& i) {
  return fmt::format("{:.2f} [{:.2f}, {:.2f}]", i["mean"].get<double>(), i["low"].get<double>(),
                     i["high"].get<double>());
}

std::string list(const std::vector<std::string>& parts) {
  std::string text;
  for (size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return text;
}

}  // namespace

std::vector<std::string> finding(const json& r) {
  std::vector<std::string> said;
  const std::string base = r["baseline"];
  const std::string metric = r["metric"] == "relmse" ? "relMSE" : "relMSE without the largest 0.1 %";
  const char* key = r["metric"] == "relmse" ? "relmse" : "relmse_trimmed";
  std::vector<std::string> slower, ties, unreached, biased, heavy;
  std::vector<std::pair<double, std::string>> faster;
  double best = 1;
  std::string bestName, target;
  for (const json& c : r["configurations"]) {
    const std::string name = c["name"];
    if (c["bias"].is_object() && c["bias"]["verdict"] == "biased") biased.push_back(name);
    if (c["tail"]["heavy"] == true) heavy.push_back(name);
    const json& t = c["time_to_target"];
    target = number(t["target"]);
    if (name == base) continue;
    if (t["verdict"] == "not reached") {
      unreached.push_back(name);
      continue;
    }
    const std::string text = fmt::format("{} in {}", name, interval(t["ratio"]));
    if (t["verdict"] == "faster") {
      faster.emplace_back(t["ratio"]["mean"], text);
      if (faster.back().first < best) best = faster.back().first, bestName = name;
    } else if (t["verdict"] == "slower") {
      slower.push_back(text);
    } else {
      ties.push_back(fmt::format("{} ({})", name, interval(t["ratio"])));
    }
  }
  const size_t seeds = r["seeds"].size();
  const char* clock = r["clock"] == "cpu" ? "processor time" : "time";
  if (r["configurations"].size() > 1) {
    std::sort(faster.begin(), faster.end());
    std::vector<std::string> texts;
    for (const auto& [ratio, text] : faster) texts.push_back(text);
    if (!faster.empty())
      said.push_back(fmt::format(
          "On {}, {} is the fastest to a {} of {}. Of the {} that {} takes, {} (95 % intervals over {} seeds).",
          r["title"].get<std::string>(), bestName, metric, target, clock, base,
          list(texts) + (texts.size() > 1 ? " reach it" : " reaches it"), seeds));
    else
      said.push_back(
          fmt::format("On {}, no configuration reaches a {} of {} sooner than {} (95 % intervals over {} seeds).",
                      r["title"].get<std::string>(), metric, target, base, seeds));
    if (!ties.empty()) said.push_back(fmt::format("No difference from {} is found for {}.", base, list(ties)));
    if (!slower.empty()) said.push_back(fmt::format("Slower: {} of its time.", list(slower)));
    if (!unreached.empty())
      said.push_back(fmt::format("Within its samples, {} did not reach that error.", list(unreached)));
  } else {
    const json& curve = r["configurations"][0]["curve"];
    const json& last = curve.back();
    said.push_back(fmt::format("On {}, {} reaches a {} of {} after {} s ({} samples per pixel, {} seeds).",
                               r["title"].get<std::string>(), base, metric, number(last[key]["mean"]),
                               number(last["wall"]["mean"]), last["spp"].get<int>(), seeds));
  }
  for (const json& c : r["configurations"]) {
    if (c["name"] != bestName || !c["equal_samples"].is_object() || !c["equal_samples"]["ratio"].is_object()) continue;
    said.push_back(fmt::format("At equal samples the error of {} is {} of that of {}.", bestName,
                               interval(c["equal_samples"]["ratio"]), base));
  }
  if (!biased.empty())
    said.push_back(fmt::format(
        "The mean over the seeds differs from the reference for {}: its error does not vanish with more samples.",
        list(biased)));
  if (!heavy.empty())
    said.push_back(
        fmt::format("Rare large samples carry much of the error of {}: the comparison therefore leaves out the largest "
                    "0.1 % of the pixels of each image, and the curves show both.",
                    list(heavy)));
  if (r.contains("models"))
    for (const json& m : r["models"]) said.push_back(m["text"]);
  if (seeds < 16)
    said.push_back(fmt::format("There are only {} seeds; 16 or more make the intervals trustworthy.", seeds));
  if (r["clock"] == "cpu")
    said.push_back(
        "Wall times of equal runs scattered by more than 15 % on this machine, so that times are the processor's.");
  if (r["complete"] == false) said.push_back("The study was stopped early; this is what was measured until then.");
  return said;
}

}  // namespace wardmis
