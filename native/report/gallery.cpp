// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/gallery.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/way_pictures.h"

namespace wardmis {

using nlohmann::json;

std::vector<std::pair<std::string, ExrImage>> imageFiles(const Experiment& e, const std::vector<Measured>& measured) {
  std::vector<std::pair<std::string, ExrImage>> all;
  for (const Measured& m : measured) {
    ExrImage mean{e.width, e.height, {}, {}};
    for (size_t c = 0; c < 3; ++c) {
      mean.channels.push_back({std::string(1, "RGB"[c]), std::vector<float>(m.seeds.mean.pixels())});
      for (size_t i = 0; i < m.seeds.mean.pixels(); ++i) mean.channels[c].values[i] = m.seeds.mean.rgb[3 * i + c];
    }
    const std::string name = folderName(m.configuration->name);
    all.emplace_back(name + ".exr", std::move(mean));
    all.emplace_back(name + "-error.exr", ExrImage{e.width, e.height, {{"Y", m.rmsError}}, {}});
  }
  return all;
}

std::vector<Picture> gallery(const Experiment& e, const std::vector<Measured>& measured, const json& configurations) {
  const Measured& base = measured[e.baseline];
  std::vector<Picture> all;
  const int w = e.width, h = e.height;
  all.push_back(radiancePicture(
      {"reference", "reference", "image", "", fmt::format("The reference: {}.", base.reference->estimates)},
      base.reference->image));
  for (const Measured& m : measured)
    all.push_back(
        radiancePicture({m.configuration->name, m.configuration->name, "image", m.configuration->name,
                         fmt::format("One seed, {} samples per pixel.", m.runs->front().checkpoints.back().spp)},
                        m.first));
  for (const Measured& m : measured)
    if (m.configuration->external)
      all.push_back(radiancePicture({m.configuration->name + "/reference", m.configuration->name + ", converged",
                                     "image", m.configuration->name, "The converged image of the other renderer."},
                                    e.references[m.configuration->reference].image));
  // one scale for all errors: from the values of the baseline
  std::vector<float> sorted = base.rmsError;
  std::sort(sorted.begin(), sorted.end());
  const double top = std::max(1e-6, double(sorted[sorted.size() - 1 - sorted.size() / 200]));
  const double high = std::ceil(std::log10(top) * 4) / 4, low = high - 2.5;
  for (const Measured& m : measured) {
    const std::string& name = m.configuration->name;
    all.push_back(scalarPicture({name + "/error", name + ", error", "error", name,
                                 "Root mean square over the seeds of the relative error; the same scale for all."},
                                m.rmsError, w, h, low, high, true));
  }
  for (const Measured& m : measured) {
    if (m.configuration->external) continue;
    std::vector<float> shares(3 * static_cast<size_t>(w) * static_cast<size_t>(h));
    int present = 0;
    const size_t techniques = m.fractions.size();  // the last two are cosine and light
    for (size_t t = 0; t < techniques; ++t) {
      present += m.fractions[t].empty() ? 0 : 1;
      const size_t channel = t + 2 < techniques ? 0 : t + 3 - techniques;
      for (size_t i = 0; i < m.fractions[t].size(); ++i) shares[3 * i + channel] += m.fractions[t][i];
    }
    const std::string& name = m.configuration->name;
    if (present > 1)
      all.push_back(
          sharesPicture({name + "/allocation", name + ", allocation", "allocation", name,
                         "Shares of the samples at first hits: red the lobes, green the cosine, blue the light."},
                        shares, w, h));
  }
  for (size_t k = 0; k < e.ways.size(); ++k)
    for (Picture& p : wayPictures(e.configurations[k].name, e.ways[k])) all.push_back(std::move(p));
  for (size_t k = 0; k < measured.size(); ++k) {
    const Measured& m = measured[k];
    if (m.wins.empty()) continue;
    const Configuration& c = *m.configuration;
    const std::string remark = configurations[k]["wins"]["text"];
    all.push_back(classesPicture(
        {c.name + "/wins", c.name + " or " + base.configuration->name, "map", c.name,
         fmt::format("Where relMSE × {} time is less than with {}: blocks of {} × {} pixels, paired t-tests "
                     "over the seeds, false discoveries at most 5 %.{}{}",
                     m.effort == &Clocks::cpu ? "CPU" : "wall", base.configuration->name, kWinBlock, kWinBlock,
                     remark.empty() ? "" : " ", remark)},
        m.wins, w, h,
        {{c.name + " is better", "#0072B2"},
         {base.configuration->name + " is better", "#D55E00"},
         {"undecided", "#999999"}}));
  }
  for (const Measured& m : measured)
    all.push_back(scalarPicture(
        {m.configuration->name + "/bias", m.configuration->name + ", bias z", "map", m.configuration->name,
         "z of the mean of the seeds against the reference, by blocks; beyond ±6 or so is bias."},
        m.seeds.bias.z, w, h, -6, 6, false));
  std::vector<float> stiffness(e.survey.pixels.size());
  float most = 0;
  for (size_t i = 0; i < stiffness.size(); ++i)
    stiffness[i] = e.survey.pixels[i].stiffness > 0 ? e.survey.pixels[i].stiffness : std::nanf(""),
    most = std::max(most, e.survey.pixels[i].stiffness);
  if (most > 0)
    all.push_back(scalarPicture({"stiffness", "stiffness", "map", "",
                                 "Largest over smallest second moment of the techniques, at the first hit."},
                                stiffness, w, h, 0, std::max(1.0, std::ceil(std::log10(double(most)))), true));
  for (const Measured& m : measured)
    if (m.configuration->external) {
      const Reference &own = e.references[0], &other = e.references[m.configuration->reference];
      std::vector<float> d(own.image.pixels());
      for (size_t i = 0; i < d.size(); ++i)
        for (size_t c = 0; c < 3; ++c)
          d[i] += static_cast<float>((double(other.image.rgb[3 * i + c]) - double(own.image.rgb[3 * i + c])) /
                                     (std::abs(double(own.image.rgb[3 * i + c])) + kMapeEpsilon) / 3);
      all.push_back(scalarPicture(
          {m.configuration->name + "/model", m.configuration->name + " − WardMIS", "map", m.configuration->name,
           "Relative difference of the converged images: of the models, not an error."},
          d, w, h, -1, 1, false));
    }
  return all;
}

}  // namespace wardmis
