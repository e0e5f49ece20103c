// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/passes.h"

#include <functional>

namespace wardmis {
namespace {

using Value = std::array<float, 4>;
using Getter = std::function<Value(const FilmBuffer&, const Pixel&)>;

struct PassSource {
  PassInfo info;
  TechniqueMask technique;  // the pass exists if the scene has it; 0: always
  Getter get;
};

Value share(const Pixel& p, Technique t) {
  const double sum = double(p.techniques[0]) + p.techniques[1] + p.techniques[2];
  return {sum > 0 ? static_cast<float>(p.techniques[t] / sum) : 0, 0, 0, 0};
}

const std::vector<PassSource>& sources() {
  static const std::vector<PassSource> all = {
      {{"Combined", "RGBA", "combined"},
       0,
       [](const FilmBuffer& f, const Pixel& p) -> Value {
         const Rgb c = f.mean(p);
         return {c.x, c.y, c.z, f.samples > 0 ? p.alpha / static_cast<float>(f.samples) : 0};
       }},
      {{"Depth", "Z", "depth"},
       0,
       [](const FilmBuffer&, const Pixel& p) -> Value {
         return {p.depth, 0, 0, 0};
       }},
      {{"Normal", "XYZ", "normal"},
       0,
       [](const FilmBuffer& f, const Pixel& p) -> Value {
         const float s = f.samples > 0 ? 1 / static_cast<float>(f.samples) : 0;
         return {p.normal.x * s, p.normal.y * s, p.normal.z * s, 0};
       }},
      {{"Albedo", "RGB", "albedo"},
       0,
       [](const FilmBuffer& f, const Pixel& p) -> Value {
         const float s = f.samples > 0 ? 1 / static_cast<float>(f.samples) : 0;
         return {p.albedo.x * s, p.albedo.y * s, p.albedo.z * s, 0};
       }},
      {{"Variance", "RGB", "variance"},
       0,
       [](const FilmBuffer& f, const Pixel& p) -> Value {
         const Rgb v = f.variance(p);
         return {v.x, v.y, v.z, 0};
       }},
      {{"Allocation Lobe", "X", "allocation"},
       maskOf(kLobe),
       [](const FilmBuffer&, const Pixel& p) { return share(p, kLobe); }},
      {{"Allocation Cosine", "X", "allocation"},
       maskOf(kCosine),
       [](const FilmBuffer&, const Pixel& p) { return share(p, kCosine); }},
      {{"Allocation Light", "X", "allocation"},
       maskOf(kLight),
       [](const FilmBuffer&, const Pixel& p) { return share(p, kLight); }},
  };
  return all;
}

}  // namespace

std::vector<PassInfo> passesFor(TechniqueMask techniques) {
  std::vector<PassInfo> result;
  for (const PassSource& s : sources())
    if (s.technique == 0 || (s.technique & techniques) != 0) result.push_back(s.info);
  return result;
}

ExrImage toPasses(const FilmBuffer& film, const std::vector<PassInfo>& passes, const std::string& layer, bool zUp) {
  ExrImage image{film.width, film.height, {}, {}};
  const size_t count = film.pixels.size(), width = static_cast<size_t>(film.width);
  for (const PassInfo& pass : passes) {
    const auto source =
        std::find_if(sources().begin(), sources().end(), [&](const PassSource& s) { return s.info.name == pass.name; });
    const size_t first = image.channels.size();
    for (char c : pass.channels)
      image.channels.push_back({layer + "." + pass.name + "." + c, std::vector<float>(count)});
    for (size_t i = 0; i < count; ++i) {
      const size_t row = i / width, flipped = (static_cast<size_t>(film.height) - 1 - row) * width + i % width;
      Value v = source->get(film, film.pixels[i]);
      if (zUp && pass.group == "normal") v = {v[0], -v[2], v[1], 0};
      for (size_t c = 0; c < pass.channels.size(); ++c) image.channels[first + c].values[flipped] = v[c];
    }
  }
  return image;
}

}  // namespace wardmis
