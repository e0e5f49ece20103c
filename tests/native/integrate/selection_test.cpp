// SPDX-License-Identifier: GPL-3.0-or-later
// Light chosen from very many pieces: the texels of a sky, the triangles of a mesh. The table that chooses is shared by
// every technique and every reference, so what it loses shows against values from outside alone. The seeds are fixed;
// an image is allowed five of its standard errors, which for other seeds would fail once in 1.7 million images.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <random>

#include "integrate/setup.h"
#include "scenes.h"
#include "world/environment.h"

namespace wardmis {
namespace {

using namespace test;
using Quadrature = boost::math::quadrature::gauss_kronrod<double, 61>;

constexpr double kPid = kPi<double>;

Measured radiance(const Scene& scene, SamplerType sampler, Weights weights, uint32_t spp) {
  RenderSettings s;
  s.spp = spp;
  s.integrator = Integrator::kDirect;
  s.sampler = sampler;
  s.allocation = Allocation::kEqual;
  s.weights = weights;
  s.threads = 2;
  return measure(renderScene(scene, s));
}

// L(u, v) = 1 + v + 200 e^-((u - 0.3)/0.02)^2 e^-((v - v0)/0.03)^2: a smooth sky with a spot ten degrees wide.
double spotU(double u) { return std::exp(-std::pow((u - 0.3) / 0.02, 2)); }
double skyAt(double u, double v, double v0) { return 1 + v + 200 * spotU(u) * std::exp(-std::pow((v - v0) / 0.03, 2)); }

void addSky(Scene& scene, int width, int height, double v0) {
  Image image;
  image.width = width, image.height = height, image.channels = 1;
  image.floats.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.floats.push_back(static_cast<float>(skyAt((x + 0.5) / width, (y + 0.5) / height, v0)));
  test::addSky(scene, std::move(image));
}

// Of a horizontal plane: integral of L cos over the upper half, v = 1 straight up, a full turn in u.
double irradiance(double v0) {
  const double turn = Quadrature::integrate(spotU, 0.0, 1.0, 15, 1e-12);
  return Quadrature::integrate(
      [&](double v) {
        const double theta = kPid * (1 - v);
        return 2 * kPid * (1 + v + 200 * turn * std::exp(-std::pow((v - v0) / 0.03, 2))) * std::cos(theta) *
               std::sin(theta) * kPid;
      },
      0.5, 1.0, 15, 1e-12);
}

// The light technique alone: the mean of L cos/pdf over 64 batches of 2^15 points.
Measured estimate(const Scene& scene, SamplerType type) {
  constexpr uint32_t kBatches = 64, kPoints = 1 << 15;
  const Environment sky(scene, scene.worlds[0]);
  const Sampler sampler(type, 1, kPoints);
  double sum = 0, square = 0;
  for (uint32_t batch = 0; batch < kBatches; ++batch) {
    double mean = 0;
    for (uint32_t k = 0; k < kPoints; ++k) {
      const Vec3f d = sky.sample(sampler.getChoice(sampler.pixelKey(batch, 0), 5, k)).direction;
      const Environment::Look look = sky.look(d);
      if (d.z > 0) mean += double(luminance(look.radiance) * d.z / look.pdf);
    }
    mean /= kPoints;
    sum += mean, square += mean * mean;
  }
  const double mean = sum / kBatches;
  return {mean, std::sqrt(std::max(0.0, square / kBatches - mean * mean) / (kBatches - 1))};
}

TEST(Selection, SkiesOfAnySizeGiveTheirIrradiance) {
  const double want = irradiance(0.8);
  const auto check = [&](int width, int height, std::initializer_list<SamplerType> samplers) {
    Scene scene;
    addSky(scene, width, height, 0.8);
    for (SamplerType type : samplers) {
      const Measured m = estimate(scene, type);
      RecordProperty(std::to_string(width) + std::string(name(type)), std::to_string(m.mean / want - 1));
      EXPECT_LT(m.error, 8e-4 * want);
      EXPECT_NEAR(m.mean, want, 5 * m.error + 5e-5 * want) << width << ' ' << name(type);
    }
  };
  for (const auto& [width, height] : {std::pair{256, 128}, {512, 256}, {1024, 512}, {4096, 1024}, {8192, 512}})
    check(width, height, {SamplerType::kSobol});
  check(2048, 1024, {SamplerType::kSobol, SamplerType::kIndependent, SamplerType::kStratified});
}

TEST(Selection, RendersGiveASkysIrradiance) {
  Scene scene = diffusePlane(16);
  addSky(scene, 2048, 1024, 0.8);
  const double want = irradiance(0.8) / kPid;
  for (Weights weights : {Weights::kBalance, Weights::kMaximum}) {
    const Measured m = radiance(scene, SamplerType::kSobol, weights, 512);
    EXPECT_LT(m.error, 2e-3 * want);
    EXPECT_NEAR(m.mean, want, 5 * m.error + 2e-4 * want) << int(weights);
  }
}

// A spot at the zenith lies in few, tiny cells of the table.
TEST(Selection, SpotsAtTheZenithKeepTheirLight) {
  Scene scene;
  addSky(scene, 2048, 1024, 1.0);
  const double want = irradiance(1.0);
  const Measured m = estimate(scene, SamplerType::kSobol);
  EXPECT_LT(m.error, 5e-4 * want);
  EXPECT_NEAR(m.mean, want, 5 * m.error + 5e-5 * want);
}

// A million emissive triangles whose strengths span seven powers of ten.
TEST(Selection, AMillionTrianglesGiveTheirIrradiance) {
  constexpr int kColumns = 1000, kRows = 500, kStrengths = 8;
  constexpr float kHeight = 1.5f;
  Scene scene = diffusePlane(16);
  scene.camera->toWorld.t = scene.camera->toWorld.z * 1.2f;  // below the mesh
  for (int s = 0; s < kStrengths; ++s) {
    Material m;
    m.name = "strength";
    const float e = std::pow(10.0f, static_cast<float>(s - 3));
    m.emission.value = {e, e, e};
    scene.materials.push_back(m);
  }
  std::vector<Vec3f> p;
  for (int y = 0; y <= kRows; ++y)
    for (int x = 0; x <= kColumns; ++x)
      p.push_back({2 * static_cast<float>(x) / kColumns - 1, 2 * static_cast<float>(y) / kRows - 1, kHeight});
  std::mt19937 random(1);
  std::array<std::vector<uint32_t>, kStrengths> indices;
  double want = 0;
  for (uint32_t y = 0; y < kRows; ++y)
    for (uint32_t x = 0; x < kColumns; ++x) {
      const uint32_t a = y * (kColumns + 1) + x, b = a + kColumns + 1;
      for (const auto& t : {std::array{a, a + 1, b}, std::array{a + 1, b + 1, b}}) {
        // one in 4^k of strength 10^k: all strengths matter
        const auto s = static_cast<size_t>(std::min(kStrengths - 1, std::countr_zero(uint32_t(random())) / 2));
        indices[s].insert(indices[s].end(), t.begin(), t.end());
        const Vec3f c = (p[t[0]] + p[t[1]] + p[t[2]]) / 3.0f;
        const double d2 = double(dot(c, c)), area = 2.0 / kColumns * 2.0 / kRows / 2;
        want += std::pow(10.0, double(s) - 3) * area * kHeight * kHeight / (d2 * d2) / kPid;
      }
    }
  MeshPart part;
  part.positions = Array<Vec3f>::of(std::move(p));
  for (size_t s = 0; s < kStrengths; ++s)
    part.primitives.push_back({static_cast<int>(s) + 1, Array<uint32_t>::of(std::move(indices[s]))});
  scene.meshes.push_back({"lamp", {part}});
  Instance i;
  i.name = "lamp";
  i.mesh = 1;
  scene.instances.push_back(i);
  for (SamplerType sampler : {SamplerType::kSobol, SamplerType::kIndependent}) {
    const Measured m = radiance(scene, sampler, Weights::kMaximum, 512);
    RecordProperty(std::string(name(sampler)), std::to_string(m.mean / want - 1));
    EXPECT_LT(m.error, 1e-2 * want);
    EXPECT_NEAR(m.mean, want, 5 * m.error + 2e-4 * want) << name(sampler);
  }
}

// A lamp whose image is black but for one texel: the grid that a triangle's strength is taken from may miss it, the
// light must not. (1000^2 texels on two triangles; the spot lies off every grid point.)
TEST(Selection, ATexelThatShinesIsAimedAt) {
  constexpr int kSide = 1000;
  Scene scene = diffusePlane(16);
  scene.camera->toWorld.t = scene.camera->toWorld.z * 1.2f;
  Image image;
  image.width = image.height = kSide, image.channels = 1;
  image.floats.assign(size_t{kSide} * kSide, 0);
  constexpr int kX = 613, kY = 204;
  image.floats[size_t{kY} * kSide + kX] = 1e6f;
  scene.images.push_back(std::move(image));
  Texture t;
  t.image = 0;
  t.filter = Filter::kNearest;
  scene.textures.push_back(t);
  Material m;
  m.name = "screen";
  m.emission.value = {1, 1, 1};
  m.emission.texture.texture = 0;
  scene.materials.push_back(m);
  addPlane(scene, 1, 1, 1.5f);
  scene.meshes.back().parts[0].uvs = Array<Vec2f>::of({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  RenderSettings s;
  s.spp = 2048;
  s.integrator = Integrator::kDirect;
  s.allocation = Allocation::kEqual;
  s.samplesPerHit = 16;
  const BuiltScene built(scene, 2);
  EXPECT_TRUE(built.emitters.any());
  EXPECT_EQ(built.emitters.emissiveTriangles(), 2u);
  // by 2^22 light samples, of which one in 10^6 meets the texel, it is found in some: its light is there, not its value
  const Measured found = measure(renderScene(scene, s));
  EXPECT_GT(found.mean, 0);
}

// The same sky looked up after a stretched and mirrored frame: against a quadrature of the directions.
TEST(Selection, AStretchedSkyKeepsItsLight) {
  Scene scene = diffusePlane(16);
  addSky(scene, 512, 256, 0.75);
  const float matrix[9] = {0.6f, 0.3f, 0, -0.5f, 1.9f, 0.2f, 0.1f, 0, -1.2f};
  std::copy_n(matrix, 9, worldOf(scene).matrix);
  double want = 0;
  constexpr int kRows = 1500, kColumns = 3000;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < kColumns; ++i) {
      const double z2 = (j + 0.5) / kRows, z = std::sqrt(z2), r = std::sqrt(1 - z2);  // cos z dz = dz^2/2
      const double phi = 2 * kPid * (i + 0.5) / kColumns;
      const double d[] = {r * std::cos(phi), r * std::sin(phi), z};
      double e[3];
      for (int k = 0; k < 3; ++k)
        e[k] = double(matrix[3 * k]) * d[0] + double(matrix[3 * k + 1]) * d[1] + double(matrix[3 * k + 2]) * d[2];
      const double u = (std::atan2(e[1], e[0]) - kPid) / (-2 * kPid);
      const double v = 1 - std::atan2(std::hypot(e[0], e[1]), e[2]) / kPid;
      want += skyAt(u, v, 0.75) / (double(kRows) * kColumns);
    }
  for (Weights weights : {Weights::kBalance, Weights::kMaximum}) {
    const Measured m = radiance(scene, SamplerType::kSobol, weights, 512);
    EXPECT_LT(m.error, 3e-3 * want);
    EXPECT_NEAR(m.mean, want, 5 * m.error + 1e-3 * want);  // the image has 256 rows
  }
}

// A mirror ball's image: smooth, with a spot that is 200 times as bright, near the rim or off it.
double ballAt(double x, double y, double x0) {
  return 1 + y + 200 * std::exp(-(std::pow(x - x0, 2) + std::pow(y - 0.5, 2)) / 0.0008);
}

Scene underABall(int size, double x0) {
  Scene scene = diffusePlane(16);
  Image image;
  image.width = image.height = size, image.channels = 1;
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      image.floats.push_back(static_cast<float>(ballAt((x + 0.5) / size, (y + 0.5) / size, x0)));
  test::addSky(scene, std::move(image));
  worldOf(scene).map = SkyMap::kMirrorBall;
  return scene;
}

// The ball's image is the disk of x, z of the half vector between the direction and the viewer at -y.
TEST(Selection, MirrorBallsGiveTheirIrradiance) {
  for (const double x0 : {0.6, 0.95}) {
    double want = 0;
    constexpr int kRows = 1000, kColumns = 1000;
    for (int j = 0; j < kRows; ++j)
      for (int i = 0; i < kColumns; ++i) {
        const double z2 = (j + 0.5) / kRows, z = std::sqrt(z2), r = std::sqrt(1 - z2);  // cos z dz = dz^2/2
        const double phi = 2 * kPid * (i + 0.5) / kColumns;
        const double x = r * std::cos(phi), y = r * std::sin(phi), half = std::sqrt(x * x + (y - 1) * (y - 1) + z2);
        want += ballAt(0.5 + 0.5 * x / half, 0.5 + 0.5 * z / half, x0) / (double(kRows) * kColumns);
      }
    const Scene scene = underABall(256, x0);
    const Measured light = estimate(scene, SamplerType::kSobol);
    EXPECT_LT(light.error, 2e-3 * want * kPid);
    EXPECT_NEAR(light.mean, want * kPid, 5 * light.error + 5e-4 * want * kPid) << x0;
    const Measured m = radiance(scene, SamplerType::kSobol, Weights::kBalance, 128);
    EXPECT_LT(m.error, 1e-2 * want);
    EXPECT_NEAR(m.mean, want, 5 * m.error + 1e-3 * want) << x0;
  }
}

// The density that is told is the one that is drawn from: the mean of 1/pdf is the sphere.
TEST(Selection, DensitiesOfAMirrorBallAreThoseOfItsDirections) {
  for (const int size : {7, 64, 800}) {
    Scene scene = underABall(size, 0.6);
    const float matrix[9] = {0.6f, 0.3f, 0, -0.5f, 1.9f, 0.2f, 0.1f, 0, -1.2f};
    for (const bool stretched : {false, true}) {
      if (stretched) std::copy_n(matrix, 9, worldOf(scene).matrix);
      const Environment sky(scene, scene.worlds[0]);
      const Sampler sampler(SamplerType::kSobol, 1, 1 << 12);
      double sum = 0, square = 0, up = 0;
      constexpr int kBatches = 16, kPoints = 1 << 12;
      for (uint32_t batch = 0; batch < kBatches; ++batch) {
        double mean = 0;
        for (uint32_t k = 0; k < kPoints; ++k) {
          const Vec3f d = sky.sample(sampler.getChoice(sampler.pixelKey(batch, 0), 5, k)).direction;
          mean += 1 / double(sky.look(d).pdf) / kPoints;
          up += (d.y > 0.2f) / double(sky.look(d).pdf) / (double(kPoints) * kBatches);
        }
        sum += mean, square += mean * mean;
      }
      const double mean = sum / kBatches;
      const double error = std::sqrt(std::max(0.0, square / kBatches - mean * mean) / (kBatches - 1));
      EXPECT_LT(error, 0.02 * mean);
      EXPECT_NEAR(mean, 4 * kPid, 5 * error + 1e-3) << size << ' ' << stretched;
      EXPECT_NEAR(up, 2 * kPid * 0.8, 0.05 * up) << size << ' ' << stretched;
    }
  }
}

}  // namespace
}  // namespace wardmis
