// SPDX-License-Identifier: GPL-3.0-or-later
// Paths from both ends against paths from the camera alone: the same image, whatever carries it.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <map>

#include "integrate/light_paths.h"
#include "integrate/way_survey.h"
#include "scenes.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

struct Case {
  const char* name;
  Scene scene;
};

Material matte(Rgb c) { return ward(c, {0, 0, 0}, 0.1f, WardVariant::kWardGmd); }

Light pointLamp(Vec3f at, float radius, float power = 6) {
  Light l;
  l.type = LightType::kPoint;
  l.toWorld.t = at;
  l.emitted = {power, power * 0.8f, power * 0.6f};
  l.radius = radius;
  return l;
}

// A square of the half size about `at` that faces n.
void addWall(Scene& scene, Vec3f at, Vec3f n, float half, int material) {
  const Framef f = Framef::around(n);
  addMesh(scene, {at - (f.x + f.y) * half, at + (f.x - f.y) * half, at + (f.x + f.y) * half, at + (f.y - f.x) * half},
          {0, 1, 2, 0, 2, 3}, material);
}

void addBall(Scene& scene, Vec3f at, float radius, int material) {
  addSphere(scene, 24, material);
  scene.instances.back().toWorld = {{radius, 0, 0}, {0, radius, 0}, {0, 0, radius}, at};
}

// A floor with a wall, seen from above.
Scene corner(const Material& floor, const Material& wall) {
  Scene scene;
  scene.materials = {floor, wall};
  addPlane(scene, 2, 0);
  addWall(scene, {-1, 0, 1}, normalize(Vec3f{1, 0, 0.2f}), 1.5f, 1);
  lookFrom(scene, 0.5f, 1, 16);
  return scene;
}

void lookThroughLens(Scene& scene, float radius) {
  Camera& c = *scene.camera;
  c.projection = Projection::kPerspective;
  c.toWorld.t = c.toWorld.z * 5;
  c.left = c.bottom = -0.25f, c.right = c.top = 0.25f;
  c.lensRadius = radius, c.focusDistance = 4.5f;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const Material white = matte({0.8f, 0.7f, 0.6f}),
                 shiny = ward({0.3f, 0.3f, 0.3f}, {0.5f, 0.6f, 0.6f}, 0.2f, WardVariant::kWardGmd);
  const auto add = [&](const char* name, Scene scene) { all.push_back({name, std::move(scene)}); };
  Scene point = corner(white, white);
  point.lights = {pointLamp({0.5f, 0.2f, 1}, 0)};
  add("point", point);
  Scene ball = corner(white, shiny);
  ball.lights = {pointLamp({0.5f, 0.2f, 1}, 0.2f)};
  add("ball", ball);
  Scene lens = ball;
  lookThroughLens(lens, 0.2f);
  lens.film.filter = FilterType::kGaussian, lens.film.filterWidth = 1.5f;
  add("lens", lens);
  Scene mesh = corner(shiny, white);
  mesh.materials.push_back({});
  mesh.materials.back().emission.value = {3, 4, 5};
  addWall(mesh, {0.8f, 0.3f, 0.7f}, normalize(Vec3f{-1, 0, 0.3f}), 0.3f, 2);
  add("mesh", mesh);
  Scene area = corner(shiny, shiny);
  Light square;
  square.type = LightType::kArea;
  square.toWorld = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.2f, 0, 1.2f}};
  square.sizeX = 0.5f, square.sizeY = 0.3f;
  square.emitted = {5, 5, 4};
  area.lights = {square};
  add("area", area);
  Scene sun = corner(white, shiny);
  Light far;
  far.type = LightType::kSun;
  far.toWorld = {{0, 1, 0}, {0, 0, 1}, normalize(Vec3f{1, 0.2f, 0.6f}), {0, 0, 0}};
  far.angle = 0.2f, far.emitted = {2, 2, 2};
  sun.lights = {far};
  add("sun", sun);
  Scene sky = corner(white, shiny);
  addCosineSky(sky, 32);
  add("sky", sky);
  Scene several = ball;
  several.lights.push_back(square), several.lights.push_back(far);
  add("several", several);
  // a mirror on the wall, and matte paint under it
  Scene mirror = corner(white, material({rough(closure(ClosureType::kGlossy, {0.8f, 0.9f, 1}, 0.6f), 0),
                                         closure(ClosureType::kDiffuse, {1, 0.5f, 0.5f}, 0.4f)}));
  mirror.lights = {pointLamp({0.5f, 0.2f, 1}, 0.3f)};
  add("mirror", mirror);
  const Material glass = material({rough(closure(ClosureType::kGlass, {0.9f, 1, 0.9f}), 0)});
  Scene burning = corner(white, white);
  burning.materials.push_back(glass);
  burning.lights = {pointLamp({0.3f, 0, 1.4f}, 0.25f)};
  addBall(burning, {0.2f, 0, 0.5f}, 0.35f, 2);
  add("glass ball", burning);
  Scene shade = burning;
  shade.lights = {pointLamp({0.2f, 0, 0.5f}, 0.15f)};
  add("lamp in glass", shade);
  return all;
}

