// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/way_pictures.h"

#include <fmt/format.h>

#include <map>

namespace wardmis {
namespace {

// Rows that are shown: up to the longest paths that have a hundredth of the variance.
int rowsOf(const WaySurvey& survey) {
  std::map<int, double> variance;
  for (const WaySurvey::Way& way : survey.ways) variance[way.surfaces] += way.variance;
  int rows = 1;
  for (const auto& [surfaces, share] : variance)
    if (share > 0.01) rows = surfaces;
  return rows;
}

RgbImage pyramid(const WaySurvey& survey, std::vector<Rgb> WaySurvey::Way::*part) {
  const int rows = rowsOf(survey), columns = rows + 1;
  RgbImage image{columns * survey.width, rows * survey.height, {}};
  image.rgb.resize(3 * static_cast<size_t>(image.width) * static_cast<size_t>(image.height));
  for (const WaySurvey::Way& way : survey.ways) {
    if (way.surfaces > rows) continue;
    const int x0 = (way.surfaces - way.byCamera) * survey.width, y0 = (way.surfaces - 1) * survey.height;
    for (int y = 0; y < survey.height; ++y)
      for (int x = 0; x < survey.width; ++x) {
        const Rgb c = (way.*part)[static_cast<size_t>(y) * static_cast<size_t>(survey.width) + static_cast<size_t>(x)];
        float* const to = &image.rgb[3 * (static_cast<size_t>(y0 + y) * static_cast<size_t>(image.width) +
                                          static_cast<size_t>(x0 + x))];
        to[0] = c.x, to[1] = c.y, to[2] = c.z;
      }
  }
  return image;
}

}  // namespace

nlohmann::json waysJson(const WaySurvey& survey, int samplesPerHit) {
  if (survey.ways.empty()) return {};
  nlohmann::json list = nlohmann::json::array();
  const int rows = rowsOf(survey);
  for (const WaySurvey::Way& way : survey.ways)
    if (way.surfaces <= rows)
      list.push_back({{"surfaces", way.surfaces},
                      {"by_camera", way.byCamera},
                      {"samples", way.samples},
                      {"variance", way.variance},
                      {"cost", way.cost}});
  return {{"samples_at_hit", survey.counts.atHit * samplesPerHit},
          {"light_paths", survey.counts.paths},
          {"connections", survey.counts.connections},
          {"later_connections", survey.counts.laterConnections},
          {"samples", survey.samples},
          {"width", survey.width},
          {"height", survey.height},
          {"list", list}};
}

std::vector<Picture> wayPictures(const std::string& name, const WaySurvey& survey) {
  if (survey.ways.empty()) return {};
  const std::string rows =
      "A row for each length of paths, one surface on top; from left to right a light makes one more of them, on the "
      "right all but the lens.";
  return {radiancePicture({name + "/ways", name + ", ways", "ways", name,
                           fmt::format("What each way to make a path brings, with its weight: they sum up to the "
                                       "image. {} {} samples per pixel.",
                                       rows, survey.samples)},
                          pyramid(survey, &WaySurvey::Way::weighted)),
          radiancePicture({name + "/ways alone", name + ", ways alone", "ways", name,
                           "The same without a weight: each as if there were no other. " + rows},
                          pyramid(survey, &WaySurvey::Way::alone))};
}

}  // namespace wardmis
