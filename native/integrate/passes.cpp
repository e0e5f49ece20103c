// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/passes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <numeric>

namespace wardmis {
namespace {

using Value = std::array<float, 4>;
using Getter = std::function<Value(const FilmBuffer&, size_t pixel)>;

constexpr const char* kSamples = "samples";  // a pass that is not there unless it is asked for

struct PassSource {
  PassInfo info;
  Getter get;
};

template <class Sum>  // of three channels
Value meanOf(const FilmBuffer& f, size_t pixel, const Sum& sum) {
  const uint32_t n = f.count(pixel);
  const double s = n > 0 ? 1.0 / n : 0;
  return {static_cast<float>(sum[0] * s), static_cast<float>(sum[1] * s), static_cast<float>(sum[2] * s), 0};
}

const std::vector<PassSource>& sources() {
  static const std::vector<PassSource> all = {
      {{"Combined", "RGBA", "combined"}, [](const FilmBuffer& f, size_t i) -> Value { return f.combined(i); }},
      {{"Depth", "Z", "depth"},
       [](const FilmBuffer& f, size_t i) -> Value {
         return {f.pixels[i].depth, 0, 0, 0};
       }},
      {{"Normal", "XYZ", "normal"},
       [](const FilmBuffer& f, size_t i) -> Value { return meanOf(f, i, f.pixels[i].normal); }},
      {{"Albedo", "RGB", "albedo"},
       [](const FilmBuffer& f, size_t i) -> Value { return meanOf(f, i, f.pixels[i].albedo); }},
      {{"Variance", "RGB", "variance"},
       [](const FilmBuffer& f, size_t i) -> Value {
         const Rgb v = f.variance(f.pixels[i]);
         return {v.x, v.y, v.z, 0};
       }},
      {{"Samples", "X", kSamples},
       [](const FilmBuffer& f, size_t i) -> Value {
         return {static_cast<float>(f.count(i)), 0, 0, 0};
       }},
  };
  return all;
}

const std::vector<PassSource>& dataSources() {
  static const std::vector<PassSource> all = {
      {{"Position", "XYZ", "position", true},
       [](const FilmBuffer& f, size_t i) -> Value {
         const Vec3f p = f.data[i].position;
         return {p.x, p.y, p.z, 0};
       }},
      {{"UV", "UVA", "uv", true}, [](const FilmBuffer& f, size_t i) -> Value { return meanOf(f, i, f.data[i].uv); }},
      {{"Object Index", "X", "object-index", true},
       [](const FilmBuffer& f, size_t i) -> Value {
         return {f.data[i].objectIndex, 0, 0, 0};
       }},
      {{"Material Index", "X", "material-index", true},
       [](const FilmBuffer& f, size_t i) -> Value {
         return {f.data[i].materialIndex, 0, 0, 0};
       }},
      {{"Emission", "RGB", "emission", true},
       [](const FilmBuffer& f, size_t i) -> Value { return meanOf(f, i, f.data[i].emission); }},
      {{"Environment", "RGB", "environment", true},
       [](const FilmBuffer& f, size_t i) -> Value { return meanOf(f, i, f.data[i].environment); }},
  };
  return all;
}

// What arrives by what of it is sent on. Where a channel sends nothing on, as the mean of the others, so that light on
// a surface of pure red is white: as Cycles.
Value dividedBy(const RgbSum& a, const RgbSum& b) {
  std::array<double, 3> v{};
  double sum = 0;
  int n = 0;
  for (size_t i = 0; i < 3; ++i)
    if (b[i] != 0) v[i] = a[i] / b[i], sum += v[i], ++n;
  if (n > 0 && n < 3)
    for (size_t i = 0; i < 3; ++i)
      if (b[i] == 0) v[i] = sum / n;
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2]), 0};
}