RenderSettings settings(Integrator integrator, uint32_t spp) {
  RenderSettings s;
  s.integrator = integrator;
  s.allocation = Allocation::kEqual;
  s.weights = Weights::kBalance;
  s.integrand = Integrand::kJoint;
  s.sampler = SamplerType::kIndependent;
  s.pixels = PixelSamples::kEven;
  s.spp = spp, s.maxDepth = 4, s.threads = 2;
  return s;
}

// Means over blocks of 4 x 4 pixels with their errors, from renders of other seeds.
struct Blocks {
  std::vector<double> mean, error;
};
Blocks blocks(const Scene& scene, RenderSettings s, int renders) {
  constexpr int kSide = 4;
  const int across = scene.film.width / kSide;
  Blocks b{std::vector<double>(static_cast<size_t>(across * across)), {}};
  std::vector<double> square(b.mean.size());
  for (int r = 0; r < renders; ++r) {
    s.seed = 100 + static_cast<uint64_t>(r);
    const FilmBuffer film = renderScene(scene, s);
    std::vector<double> one(b.mean.size());
    for (int y = 0; y < film.height; ++y)
      for (int x = 0; x < film.width; ++x)
        one[static_cast<size_t>(y / kSide * across + x / kSide)] +=
            double(luminance(film.mean(film.at(x, y)))) / (kSide * kSide);
    for (size_t i = 0; i < one.size(); ++i) b.mean[i] += one[i] / renders, square[i] += one[i] * one[i] / renders;
  }
  for (size_t i = 0; i < square.size(); ++i)
    b.error.push_back(std::sqrt(std::max(square[i] - b.mean[i] * b.mean[i], 0.0) / (renders - 1)));
  return b;
}

double worstZ(const Blocks& a, const Blocks& b) {
  double worst = 0;
  for (size_t i = 0; i < a.mean.size(); ++i)
    worst = std::max(worst, std::abs(a.mean[i] - b.mean[i]) / std::hypot(a.error[i], b.error[i]));
  return worst;
}

// A lamp over a floor, and one in a box without a lid, under a ceiling.
Scene lampUnderCeiling(bool boxed) {
  const Material white = matte({0.8f, 0.8f, 0.8f});
  Scene scene;
  scene.materials = {white};
  addPlane(scene, 3, 0);
  if (boxed) addWall(scene, {0, 0, 3}, {0, 0, -1}, 3, 0);
  if (boxed)
    for (const Vec3f n : {Vec3f{1, 0, 0}, Vec3f{-1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, -1, 0}})
      addWall(scene, Vec3f{0, 0, 1} - n * 0.3f, n, 0.3f, 0);
  if (boxed) addWall(scene, {0, 0, 0.7f}, {0, 0, 1}, 0.3f, 0);
  scene.lights = {pointLamp({0, 0, 0.8f}, 0.05f)};
  lookFrom(scene, 0.8f, 1, 32);
  scene.camera->clipNear = 47;  // from below the ceiling
  return scene;
}

struct Ways {
  const char* name;
  FromLights from;
};

