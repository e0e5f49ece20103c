// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/part.h"
#include "cli/paths.h"
#include "cli/statistics.h"
#include "cli/verbs.h"
#include "film/part.h"
#include "film/write_file.h"
#include "math/error.h"

namespace wardmis {
namespace {

using nlohmann::json;

struct Options {
  std::vector<std::string> parts;
  std::string output, stats;
};

std::string text(const SampleRange& r) { return fmt::format("{}..{}", r.from, r.to); }

// Names the first thing in which two parts are of different images.
void requireSame(const PartHeader& a, const PartHeader& b) {
  if (a.whole == b.whole) return;
  constexpr const char* kHint = "parts of one image differ in --samples alone";
  if (a.whole.at("scene") != b.whole.at("scene"))
    throw Error(ExitCode::kUsage, fmt::format("{}: is of another scene than {}", b.path, a.path), kHint);
  const json first = a.whole.flatten(), second = b.whole.flatten();
  json keys = first;
  keys.update(second);
  const auto in = [](const json& of, const std::string& key) {
    return of.contains(key) ? dumped(of[key]) : std::string("nothing");
  };
  for (const auto& item : keys.items()) {
    const std::string was = in(first, item.key()), is = in(second, item.key());
    if (was != is)
      throw Error(ExitCode::kUsage,
                  fmt::format("{}: its {} is {}, that of {} is {}", b.path, item.key().substr(1), is, a.path, was),
                  kHint);
  }
}

// They are in the order of their samples.
void requireAll(const std::vector<PartHeader>& parts) {
  SampleRange so;
  const std::string* last = nullptr;
  for (const PartHeader& p : parts) {
    if (p.range.from < so.to)
      throw Error(ExitCode::kUsage,
                  fmt::format("{}: samples {} are in {}, too", p.path,
                              text({p.range.from, std::min(so.to, p.range.to)}), *last),
                  "each sample may be in one part; leave one of them out");
    if (p.range.from > so.to)
      throw Error(ExitCode::kUsage, fmt::format("samples {} are in none of the parts", text({so.to, p.range.from})),
                  fmt::format("render them with --samples {}", text({so.to, p.range.from})));
    so.to = p.range.to;
    last = &p.path;
  }
  const uint32_t of = parts.front().of();
  if (so.to < of)
    throw Error(ExitCode::kUsage, fmt::format("samples {} are in none of the parts", text({so.to, of})),
                fmt::format("render them with --samples {}", text({so.to, of})));
}

// Adds the numbers of b, by `sign`, to those of a at the same places.
void add(json& a, const json& b, int sign = 1) {
  for (const auto& [key, value] : b.items()) {
    if (value.is_object())
      add(a[key], value, sign);
    else if (value.is_number_float())
      a[key] = a[key].get<double>() + sign * value.get<double>();
    else
      a[key] = a[key].get<int64_t>() + sign * value.get<int64_t>();
  }
}

json only(const json& from, std::initializer_list<const char*> keys) {
  json result;
  for (const char* key : keys) result[key] = from.at(key);
  return result;
}

// Those of the whole image. A pilot beside the image, which each part made anew, counts once; time is what all took.
json statisticsOf(const std::vector<PartHeader>& parts, const FilmBuffer& film) {
  json sum = parts.front().statistics;
  for (const PartHeader& p : parts) {
    const bool first = &p == &parts.front();
    if (!first) {
      add(sum, only(p.statistics, {"camera_paths", "samples", "rays", "counts", "seconds", "cpu_seconds"}));
      sum["threads"] = std::max(sum["threads"].get<int>(), p.statistics.at("threads").get<int>());
    }
    if (!first || sum["pilot_in_image"] == true) add(sum, p.pilotCounts, -1);
  }
  sum["samples_per_pixel"] = film.samples;
  sum["mean_variance"] = meanVariance(film);
  return sum;
}

int run(const Options& o) {
  checkWritable(o.output);
  checkNamedExr(o.output);
  checkDistinct({{"--output", o.output}, {"--stats", o.stats}});
  if (!o.stats.empty()) checkWritable(o.stats);
  std::vector<PartHeader> parts;
  for (const std::string& path : o.parts) {
    checkDistinct({{"PART", path}, {"--output", o.output}, {"--stats", o.stats}});
    parts.push_back(readPartHeader(path));
    requireSame(parts.front(), parts.back());
  }
  std::sort(parts.begin(), parts.end(),
            [](const PartHeader& a, const PartHeader& b) { return a.range.from < b.range.from; });
  requireAll(parts);
  FilmBuffer film = readPart(parts.front());
  for (size_t i = 1; i < parts.size(); ++i) append(film, readPart(parts[i]));
  const json statistics = statisticsOf(parts, film);
  ExrImage image = toImage(film, parts.front().description());
  describe(image, statistics);
  writeExr(o.output, image, true);
  if (!o.stats.empty()) writeFile(o.stats, dumped(statistics, 2) + '\n');
  fmt::print("{}: {} samples per pixel of {} parts, {:.2f} s of processor time, {} rays\n", o.output, film.samples,
             parts.size(),
             statistics["cpu_seconds"]["pilot"].get<double>() + statistics["cpu_seconds"]["render"].get<double>(),
             statistics["rays"]["total"].get<uint64_t>());
  return 0;
}

}  // namespace

Verb addMerge(CLI::App& app) {
  auto o = std::make_shared<Options>();
  app.add_option("PART", o->parts, "EXR files of 'wardmis render --samples', in any order")->required();
  app.add_option("-o,--output", o->output, "the EXR to write: as one render of all samples would, to the bit")
      ->required();
  app.add_option("--stats", o->stats, "write statistics to this JSON file");
  return [o] { return run(*o); };
}

}  // namespace wardmis
