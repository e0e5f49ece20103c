// SPDX-License-Identifier: GPL-3.0-or-later
// The patterns against Cycles: tests/golden/patterns.json, made by make_patterns.py inside Blender 3.4, 4.3 and 5.2.
#include "golden.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "pattern/brick.h"
#include "pattern/gabor.h"
#include "pattern/magic.h"
#include "pattern/noise.h"
#include "pattern/simple.h"
#include "pattern/voronoi.h"
#include "pattern/wave.h"

namespace wardmis::pattern {
namespace {

using nlohmann::json;
using Values = std::map<std::string, std::vector<float>>;  // of the node's outputs

// A case's node: its properties and inputs by Blender's names, or what is given where the case does not set them.
class Node {
 public:
  explicit Node(const json& c) : case_(c) {}
  std::string kind() const { return case_["node"]; }
  Version version() const { return static_cast<Version>(case_["version"].get<int>()); }
  float input(const char* name, float otherwise) const { return case_["inputs"].value(name, otherwise); }
  Vec3f vector(const char* name, Vec3f otherwise) const {
    return case_["inputs"].contains(name) ? test::vec3<float>(case_["inputs"][name]) : otherwise;
  }
  template <class T>
  T property(const char* name, T otherwise) const {
    return case_["properties"].value(name, otherwise);
  }
  int dimensions(const char* name) const { return property<std::string>(name, "3D")[0] - '0'; }
  // Which of `names` the property is.
  template <class E>
  E choice(const char* property, std::initializer_list<const char*> names) const {
    const auto value = case_["properties"].value(property, std::string(*names.begin()));
    const auto at = std::find(names.begin(), names.end(), value);
    EXPECT_NE(at, names.end()) << property << " " << value;
    return static_cast<E>(at - names.begin());
  }