// Of 11 scenes, 16 blocks and 4 ways: |t| with 15 degrees of freedom beyond 5.5 comes once in 23 seeds.
TEST(Bidirectional, ShowsWhatPathsFromTheCameraShow) {
  const Ways ways[] = {
      {"both", {}}, {"connections", {1, 1, 1, false}}, {"film", {1, 0, 0, true}}, {"many", {4, 3, 2, true}}};
  for (const auto& [name, scene] : cases()) {
    const Blocks expected = blocks(scene, settings(Integrator::kPath, 64), 16);
    for (const Ways& way : ways) {
      RenderSettings s = settings(Integrator::kBidirectional, 16);
      s.fromLights = way.from;
      const Blocks got = blocks(scene, s, 16);
      EXPECT_LT(worstZ(got, expected), 5.5) << name << ", " << way.name;
    }
  }
}

// Forty sets of options, each with one of eight scenes. |t| with 15 degrees of freedom beyond 6 in one of 640 blocks
// comes once in 65 seeds.
TEST(Bidirectional, NoOptionsChangeWhatIsSeen) {
  constexpr int kSets = 40, kRenders = 16;
  const std::vector<Case> all = cases();
  const size_t chosen[] = {1, 2, 3, 5, 7, 8, 9, 10};
  std::map<std::pair<size_t, int>, Blocks> expected;  // by scene and depth
  test::Random random(77);
  const auto any = [&](auto&& list) { return list[static_cast<size_t>(random.uniform() * double(std::size(list)))]; };
  for (int k = 0; k < kSets; ++k) {
    const size_t at = chosen[static_cast<size_t>(k) % std::size(chosen)];
    const auto& [name, scene] = all[at];
    RenderSettings s = settings(Integrator::kBidirectional, 16);
    s.maxDepth = any(std::array{3, 5});
    s.fromLights.paths = any(std::array{0.1, 0.5, 1.0, 2.0});
    s.fromLights.connections = any(std::array{0, 1, 3});
    s.fromLights.laterConnections = any(std::array{0, 1, 2});
    s.fromLights.film = s.fromLights.connections + s.fromLights.laterConnections == 0 || random.uniform() < 0.7;
    s.weights = any(std::array{Weights::kBalance, Weights::kPower, Weights::kVarianceAware});
    s.allocation = any(std::array{Allocation::kEqual, Allocation::kEqual, Allocation::kAlbedo, Allocation::kAuto,
                                  Allocation::kVariance, Allocation::kStandardDeviation, Allocation::kSecondMoment,
                                  Allocation::kInverseVariance, Allocation::kRepresentativity});
    s.sampler = any(std::array{SamplerType::kIndependent, SamplerType::kStratified, SamplerType::kSobol});
    s.samplesPerHit = any(std::array{2, 3, 6, 9});
    auto found = expected.find({at, s.maxDepth});
    if (found == expected.end()) {
      RenderSettings reference = settings(Integrator::kPath, 96);
      reference.maxDepth = s.maxDepth;
      found = expected.emplace(std::pair{at, s.maxDepth}, blocks(scene, reference, kRenders)).first;
    }
    EXPECT_LT(worstZ(blocks(scene, s, kRenders), found->second), 6)
        << name << ", set " << k << ": " << wardmis::name(s.allocation) << ' ' << wardmis::name(*s.weights) << ' '
        << s.fromLights.paths << ' ' << s.fromLights.connections << ' ' << s.fromLights.laterConnections << ' '
        << s.fromLights.film;
  }
}