const std::vector<PassSource>& lightSources() {
  static const std::vector<PassSource> all = [] {
    constexpr std::pair<const char*, const char*> kNames[kComponents] = {
        {"Diffuse", "diffuse"}, {"Glossy", "glossy"}, {"Transmission", "transmission"}};
    std::vector<PassSource> list;
    for (size_t c = 0; c < kComponents; ++c) {
      const std::string name = kNames[c].first, group = kNames[c].second;
      list.push_back({{name + " Direct", "RGB", group + "-direct", false, true}, [c](const FilmBuffer& f, size_t i) {
                        return dividedBy(f.light[i].direct[c], f.light[i].color[c]);
                      }});
      list.push_back(
          {{name + " Indirect", "RGB", group + "-indirect", false, true},
           [c](const FilmBuffer& f, size_t i) { return dividedBy(f.light[i].indirect[c], f.light[i].color[c]); }});
      list.push_back({{name + " Color", "RGB", group + "-color", false, true},
                      [c](const FilmBuffer& f, size_t i) { return meanOf(f, i, f.light[i].color[c]); }});
    }
    return list;
  }();
  return all;
}

PassSource sourceOf(const PassInfo& pass, const std::vector<std::string>& names) {
  if (pass.data || pass.light) {  // it may have another name
    const auto& of = pass.data ? dataSources() : lightSources();
    return {pass,
            std::find_if(of.begin(), of.end(), [&](const PassSource& s) { return s.info.group == pass.group; })->get};
  }
  for (size_t t = 0; t < names.size(); ++t)
    if (pass.name == allocationPass(names[t]))
      return {pass, [t](const FilmBuffer& f, size_t i) -> Value {
                const uint32_t* taken = &f.sampleCounts[i * f.techniques];
                const double sum = std::accumulate(taken, taken + f.techniques, 0.0);
                return {sum > 0 ? static_cast<float>(taken[t] / sum) : 0, 0, 0, 0};
              }};
  return *std::find_if(sources().begin(), sources().end(),
                       [&](const PassSource& s) { return s.info.name == pass.name; });
}

}  // namespace

std::string allocationPass(const std::string& technique) {
  std::string label = technique;
  label[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(label[0])));
  return "Allocation " + label;
}

std::vector<PassInfo> passesFor(TechniqueMask techniques, const std::vector<std::string>& names) {
  std::vector<PassInfo> result;
  for (const PassSource& s : sources())
    if (s.info.group != kSamples) result.push_back(s.info);
  for (size_t t = 0; t < names.size(); ++t)
    if (has(techniques, t)) result.push_back({allocationPass(names[t]), "X", "allocation"});
  return result;
}

std::vector<PassInfo> passesOnRequest() {
  std::vector<PassInfo> result;
  for (const PassSource& s : sources())
    if (s.info.group == kSamples) result.push_back(s.info);
  for (const PassSource& s : dataSources()) result.push_back(s.info);
  for (const PassSource& s : lightSources()) result.push_back(s.info);
  return result;
}

ExrImage toPasses(const FilmBuffer& film, const std::vector<PassInfo>& passes,
                  const std::vector<std::string>& techniqueNames, const std::string& layer, bool zUp) {
  ExrImage image{film.width, film.height, {}, {}};
  const size_t count = film.pixels.size(), width = static_cast<size_t>(film.width),
               height = static_cast<size_t>(film.height);
  for (const PassInfo& pass : passes) {
    const PassSource source = sourceOf(pass, techniqueNames);
    const size_t first = image.channels.size();
    for (char c : pass.channels)
      image.channels.push_back({layer + "." + pass.name + "." + c, std::vector<float>(count)});
    const bool turned = zUp && (pass.group == "normal" || pass.group == "position");
    tbb::parallel_for(size_t{0}, height, [&](size_t row) {
      for (size_t x = 0; x < width; ++x) {
        Value v = source.get(film, row * width + x);
        if (turned) v = {v[0], -v[2], v[1], 0};
        for (size_t c = 0; c < pass.channels.size(); ++c)
          image.channels[first + c].values[(height - 1 - row) * width + x] = v[c];
      }
    });
  }
  return image;
}

ExrImage enlarged(const ExrImage& image, int side, int width, int height) {
  ExrImage large{width, height, {}, image.attributes};
  // the film's rows begin at the bottom, the image's at the top
  const int beyond = image.height * side - height;
  for (const ExrChannel& c : image.channels) {
    ExrChannel& to = large.channels.emplace_back(ExrChannel{c.name, {}});
    to.values.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        to.values.push_back(c.values[static_cast<size_t>((y + beyond) / side) * static_cast<size_t>(image.width) +
                                     static_cast<size_t>(x / side)]);
  }
  return large;
}

}  // namespace wardmis
