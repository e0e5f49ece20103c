// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/part.h"

#include <fmt/format.h>

#include <span>

#include "cli/statistics.h"
#include "film/part.h"
#include "math/error.h"
#include "math/hash.h"

namespace wardmis {
namespace {

using nlohmann::json;

// Whether they are as they were written, their hashes tell: that of the words is in the text, its own is beside it.
constexpr const char* kAttribute = "wardmis:part";
constexpr const char* kHashAttribute = "wardmis:part_hash";

std::string hashOf(const std::string& text) {
  Fnv1a hash;
  for (const char c : text) hash.add(static_cast<uint8_t>(c));
  return fmt::format("{:016x}", hash.value());
}
std::string hashOf(const std::vector<ExrWords>& words) {
  Fnv1a hash;
  for (const ExrWords& w : words) hash.add(std::span<const uint32_t>(w.values));
  return fmt::format("{:016x}", hash.value());
}

json toJson(const PassInfo& p) {
  return {{"name", p.name}, {"channels", p.channels}, {"group", p.group}, {"data", p.data}, {"light", p.light}};
}
PassInfo passOf(const json& j) { return {j.at("name"), j.at("channels"), j.at("group"), j.at("data"), j.at("light")}; }

constexpr const char* kRenderAgain = "another program may have written it anew; render the part again";
std::string damaged(const std::string& path) {
  return fmt::format("{}: is damaged: it is not as it was written", path);
}

}  // namespace

ExrImage toImage(const FilmBuffer& film, const ImageDescription& d) {
  return toPasses(film, d.passes, d.techniqueNames, d.layer, d.zUp);
}

void makePart(ExrImage& image, const FilmBuffer& film, json whole, const ImageDescription& d, const json& statistics,
              const json& pilotCounts) {
  json passes = json::array();
  for (const PassInfo& p : d.passes) passes.push_back(toJson(p));
  whole.update({{"version", WARDMIS_VERSION},
                {"width", film.width},
                {"height", film.height},
                {"settings", statistics.at("settings")},
                {"layer", d.layer},
                {"z_up", d.zUp},
                {"passes", passes},
                {"techniques", d.techniqueNames},
                {"transparent", film.transparent},
                {"keeps_data", !film.data.empty()},
                {"keeps_light", !film.light.empty()},
                {"keeps_catchers", !film.catchers.empty()}});
  image.words = wordsOf(film);
  const json part{{"from", film.first},       {"to", film.first + film.samples}, {"whole", std::move(whole)},
                  {"statistics", statistics}, {"pilot_counts", pilotCounts},     {"words", hashOf(image.words)}};
  image.attributes.emplace_back(kAttribute, dumped(part));
  image.attributes.emplace_back(kHashAttribute, hashOf(image.attributes.back().second));
}

uint32_t PartHeader::of() const { return whole.at("samples"); }

ImageDescription PartHeader::description() const {
  ImageDescription d{whole.at("layer"), whole.at("z_up"), {}, whole.at("techniques")};
  for (const json& p : whole.at("passes")) d.passes.push_back(passOf(p));
  return d;
}

PartHeader readPartHeader(const std::string& path) {
  std::string text, hash;
  for (const auto& [name, value] : readExrAttributes(path)) {
    if (name == kAttribute) text = value;
    if (name == kHashAttribute) hash = value;
  }
  if (!text.empty() && hashOf(text) != hash) throw Error(ExitCode::kFile, damaged(path), kRenderAgain);
  if (!text.empty()) try {
      json j = json::parse(text);
      PartHeader h{path,         {j.at("from"), j.at("to")}, j.at("whole"), j.at("statistics"), j.at("pilot_counts"),
                   j.at("words")};
      const ImageDescription made = h.description();  // it throws where something is missing
      if (h.range.from < h.range.to && h.range.to <= h.of() && !made.passes.empty()) return h;
    } catch (const json::exception&) {  // of another version
    }
  throw Error(ExitCode::kFile, fmt::format("{}: is no part of an image, or of another version", path),
              "parts are rendered by this version's 'wardmis render --samples FROM..TO'");
}

FilmBuffer readPart(const PartHeader& h) {
  const json& w = h.whole;
  const ExrImage image = readExr(h.path, kPartChannel);
  FilmBuffer film(w.at("width"), w.at("height"), w.at("techniques").size());
  film.transparent = w.at("transparent");
  film.first = h.range.from, film.samples = h.range.count();
  if (w.at("keeps_data")) film.data.resize(film.pixels.size());
  if (w.at("keeps_light")) film.light.resize(film.pixels.size());
  if (w.at("keeps_catchers")) film.catchers.resize(film.pixels.size());
  if (image.width != film.width || image.height != film.height || hashOf(image.words) != h.words ||
      !setWords(film, image.words))
    throw Error(ExitCode::kFile, damaged(h.path), kRenderAgain);
  return film;
}

}  // namespace wardmis