// Of rough surfaces every way finds all light of paths with as many surfaces: alone what all ways bring together. |t|
// with 15 degrees of freedom beyond 5.5 in one of 80 comes once in 200 seeds.
TEST(Bidirectional, EachWayAloneFindsAllLight) {
  constexpr int kRenders = 16;
  std::vector<Case> all = cases();
  all.resize(8);  // without sharp lobes
  for (const auto& [name, scene] : all) {
    RenderSettings s = settings(Integrator::kBidirectional, 16);
    s.maxDepth = 3;
    const BuiltScene built(scene, 2);
    std::vector<std::vector<double>> difference;  // by way, then seed
    std::vector<double> sum;
    for (int r = 0; r < kRenders; ++r) {
      s.seed = 500 + static_cast<uint64_t>(r);
      const WaySurvey survey = surveyWays(built, s, 64, 16);
      ASSERT_EQ(survey.ways.size(), 9u);
      difference.resize(survey.ways.size()), sum.resize(survey.ways.size());
      const auto mean = [](const std::vector<Rgb>& image) {
        double total = 0;
        for (const Rgb& c : image) total += double(luminance(c)) / double(image.size());
        return total;
      };
      std::array<double, 4> together{};
      for (const WaySurvey::Way& way : survey.ways) together[static_cast<size_t>(way.surfaces)] += mean(way.weighted);
      for (size_t w = 0; w < survey.ways.size(); ++w) {
        const double expected = together[static_cast<size_t>(survey.ways[w].surfaces)];
        difference[w].push_back(mean(survey.ways[w].alone) - expected), sum[w] += expected / kRenders;
      }
    }
    for (size_t w = 0; w < difference.size(); ++w) {
      double mean = 0, square = 0;
      for (const double d : difference[w]) mean += d / kRenders, square += d * d / kRenders;
      const double error = std::sqrt(std::max(square - mean * mean, 0.0) / (kRenders - 1));
      EXPECT_LT(std::abs(mean), 5.5 * error + 1e-6 * sum[w]) << name << " way " << w << ": " << mean / sum[w];
    }
  }
}

// Light traced to the film, alone, of a lamp over a floor: its irradiance is known at each point. |z| < 4.5 by accident
// once in 75000 seeds.
TEST(Bidirectional, TracedLightHasTheKnownIrradiance) {
  Scene scene;
  scene.materials = {matte({0.7f, 0.7f, 0.7f})};
  addPlane(scene, 2, 0);
  lookFrom(scene, 0.5f, 0.6f, 16);
  const Vec3f lamp{0.3f, 0.2f, 0.8f};
  scene.lights = {pointLamp(lamp, 0)};
  scene.lights[0].emitted = {5, 5, 5};
  constexpr int kSteps = 400;  // midpoints over the image
  const Affine& camera = scene.camera->toWorld;
  double expected = 0;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      const auto at = [](int k) { return 0.6f * (2 * (static_cast<float>(k) + 0.5f) / kSteps - 1); };
      const Vec3f p = camera.x * at(i) + camera.y * at(j), to = lamp - (p - camera.z * (p.z / camera.z.z));
      expected += 0.7 / kPi<double> * 5 * double(to.z) / std::pow(double(dot(to, to)), 1.5) / (kSteps * kSteps);
    }
  RenderSettings s = settings(Integrator::kBidirectional, 64);
  s.maxDepth = 1;
  const BuiltScene built(scene, 2);
  double mean = 0, square = 0;
  constexpr int kRenders = 64;
  for (int r = 0; r < kRenders; ++r) {
    s.seed = static_cast<uint64_t>(r);
    const WaySurvey survey = surveyWays(built, s, 192, 16);
    double one = 0;
    for (const Rgb& c : survey.ways[WayImages::index(1, 0)].alone) one += double(luminance(c)) / (16 * 16);
    mean += one / kRenders, square += one * one / kRenders;
  }
  const double error = std::sqrt((square - mean * mean) / (kRenders - 1));
  EXPECT_LT(error, 0.002 * expected);
  EXPECT_LT(std::abs(mean - expected), 4.5 * error) << mean / expected;
}

// White surfaces that lose nothing look like the sky around them, whichever end their light comes from: .5 % are the
// noise.
TEST(Bidirectional, WhiteSurfacesVanishInAWhiteSky) {
  Image white;
  white.width = 4, white.height = 8, white.channels = 3;
  white.floats.assign(3 * 4 * 8, 1);
  for (const auto& [name, closures] : std::vector<std::pair<const char*, std::vector<Closure>>>{
           {"diffuse", {closure(ClosureType::kDiffuse)}},
           {"glass", {rough(closure(ClosureType::kGlass), 0)}},
           {"translucent and diffuse",
            {closure(ClosureType::kTranslucent, {1, 1, 1}, 0.5f), closure(ClosureType::kDiffuse, {1, 1, 1}, 0.5f)}},
           {"mirror and diffuse",
            {rough(closure(ClosureType::kGlossy, {1, 1, 1}, 0.3f), 0),
             closure(ClosureType::kDiffuse, {1, 1, 1}, 0.7f)}}}) {
    Scene scene;
    scene.materials = {material(closures), matte({1, 1, 1})};
    addSphere(scene, 24, 0);
    addWall(scene, {0, 0, -1.2f}, {0, 0, 1}, 2, 1);
    lookFrom(scene, 0.7f, 1, 8);
    addSky(scene, white);
    RenderSettings s = settings(Integrator::kBidirectional, 256);
    s.maxDepth = 64;
    s.fromLights.paths = 4;
    Statistics statistics;
    const Measured all = measure(renderScene(scene, s, &statistics));
    EXPECT_TRUE(statistics.ways.has_value());
    EXPECT_NEAR(all.mean, 1, 5e-3) << name;
    EXPECT_LT(all.error, 5e-3) << name;
  }
}

