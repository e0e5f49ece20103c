// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/part.h"

#include <fmt/format.h>

#include "cli/statistics.h"
#include "film/part.h"
#include "math/error.h"

namespace wardmis {
namespace {

using nlohmann::json;

constexpr const char* kAttribute = "wardmis:part";

json toJson(const PassInfo& p) {
  return {{"name", p.name}, {"channels", p.channels}, {"group", p.group}, {"data", p.data}, {"light", p.light}};
}
PassInfo passOf(const json& j) { return {j.at("name"), j.at("channels"), j.at("group"), j.at("data"), j.at("light")}; }

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
  const json part{{"from", film.first},
                  {"to", film.first + film.samples},
                  {"whole", std::move(whole)},
                  {"statistics", statistics},
                  {"pilot_counts", pilotCounts}};
  image.attributes.emplace_back(kAttribute, dumped(part));
  image.words = wordsOf(film);
}

uint32_t PartHeader::of() const { return whole.at("samples"); }

ImageDescription PartHeader::description() const {
  ImageDescription d{whole.at("layer"), whole.at("z_up"), {}, whole.at("techniques")};
  for (const json& p : whole.at("passes")) d.passes.push_back(passOf(p));
  return d;
}

PartHeader readPartHeader(const std::string& path) {
  for (const auto& [name, text] : readExrAttributes(path))
    if (name == kAttribute) try {
        json j = json::parse(text);
        PartHeader h{path, {j.at("from"), j.at("to")}, j.at("whole"), j.at("statistics"), j.at("pilot_counts")};
        const ImageDescription made = h.description();  // it throws where something is missing
        if (h.range.from < h.range.to && h.range.to <= h.of() && !made.passes.empty()) return h;
        break;
      } catch (const json::exception&) {
        break;
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
  if (image.width != film.width || image.height != film.height || !setWords(film, image.words))
    throw Error(ExitCode::kFile, fmt::format("{}: its sums do not fit its header", h.path),
                "another program may have written it anew; render the part again");
  return film;
}

}  // namespace wardmis