 private:
  const json& case_;
};

std::vector<float> list(Rgb c) { return {c.x, c.y, c.z}; }
FractalType fractalType(const Node& n, const char* property) {
  return n.choice<FractalType>(property,
                               {"FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN"});
}

Values noiseNode(const Node& n, Vec3f p, float w) {
  const NoiseSettings s{n.version(), n.dimensions("noise_dimensions"), fractalType(n, "noise_type"),
                        n.property("normalize", true)};
  NoiseInputs in;
  in = {n.input("Scale", in.scale),           n.input("Detail", in.detail), n.input("Roughness", in.roughness),
        n.input("Lacunarity", in.lacunarity), n.input("Offset", in.offset), n.input("Gain", in.gain),
        n.input("Distortion", in.distortion)};
  const Rgb color = noiseColor(s, in, p, w);
  EXPECT_EQ(color.x == color.x ? color.x : 0, color.x == color.x ? noiseFactor(s, in, p, w) : 0);
  return {{"Color", list(color)}};
}

Values musgraveNode(const Node& n, Vec3f p, float w) {
  MusgraveInputs in;
  in = {n.input("Scale", in.scale),           n.input("Detail", in.detail), n.input("Dimension", in.dimension),
        n.input("Lacunarity", in.lacunarity), n.input("Offset", in.offset), n.input("Gain", in.gain)};
  return {{"Fac", {musgrave(fractalType(n, "musgrave_type"), n.dimensions("musgrave_dimensions"), in, p, w)}}};
}

Values voronoiNode(const Node& n, Vec3f p, float w) {
  const VoronoiSettings s{
      n.version(), n.dimensions("voronoi_dimensions"),
      n.choice<VoronoiFeature>("feature", {"F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS"}),
      n.choice<VoronoiMetric>("distance", {"EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI"}),
      n.property("normalize", false)};
  VoronoiInputs in;
  in = {n.input("Scale", in.scale),           n.input("Detail", in.detail),         n.input("Roughness", in.roughness),
        n.input("Lacunarity", in.lacunarity), n.input("Smoothness", in.smoothness), n.input("Exponent", in.exponent),
        n.input("Randomness", in.randomness)};
  const VoronoiValue v = voronoi(s, in, p, w);
  return {{"Distance", {v.distance}},
          {"Color", list(v.color)},
          {"Position", list(v.position)},
          {"W", {v.w}},
          {"Radius", {v.radius}}};
}

Values waveNode(const Node& n, Vec3f p, float) {
  WaveSettings s{n.version(), n.choice<WaveShape>("wave_type", {"BANDS", "RINGS"}), WaveAxis::kX,
                 n.choice<WaveProfile>("wave_profile", {"SIN", "SAW", "TRI"})};
  s.axis = s.shape == WaveShape::kBands ? n.choice<WaveAxis>("bands_direction", {"X", "Y", "Z", "DIAGONAL"})
                                        : n.choice<WaveAxis>("rings_direction", {"X", "Y", "Z", "SPHERICAL"});
  WaveInputs in;
  in = {n.input("Scale", in.scale),
        n.input("Distortion", in.distortion),
        n.input("Detail", in.detail),
        n.input("Detail Scale", in.detailScale),
        n.input("Detail Roughness", in.detailRoughness),
        n.input("Phase Offset", in.phase)};
  return {{"Fac", {wave(s, in, p)}}};
}

Values magicNode(const Node& n, Vec3f p, float) {
  const Rgb c = magic(n.version(), n.property("turbulence_depth", 2), n.input("Scale", 5), n.input("Distortion", 1), p);
  return {{"Color", list(c)}, {"Fac", {(c.x + c.y + c.z) / 3}}};
}

Values brickNode(const Node& n, Vec3f p, float) {
  const BrickSettings s{n.version(), n.property("offset", 0.5f), n.property("squash", 1.0f),
                        n.property("offset_frequency", 2), n.property("squash_frequency", 2)};
  BrickInputs in;
  in = {n.vector("Color1", in.color1), n.vector("Color2", in.color2),         n.vector("Mortar", in.mortar),
        n.input("Scale", in.scale),    n.input("Mortar Size", in.mortarSize), n.input("Mortar Smooth", in.mortarSmooth),
        n.input("Bias", in.bias),      n.input("Brick Width", in.brickWidth), n.input("Row Height", in.rowHeight)};
  const BrickValue v = brick(s, in, p);
  return {{"Color", list(v.color)}, {"Fac", {v.factor}}};
}

Values gaborNode(const Node& n, Vec3f p, float) {
  GaborInputs in;
  in = {n.input("Scale", in.scale), n.input("Frequency", in.frequency), n.input("Anisotropy", in.anisotropy),
        n.input("Orientation 2D", in.orientation2d), n.vector("Orientation 3D", in.orientation3d)};
  const GaborValue v = gabor(n.dimensions("gabor_type"), in, p);
  return {{"Value", {v.value}}, {"Phase", {v.phase}}, {"Intensity", {v.intensity}}};
}

Values evaluate(const Node& n, Vec3f p, float w) {
  const std::string kind = n.kind();
  if (kind == "Noise") return noiseNode(n, p, w);
  if (kind == "Musgrave") return musgraveNode(n, p, w);
  if (kind == "Voronoi") return voronoiNode(n, p, w);
  if (kind == "Wave") return waveNode(n, p, w);
  if (kind == "Magic") return magicNode(n, p, w);
  if (kind == "Brick") return brickNode(n, p, w);
  if (kind == "Gabor") return gaborNode(n, p, w);
  if (kind == "Checker") return {{"Fac", {checker(n.input("Scale", 5), p)}}};
  if (kind == "Gradient") {
    const auto type = n.choice<GradientType>(
        "gradient_type", {"LINEAR", "QUADRATIC", "EASING", "DIAGONAL", "SPHERICAL", "QUADRATIC_SPHERE", "RADIAL"});
    return {{"Fac", {gradient(type, p)}}};
  }
  EXPECT_EQ(kind, "WhiteNoise");
  const int d = n.dimensions("noise_dimensions");
  return {{"Value", {whiteNoise(d, p, w)}}, {"Color", list(whiteNoiseColor(d, p, w))}};
}

// What the case asks of the node: up to three numbers. 0 is what a material makes of numbers that are not finite.
std::vector<float> channels(const json& c, const std::array<float, 4>& at) {
  Values found = evaluate(Node(c), {at[0], at[1], at[2]}, at[3]);
  std::vector<float> r;
  if (c["output"].is_string()) {
    r = found.at(c["output"]);
  } else {
    for (const json& o : c["output"]) r.push_back(found.at(o)[0]);
  }
  for (float& x : r) x = std::isfinite(x) ? x : 0;
  return r;
}

// How far each channel moves when one coordinate does by a float's last bit: what rounding in another order may do.
std::vector<float> sensitivity(const json& c, const std::array<float, 4>& at) {
  const std::vector<float> here = channels(c, at);
  std::vector<float> most(here.size(), 0);
  for (int d = 0; d < 4; d++) {
    for (float towards : {-INFINITY, INFINITY}) {
      std::array<float, 4> there = at;
      there[d] = std::nextafter(at[d], towards);
      const std::vector<float> moved = channels(c, there);
      for (size_t k = 0; k < here.size(); k++) most[k] = std::max(most[k], std::abs(moved[k] - here[k]));
    }
  }
  return most;
}

// Relative to the value, or to 1 where it is less. Noise is seen at 150, too, where the last bit of a float is 1.5e-5.
TEST(Patterns, EqualCycles) {
  const json golden = json::parse(std::ifstream(WARDMIS_TEST_DATA "/golden/patterns.json"));
  std::map<std::pair<std::string, int>, double> largest;  // near the origin
  for (const json& c : golden["cases"]) {
    const std::string node = c["node"];
    const double tolerance = node == "Noise" ? 1e-4 : 1e-5;
    for (size_t i = 0; i < golden["points"].size(); i++) {
      const auto at = golden["points"][i].get<std::array<float, 4>>();
      const float x = std::abs(at[0]);
      const bool far = x > 100 || c["inputs"].value("Detail", 0.0f) > 10;  // or so fine that it is as if
      // There a brick is as wide as the floats are spaced, and noise is of what the period's multiple rounds to.
      if ((node == "Brick" && x > 1e6f) || (node == "Noise" && x > 1e20f)) continue;
      const std::vector<float> found = channels(c, at), slack = far ? sensitivity(c, at) : std::vector<float>(3, 0);
      ASSERT_EQ(found.size(), c["values"][i].size());
      for (size_t k = 0; k < found.size(); k++) {
        const double expected = c["values"][i][k];
        const double difference = std::abs(found[k] - expected) / std::max(1.0, std::abs(expected));
        double& most = largest[{node, c["version"]}];
        if (!far) most = std::max(most, difference);
        EXPECT_LE(difference, tolerance + 4 * slack[k])
            << node << " of version " << c["version"] << " " << c["output"] << c["properties"] << c["inputs"]
            << "\nat point " << i << " " << golden["points"][i] << " channel " << k << ": " << found[k]
            << ", Cycles has " << expected;
      }
    }
  }
  for (const auto& [key, most] : largest)
    fmt::print("{}, version {}: within {:.1e} of Cycles\n", key.first, key.second, most);
}

}  // namespace
}  // namespace wardmis::pattern