bool same(const FilmBuffer& a, const FilmBuffer& b) {
  for (size_t i = 0; i < a.pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c)
      if (a.pixels[i].sum[c] != b.pixels[i].sum[c] || a.pixels[i].squares[c] != b.pixels[i].squares[c]) return false;
  return a.pixels.size() == b.pixels.size();
}

// More paths than are kept, so that they come in lots.
TEST(Bidirectional, ImagesAreThoseOfAnyThreads) {
  for (auto& [name, scene] : cases()) {
    RenderSettings s = settings(Integrator::kBidirectional, 3);
    s.sampler = SamplerType::kSobol;
    s.fromLights.paths = 2.0 * kMostKeptPaths / (16 * 16) + 0.5;
    if (std::string(name) != "lens") s.fromLights.paths = 2;
    s.threads = 1;
    const FilmBuffer one = renderScene(scene, s);
    for (const int threads : {2, 7}) {
      s.threads = threads;
      EXPECT_TRUE(same(one, renderScene(scene, s))) << name << ' ' << threads;
    }
  }
}

// A pilot, too, is the same for each part, by any threads.
TEST(Bidirectional, PartsAreThoseOfTheWhole) {
  for (const Allocation rule : {Allocation::kEqual, Allocation::kAuto, Allocation::kVariance}) {
    const Scene scene = rule == Allocation::kAuto ? lampUnderCeiling(true) : cases()[2].scene;
    RenderSettings s = settings(Integrator::kBidirectional, 100);
    s.allocation = rule;
    const FilmBuffer whole = renderScene(scene, s);
    s.part = SampleRange{0, 3}, s.threads = 1;
    const FilmBuffer first = renderScene(scene, s);
    s.part = SampleRange{3, 100}, s.threads = 7;
    const FilmBuffer second = renderScene(scene, s);
    for (size_t i = 0; i < whole.pixels.size(); ++i) {
      RgbSum sum = first.pixels[i].sum;
      sum += second.pixels[i].sum;
      for (size_t c = 0; c < 3; ++c) ASSERT_EQ(sum[c], whole.pixels[i].sum[c]) << name(rule);
    }
  }
}

TEST(Bidirectional, AutomaticTakesLightPathsWhereTheyPay) {
  for (const bool boxed : {false, true}) {
    RenderSettings s = settings(Integrator::kBidirectional, 32);
    s.allocation = Allocation::kAuto;
    Statistics statistics;
    renderScene(lampUnderCeiling(boxed), s, &statistics);
    EXPECT_EQ(statistics.ways.has_value(), boxed) << statistics.wayGain;
    EXPECT_GE(statistics.wayGain, 1);
  }
}

