// SPDX-License-Identifier: GPL-3.0-or-later
// What operations compute: against tests/golden/operations.json (numpy, double precision), and exact cases.
#include "program/run.h"

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>

#include "pattern/brick.h"
#include "pattern/gabor.h"
#include "pattern/magic.h"
#include "pattern/noise.h"
#include "pattern/simple.h"
#include "pattern/voronoi.h"
#include "pattern/wave.h"
#include "programs.h"

namespace wardmis {
namespace {

using namespace test;

void expectNear(const json& operations, const std::vector<double>& expected, const ShadingContext& context = {},
                TextureAccess textures = {}, double tolerance = 2e-6) {
  const std::vector<float> found = values(operations, context, textures);
  ASSERT_EQ(found.size(), expected.size()) << operations;
  for (size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], tolerance * std::max(1.0, std::abs(expected[i])))
        << operations << " [" << i << "]";
}

TEST(Run, AgreesWithNumpy) {
  std::ifstream file(WARDMIS_TEST_DATA "/golden/operations.json");
  const json cases = json::parse(file);
  std::set<std::string> names;
  for (json c : cases) {
    const json out = c["out"];
    c.erase("out");
    names.insert(c["op"]);
    const auto expected = out.is_array() ? out.get<std::vector<double>>() : std::vector<double>{out.get<double>()};
    expectNear(json::array({c}), expected, {}, {}, 3e-5);
  }
  EXPECT_GE(names.size(), 129u);
}

// By slots of two kinds and as constants, in one program.
TEST(Run, TakesArgumentsFromLiteralsAndFromValues) {
  expectNear({{{"op", "combine"}, {"in", {0.5, 2, -1}}},
              {{"op", "vector-scale"}, {"in", {{{"result", 0}}, 2}}},
              {{"op", "y"}, {"in", {{{"result", 1}}}}},
              {{"op", "combine"}, {"in", {4, {{"result", 2}}, 0}}},
              {{"op", "mix"}, {"in", {0.25, {{"result", 1}}, {{"result", 3}}}}}},
             {0.75 * 1 + 0.25 * 4, 4, -1.5});
}

// Patterns get their arguments and settings in the right places: against the functions themselves, whose values are
// tested in tests/native/pattern.
TEST(Run, PatternsAreGivenTheirArguments) {
  using namespace pattern;
  const Vec3f p{0.3f, -1.7f, 2.1f};
  const json v{0.3f, -1.7f, 2.1f};
  const auto expect = [&](const char* name, json in, json parameters, const std::vector<float>& expected) {
    in.insert(in.begin(), v);
    parameters["op"] = name;
    parameters["in"] = in;
    EXPECT_EQ(values(json::array({parameters})), expected) << name;
  };
  const auto list = [](Vec3f c) { return std::vector<float>{c.x, c.y, c.z}; };
  const NoiseSettings ns{Version::kBlender4, 4, FractalType::kRidgedMultifractal, false};
  const NoiseInputs ni{1.5f, 3.25f, 0.75f, 2.5f, 0.875f, 1.25f, 0.5f};
  const json noiseIn{0.375, 1.5, 3.25, 0.75, 2.5, 0.875, 1.25, 0.5},
      noiseSet{{"dimensions", 4}, {"type", "ridged-multifractal"}, {"normalize", false}, {"version", 4}};
  expect("noise", noiseIn, noiseSet, {noiseFactor(ns, ni, p, 0.375f)});
  expect("noise-color", noiseIn, noiseSet, list(noiseColor(ns, ni, p, 0.375f)));
  expect("musgrave", {0.375, 1.5, 3.25, 0.75, 2.5, 0.875, 1.25}, {{"dimensions", 2}, {"type", "hetero-terrain"}},
         {musgrave(FractalType::kHeteroTerrain, 2, {1.5f, 3.25f, 0.75f, 2.5f, 0.875f, 1.25f}, p, 0.375f)});
  const VoronoiSettings vs{Version::kBlender5, 4, VoronoiFeature::kSmoothF1, VoronoiMetric::kMinkowski, true};
  const VoronoiValue voronoiValue = voronoi(vs, {1.5f, 1.25f, 0.75f, 2.5f, 0.25f, 0.5f, 0.875f}, p, 0.375f);
  const json voronoiIn{0.375, 1.5, 1.25, 0.75, 2.5, 0.25, 0.5, 0.875},
      voronoiSet{{"dimensions", 4}, {"feature", "smooth-f1"}, {"metric", "minkowski"}, {"normalize", true}};
  expect("voronoi-distance", voronoiIn, voronoiSet, {voronoiValue.distance});
  expect("voronoi-color", voronoiIn, voronoiSet, list(voronoiValue.color));
  expect("voronoi-position", voronoiIn, voronoiSet, list(voronoiValue.position));
  expect("voronoi-w", voronoiIn, voronoiSet, {voronoiValue.w});
  VoronoiSettings radius = vs;
  radius.feature = VoronoiFeature::kNSphereRadius;
  expect("voronoi-radius", voronoiIn, {{"dimensions", 4}, {"feature", "n-sphere-radius"}, {"metric", "minkowski"}},
         {voronoi(radius, {1.5f, 1.25f, 0.75f, 2.5f, 0.25f, 0.5f, 0.875f}, p, 0.375f).radius});
  const GaborValue gaborValue = gabor(3, {1.5f, 2.5f, 0.75f, 0.5f, {1, 2, 3}}, p);
  const json gaborIn{1.5, 2.5, 0.75, 0.5, {1, 2, 3}};
  expect("gabor-value", gaborIn, {{"dimensions", 3}}, {gaborValue.value});
  expect("gabor-phase", gaborIn, {{"dimensions", 3}}, {gaborValue.phase});
  expect("gabor-intensity", gaborIn, {{"dimensions", 3}}, {gaborValue.intensity});
  expect("wave", {1.5, 0.75, 2.5, 1.25, 0.375, 0.5},
         {{"shape", "rings"}, {"axis", "y"}, {"profile", "triangle"}, {"version", 3}},
         {wave({Version::kBlender3, WaveShape::kRings, WaveAxis::kY, WaveProfile::kTriangle},
               {1.5f, 0.75f, 2.5f, 1.25f, 0.375f, 0.5f}, p)});
  expect("magic", {1.5, 0.75}, {{"depth", 5}, {"version", 4}}, list(magic(Version::kBlender4, 5, 1.5f, 0.75f, p)));
  expect("checker", {1.5}, json::object(), {checker(1.5f, p)});
  expect("gradient", json::array(), {{"type", "radial"}}, {gradient(GradientType::kRadial, p)});
  expect("white-noise", {0.375}, {{"dimensions", 1}}, {whiteNoise(1, p, 0.375f)});
  expect("white-noise-color", {0.375}, {{"dimensions", 4}}, list(whiteNoiseColor(4, p, 0.375f)));
  const BrickSettings bs{Version::kBlender3, 0.25f, 0.75f, 3, 4};
  const BrickInputs bi{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1.5f, 0.5f, 0.75f, -0.25f, 0.625f, 0.875f};
  const json brickSet{
      {"offset", 0.25}, {"offsetFrequency", 3}, {"squash", 0.75}, {"squashFrequency", 4}, {"version", 3}};
  expect("brick", {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 1.5, 0.5, 0.75, -0.25, 0.625, 0.875}, brickSet,
         list(brick(bs, bi, p).color));
  expect("brick-factor", {1.5, 0.5, 0.75, -0.25, 0.625, 0.875}, brickSet, {brick(bs, bi, p).factor});
}

// Every operation comes to an end, within what it may read and write, whatever its arguments are.
TEST(Run, IsDefinedForEveryNumber) {
  const float kValues[] = {0, -0.0f, 1, -1, 1e-30f, 1e30f, -1e30f, INFINITY, -INFINITY, NAN};
  const Image texels{"", 2, 2, 4, false, {}, Texels<float>(16, 0.5f), false};
  const Texture texture{0, Wrap::kMirror, Wrap::kClip, Filter::kCubic};
  uint32_t state = 1;
  ShadingContext context;
  context.attributes[0].components = 4;
  for (const OperationInfo& o : kOperations) {
    Program p;
    p.instructions = {{static_cast<Operation>(&o - kOperations), 0, 0, 0}};
    p.tables = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
    p.textures = {0};
    p.attributes = {{ProgramAttribute::Kind::kNamed, ""}};
    for (const Parameter& parameter : o.parameters) {
      const bool number = parameter.kind == ParameterKind::kNumber;
      p.parameters.push_back(number ? std::bit_cast<uint32_t>(parameter.fallback)
                                    : static_cast<uint32_t>(parameter.fallback));
      if (parameter.kind == ParameterKind::kTexture) p.parameters.push_back(0);
      if (parameter.kind == ParameterKind::kTable) p.parameters.push_back(2);
    }
    for (size_t i = 0; i < o.arguments.size(); ++i) p.arguments.push_back(static_cast<uint16_t>(kLiteral | (3 * i)));
    p.literals.resize(30);
    for (int round = 0; round < 300; ++round) {
      for (float& v : p.literals) v = kValues[((state = state * 1664525 + 1013904223) >> 16) % std::size(kValues)];
      Slots slots;
      slots.fill(77);
      run(p, context, {&texture, &texels}, slots);
      for (int k = floatsOf(o.result); k < 10; ++k) ASSERT_EQ(slots[static_cast<size_t>(k)], 77) << o.name;
    }
  }
}

// What a program of 20 usual operations takes: printed, and bounded loosely, since test machines are shared.
TEST(Run, TwentyOperationsTakeLittleTime) {
  const json operations = {
      {{"op", "uv"}},
      {{"op", "mapping"}, {"in", {{{"result", 0}}}}, {"matrix", {4, 0, 0, 0, 0, 4, 0, 0, 0, 0, 4, 0}}},
      {{"op", "x"}, {"in", {{{"result", 1}}}}},
      {{"op", "y"}, {"in", {{{"result", 1}}}}},
      {{"op", "fraction"}, {"in", {{{"result", 2}}}}},
      {{"op", "fraction"}, {"in", {{{"result", 3}}}}},
      {{"op", "subtract"}, {"in", {{{"result", 4}}, 0.5}}},
      {{"op", "subtract"}, {"in", {{{"result", 5}}, 0.5}}},
      {{"op", "multiply"}, {"in", {{{"result", 6}}, {{"result", 6}}}}},
      {{"op", "multiply-add"}, {"in", {{{"result", 7}}, {{"result", 7}}, {{"result", 8}}}}},
      {{"op", "sqrt"}, {"in", {{{"result", 9}}}}},
      {{"op", "map-range"}, {"in", {{{"result", 10}}, 0, 0.5, 0, 1}}, {"clamp", true}},
      {{"op", "ramp"}, {"in", {{{"result", 11}}}}, {"table", {{0, 0, 0, 1}, {1, 0.5, 0, 1}, {1, 1, 1, 1}}}},
      {{"op", "mix-multiply"}, {"in", {0.5, {{"result", 12}}, {0.8, 0.7, 0.6}}}},
      {{"op", "bright-contrast"}, {"in", {{{"result", 13}}, 0.1, 0.2}}},
      {{"op", "vector-add"}, {"in", {{{"result", 14}}, {0.1, 0, 0}}}},
      {{"op", "invert"}, {"in", {0.5, {{"result", 15}}}}},
      {{"op", "luminance"}, {"in", {{{"result", 16}}}}},
      {{"op", "maximum"}, {"in", {{{"result", 17}}, 0.1}}},
      {{"op", "mix"}, {"in", {{{"result", 18}}, {{"result", 16}}, {{"result", 12}}}}}};
  const std::shared_ptr<Program> p = program(operations);
  ASSERT_EQ(p->instructions.size(), 20u);
  ShadingContext context;
  context.attributes[0].components = 2;
  Slots slots;
  float sum = 0;
  double best = 1;
  constexpr int kRuns = 1000;
  for (int round = 0; round < 200; ++round) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < kRuns; ++i) {
      context.attributes[0].xyz.value = {static_cast<float>(i) * 0.01f, 0.3f, 0};
      run(*p, context, {}, slots);
      sum += slots[p->results[0]];
    }
    best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() / kRuns);
  }
  EXPECT_TRUE(std::isfinite(sum));
  std::printf("a program of 20 operations: %.0f ns\n", best * 1e9);
  RecordProperty("nanoseconds", static_cast<int>(best * 1e9));
#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__)
  EXPECT_LT(best, 1e-6);
#endif
}

}  // namespace
}  // namespace wardmis