// Numbers by a pilot, of `auto` for each pixel, change what carries the light and not what is seen. |t| with 15 degrees
// of freedom beyond 5.5 in one of 256 blocks comes once in 64 seeds.
TEST(Bidirectional, PilotsShowTheSame) {
  Scene scene = lampUnderCeiling(true);
  scene.lights.push_back(pointLamp({0.8f, 0.8f, 0.4f}, 0.05f, 1));  // one that is seen
  RenderSettings s = settings(Integrator::kBidirectional, 16);
  const Blocks expected = blocks(scene, s, 16);
  for (const Allocation rule : {Allocation::kAuto, Allocation::kVariance}) {
    s.allocation = rule;
    Statistics statistics;
    renderScene(scene, s, &statistics);
    ASSERT_TRUE(statistics.ways.has_value());
    if (rule == Allocation::kAuto) {  // not one number for all
      const WayCounts& n = *statistics.ways;
      double parts = 0;
      for (const double each : {n.atHit * s.samplesPerHit, n.connections, n.laterConnections})
        parts += std::abs(each - std::round(each));
      EXPECT_GT(parts, 0.01);
    }
    for (const Weights weights : {Weights::kBalance, Weights::kVarianceAware}) {
      s.weights = weights;
      const Blocks got = blocks(scene, s, 16);
      EXPECT_LT(worstZ(got, expected), 5.5) << name(rule) << ' ' << name(weights);
    }
  }
  // a group that is not asked for has no share
  s.weights = Weights::kBalance, s.fromLights.connections = 0;
  Statistics statistics;
  renderScene(scene, s, &statistics);
  ASSERT_TRUE(statistics.ways.has_value());
  EXPECT_EQ(statistics.ways->connections, 0);
}

TEST(Bidirectional, EndsAsItIsAskedTo) {
  const Scene scene = lampUnderCeiling(true);
  RenderSettings s = settings(Integrator::kBidirectional, 1 << 20);
  s.allocation = Allocation::kAuto;
  Statistics statistics;
  const auto seconds = [&] { return statistics.pilotSeconds + statistics.renderSeconds; };
  s.seconds = 0.5;
  EXPECT_GT(renderScene(scene, s, &statistics).samples, 1u);
  EXPECT_TRUE(statistics.ways.has_value());
  EXPECT_LT(seconds(), 1.0);
  s.seconds = 0, s.targetError = 0.05, statistics = {};
  const FilmBuffer good = renderScene(scene, s, &statistics);
  ASSERT_TRUE(statistics.error.has_value());
  EXPECT_LE(statistics.error->upper, s.targetError);
  EXPECT_LT(good.samples, 1u << 12);
  s.targetError = 0;
  // what is seen on the way, and the end that somebody asks for then
  for (const Stop how : {Stop::kKeep, Stop::kDiscard}) {
    std::atomic<Stop> stop{Stop::kNo};
    int seen = 0;
    RenderObserver observer;
    observer.stop = &stop;
    observer.image = [&](const FilmBuffer& film, int side) {
      if (side > 1) return;
      ++seen;
      if (film.samples >= 2) stop = how;
    };
    statistics = {};
    const FilmBuffer film = render(scene, s, statistics, observer);
    EXPECT_GT(seen, 0);
    EXPECT_GE(film.samples, 2u);
    EXPECT_LT(film.samples, 1u << 12);
  }
}

// Bytes that the process has in memory.
double resident() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * 4096;
}

TEST(Bidirectional, ManyFramesTakeNoMoreMemory) {
  constexpr int kFrames = 250;
  Scene scene = cases()[1].scene;
  RenderSettings s = settings(Integrator::kBidirectional, 1);
  s.allocation = Allocation::kAuto, s.weights = Weights::kVarianceAware;
  s.fromLights.paths = 64;
  double before = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    if (frame == 50) before = resident();
    s.allocation = frame % 2 == 0 ? Allocation::kAuto : Allocation::kEqual;
    s.seed = static_cast<uint64_t>(frame);
    scene.lights[0].toWorld.t.x = 0.5f - 0.001f * static_cast<float>(frame);
    renderScene(scene, s);
  }
  EXPECT_LT(resident() - before, 4e6);
}

// Where nothing is to be had by them, the image is that of paths from the camera.
TEST(Bidirectional, WithoutLightsThatSendPathsItIsThePath) {
  Scene scene = cases()[1].scene;
  scene.lights.clear();
  worldOf(scene).radiance = {1, 1, 1};
  Statistics statistics;
  RenderSettings s = settings(Integrator::kBidirectional, 4);
  const FilmBuffer film = renderScene(scene, s, &statistics);
  s.integrator = Integrator::kPath;
  EXPECT_TRUE(same(film, renderScene(scene, s)));
  EXPECT_FALSE(statistics.ways.has_value());
  EXPECT_TRUE(std::ranges::any_of(statistics.leftOut,
                                  [](const std::string& l) { return l.starts_with("no paths from lights"); }));
}

}  // namespace
}  // namespace wardmis
