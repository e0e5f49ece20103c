// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/environment.h"

#include <tbb/parallel_for.h>

#include <cmath>
#include <cstring>

#include "math/number.h"
#include "math/warp.h"
#include "scene/inputs.h"

namespace wardmis {
namespace {

// Equirectangular coordinates of a direction of any length, z up (docs/scene-format.md): u = 1/2 at +x... as Cycles.
float heightOf(Vec3f d) {
  return 1 - atan2(std::sqrt(d.x * d.x + d.y * d.y), d.z) * (1 / kPi<float>);  // acos is coarse at the poles
}
Vec2f equirectangular(Vec3f d) { return {0.5f - atan2(d.y, d.x) * (0.5f / kPi<float>), heightOf(d)}; }

// Those of a mirror ball about z, seen from -z: its disk has the same area for each solid angle, its radius at the
// angle t from -z is sin(t/2).
Vec2f mirrorBall(Vec3f d) {
  const float h2 = d.x * d.x + d.y * d.y, z = d.z / std::sqrt(h2 + d.z * d.z);
  // sin(t/2)/sin t, without a difference of what is nearly equal
  const float scale = z < 0    ? 1 / std::sqrt(2 * (1 - z) * (h2 + d.z * d.z))
                      : h2 > 0 ? std::sqrt((1 + z) / (2 * h2))
                               : 0;
  return {0.5f + 0.5f * d.y * scale, 0.5f + 0.5f * d.x * scale};
}

// What directions are drawn by: as in Cycles all channels alike, since light that its samples of lights alone find
// (lobe.h) is weighed by its density.
constexpr float drawnAs(Rgb c) {
  const Rgb a = absolute(c);
  return (a.x + a.y + a.z) / 3;
}

constexpr int kMaxTableWidth = 2048, kMaxTableHeight = 1024;

}  // namespace

Environment::Environment(const Scene& scene, const World& world) : scene_(scene), world_(world) {
  // a mirror ball's axis is y: turned to z
  for (int i = 0; i < 9; ++i) matrix_[i] = world.matrix[world.map == SkyMap::kMirrorBall ? (i + 6) % 9 : i];
  const float* m = matrix_;
  // inverse by cofactors; the reader has seen to it that the matrix is not singular
  const float c[9] = {m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                      m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                      m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
  const float det = m[0] * c[0] + m[1] * c[3] + m[2] * c[6];
  for (int i = 0; i < 9; ++i) inverse_[i] = c[i] / det;
  determinant_ = std::abs(det);

  exists_ = !isBlack(world.radiance);
  if (world.coneAngle > 0) {
    const Vec3f z = world.coneAxis;
    axis_ = scene.zUp ? Vec3f{z.x, z.z, -z.y} : z;
    const float s = std::sin(0.25f * world.coneAngle);
    oneMinusCos_ = 2 * s * s;
  }
  if (!exists_ || (world.visibility & kSeenBySurfaces) == 0) return;
  if (oneMinusCos_ > 0)
    measureCone();
  else if (world.program)
    tabulateProgram();
  else if (world.texture >= 0)
    tabulateImage();
  else
    integral_ = 4 * kPi<float> * strength(world.radiance);
}

// What it shines on the average over points of the cone.
void Environment::measureCone() {
  constexpr int kPoints = 16;  // a side
  double sum = 0;
  for (int y = 0; y < kPoints; ++y)
    for (int x = 0; x < kPoints; ++x) {
      const ChoicePoint u{(x + 0.5) / kPoints, (static_cast<float>(y) + 0.5f) / kPoints};
      sum += double(strength(radiance(sample(u).direction)));
    }
  integral_ = static_cast<float>(sum / (kPoints * kPoints) * 2 * kPi<double> * double(oneMinusCos_));
}

void Environment::makeBands() {
  for (int y = 0; y < height_; ++y) {
    const bool up = 2 * y >= height_;
    const double step = kPi<double> / height_, from = step * (up ? height_ - 1 - y : y);
    const auto fromPole = [](double angle) { return 2 * std::pow(std::sin(angle / 2), 2); };
    const double height = 2 * std::sin(from + step / 2) * std::sin(step / 2);
    bands_.push_back({static_cast<float>(fromPole(from)), static_cast<float>(height), up,
                      static_cast<float>(width_ / (2 * kPi<double> * height))});
  }
}

// The table's cells hold what the program makes of a grid of directions, four to a cell, its borders among them. What
// shines between them alone is left to the surface's techniques; every cell has a chance, so that they are not the only
// ones that find it.
void Environment::tabulateProgram() {
  width_ = 512, height_ = 256;
  for (const uint32_t t : world_.program->textures) {
    const Image& image = scene_.images[static_cast<size_t>(scene_.textures[t].image)];
    width_ = std::clamp(image.width, width_, kMaxTableWidth),
    height_ = std::clamp(image.height, height_, kMaxTableHeight);
  }
  makeBands();
  const size_t columns = 2 * static_cast<size_t>(width_), rows = 2 * static_cast<size_t>(height_) + 1;
  std::vector<float> grid(columns * rows);
  tbb::parallel_for(size_t{0}, rows, [&](size_t j) {
    const double polar = kPi<double> * double(j) / double(rows - 1);  // from -z
    const float z = static_cast<float>(-std::cos(polar)), r = static_cast<float>(std::sin(polar));
    for (size_t i = 0; i < columns; ++i) {
      const double phi = kPi<double> - 2 * kPi<double> * double(i) / double(columns);
      const Vec3f d =
          normalize(fromImage({r * static_cast<float>(std::cos(phi)), r * static_cast<float>(std::sin(phi)), z}));
      const float value = drawnAs(radiance(d));
      grid[j * columns + i] = std::isfinite(value) ? value : 0;
    }
  });
  std::vector<double> weights(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  double all = 0;
  for (size_t y = 0; y < static_cast<size_t>(height_); ++y)
    for (size_t x = 0; x < static_cast<size_t>(width_); ++x) {
      double sum = 0;
      for (size_t j = 0; j < 3; ++j)
        for (size_t i = 0; i < 3; ++i) sum += double(grid[(2 * y + j) * columns + (2 * x + i) % columns]);
      double& weight = weights[y * static_cast<size_t>(width_) + x];
      weight = sum / 9 * double(bands_[y].height) * 2 * kPi<double> / width_;
      all += weight;
    }
  constexpr double kLeast = 0.01;  // of the mean
  for (size_t i = 0; i < weights.size(); ++i) {
    const double solidAngle = double(bands_[i / static_cast<size_t>(width_)].height) * 2 * kPi<double> / width_;
    weights[i] = std::max(weights[i], kLeast * all * solidAngle / (4 * kPi<double>));
  }
  table_ = PiecewiseConstant2D(weights, width_);
  integral_ = static_cast<float>(table_.sum());
}

void Environment::tabulateImage() {
  const World& world = world_;
  const Scene& scene = scene_;
  // The table's cells hold the image's radiance, taken over each cell from a grid of looked-up values, so that the
  // density is positive wherever the interpolated image is.
  const Image& image = scene.images[static_cast<size_t>(scene.textures[static_cast<size_t>(world.texture)].image)];
  image_ = &image;
  const bool ball = world.map == SkyMap::kMirrorBall;
  // of a ball: the rim, and a meridian at the middle, where it is the finest
  const int side = std::max(image.width, image.height);
  const int columns = ball ? static_cast<int>(std::ceil(kPi<double> * side)) : image.width;
  const int rows = ball ? static_cast<int>(std::ceil(kPi<double> / 4 * side)) : image.height;
  width_ = std::min(columns, kMaxTableWidth), height_ = std::min(rows, kMaxTableHeight);
  const int subX = (columns + width_ - 1) / width_ * 2, subY = (rows + height_ - 1) / height_ * 2;
  const auto onBall = [](float u, float v) {
    const float phi = kPi<float> * (1 - 2 * u), radius = 0.5f * std::sin(0.5f * kPi<float> * v);
    return Vec2f{0.5f + radius * std::sin(phi), 0.5f + radius * std::cos(phi)};
  };
  makeBands();
  std::vector<double> weights(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  TextureUse use;
  use.texture = world.texture;
  const auto fill = [&](auto uvOf) {
    tbb::parallel_for(0, height_, [&](int y) {
      const double band = double(bands_[static_cast<size_t>(y)].height);
      for (int x = 0; x < width_; ++x) {
        double sum = 0;
        for (int j = 0; j <= subY; ++j)
          for (int i = 0; i <= subX; ++i) {
            const float u = (static_cast<float>(x) + (static_cast<float>(i)) / static_cast<float>(subX)) /
                            static_cast<float>(width_);
            const float v = (static_cast<float>(y) + (static_cast<float>(j)) / static_cast<float>(subY)) /
                            static_cast<float>(height_);
            sum += drawnAs(sampleRgb(scene, use, uvOf(u, v)) * world.radiance);
          }
        const Vec3f middle = inCell(static_cast<uint32_t>(x), static_cast<uint32_t>(y), 0.5f, 0.5f);
        const float stretched = stretch(toImage(normalize(fromImage(middle))));
        weights[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)] =
            sum / double((subX + 1) * (subY + 1)) * band * 2 * kPi<double> / width_ / double(stretched);
      }
    });
  };
  if (ball)
    fill(onBall);
  else
    fill([](float u, float v) { return Vec2f{u, v}; });
  table_ = PiecewiseConstant2D(weights, width_);
  integral_ = static_cast<float>(table_.sum());
  exists_ = !table_.empty();
  const Texture& texture = scene.textures[static_cast<size_t>(world.texture)];
  if (exists_ && !ball && image.width == width_ && image.height == height_ && texture.filter == Filter::kLinear &&
      !image.filterEncoded)
    makeTexels();
}

void Environment::makeTexels() {
  const Texture& texture = scene_.textures[static_cast<size_t>(world_.texture)];
  texels_.resize(static_cast<size_t>(width_ + 2) * static_cast<size_t>(height_ + 2));
  tbb::parallel_for(-1, height_ + 1, [&](int y) {
    for (int x = -1; x <= width_; ++x) {
      const int column = wrappedTexel(x, width_, texture.wrapU), row = wrappedTexel(y, height_, texture.wrapV);
      if (column < 0 || row < 0) continue;
      const size_t from = static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column);
      const Rgb c = texelRgb(*image_, from);
      texels_[texelAt(x, y)] = {c.x, c.y, c.z, table_.probability(static_cast<uint32_t>(from))};
    }
  });
}

Vec3f Environment::toImage(Vec3f d) const {
  const Vec3f z = scene_.zUp ? Vec3f{d.x, -d.z, d.y} : d;
  const float* m = matrix_;
  return {m[0] * z.x + m[1] * z.y + m[2] * z.z, m[3] * z.x + m[4] * z.y + m[5] * z.z,
          m[6] * z.x + m[7] * z.y + m[8] * z.z};
}

Vec3f Environment::fromImage(Vec3f d) const {
  const float* m = inverse_;
  const Vec3f z{m[0] * d.x + m[1] * d.y + m[2] * d.z, m[3] * d.x + m[4] * d.y + m[5] * d.z,
                m[6] * d.x + m[7] * d.y + m[8] * d.z};
  return scene_.zUp ? Vec3f{z.x, z.z, -z.y} : z;
}

Rgb Environment::radiance(Vec3f direction, const SkyRay& ray) const {
  if (oneMinusCos_ > 0 && !inCone(direction)) return {0, 0, 0};
  if (world_.program) return skyRadiance(scene_, world_, direction, ray);
  if (world_.texture < 0) return world_.radiance;
  const Vec3f image = toImage(direction);
  return imageAt(world_.map == SkyMap::kMirrorBall ? mirrorBall(image) : equirectangular(image));
}

// uv in [0, 1]^2, in the cell (x, y) of the table.
void Environment::putInImage(Place& p, Vec2f uv, int x, int y) const {
  p.uv = uv;
  p.cell = static_cast<uint32_t>(y * width_ + x);
  if (texels_.empty()) return;
  const auto fall = [](float u, int n, float& share) {  // as texelFall()
    const float at = u * static_cast<float>(n) - 0.5f;
    const int i = static_cast<int>(at) - (at < 0 ? 1 : 0);
    share = at - static_cast<float>(i);
    return std::clamp(i, -1, n - 1);
  };
  p.cell = texelAt(x, y);
  const int i = fall(uv.x, width_, p.uv.x), j = fall(uv.y, height_, p.uv.y);
  p.texel = texelAt(i, j);
}

// The bilinear filter, all of a texel's numbers at once.
Rgb Environment::filtered(uint32_t texel, Vec2f share) const {
  using Lanes = float __attribute__((vector_size(16)));
  const auto at = [&](uint32_t i) {
    Lanes l;
    std::memcpy(&l, &texels_[i], sizeof l);
    return l;
  };
  const uint32_t above = texel + static_cast<uint32_t>(width_ + 2);
  const Lanes c = (at(texel) * (1 - share.x) + at(texel + 1) * share.x) * (1 - share.y) +
                  (at(above) * (1 - share.x) + at(above + 1) * share.x) * share.y;
  return world_.radiance * Rgb{c[0], c[1], c[2]};
}

Rgb Environment::imageAt(Vec2f uv) const {
  TextureUse use;
  use.texture = world_.texture;
  return world_.radiance * sampleRgb(scene_, use, uv);
}

Environment::Place Environment::find(Vec3f direction) const {
  Place p{this, direction, 0, 0, 0, {0, 0}};
  if (oneMinusCos_ > 0) p.density = inCone(direction) ? 1 / (2 * kPi<float> * oneMinusCos_) : 0;
  if (!tabulated()) return p;
  const Vec3f image = toImage(direction);
  const Vec2f uv = equirectangular(image);
  const int x = std::clamp(static_cast<int>(uv.x * static_cast<float>(width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(uv.y * static_cast<float>(height_)), 0, height_ - 1);
  p.density = bands_[static_cast<size_t>(y)].density * stretch(image);
  putInImage(p, world_.map == SkyMap::kMirrorBall ? mirrorBall(image) : uv, x, y);
  prefetch(p);
  return p;
}

void Environment::prefetch(const Place& place) const {
  if (!texels_.empty()) {
    const Texel* const first = &texels_[place.texel];
    for (const Texel* texel : {first, first + width_ + 2}) fetch(texel), fetch(texel + 1);
    return;
  }
  table_.prefetchProbability(place.cell);
  if (image_ != nullptr) wardmis::prefetch(*image_, place.uv);
}

Environment::Look Environment::look(const Place& p, const SkyRay& ray) const {
  if (!texels_.empty()) return {filtered(p.texel, p.uv), texels_[p.cell].probability * p.density};
  if (!tabulated()) return {radiance(p.direction, ray), p.density};
  return {world_.program ? radiance(p.direction, ray) : imageAt(p.uv), table_.probability(p.cell) * p.density};
}

// Of the image's frame, uniform in the cell's solid angle: in azimuth and in cos of the polar angle.
Vec3f Environment::inCell(uint32_t x, uint32_t y, float u, float v) const {
  const Band& band = bands_[y];
  const float t = band.begin + v * band.height;  // 1 - cos of the angle to the pole
  const float r = std::sqrt(std::max(0.0f, t * (2 - t)));
  float sine, cosine;  // of the azimuth, which is pi less this
  sincos2Pi((static_cast<float>(x) + u) / static_cast<float>(width_), sine, cosine);
  return {-r * cosine, r * sine, band.up ? 1 - t : t - 1};
}

Environment::Place Environment::sample(ChoicePoint u) const {
  if (oneMinusCos_ > 0) {
    const Vec3f d = Framef::around(axis_).toWorld(toCone(Vec2f{toCoordinate(u.x), u.y}, oneMinusCos_));
    return {this, d, 0, 0, 1 / (2 * kPi<float> * oneMinusCos_), {0, 0}};
  }
  const uint32_t cell = table_.sample(u);
  const uint32_t y = cell / static_cast<uint32_t>(width_), x = cell - y * static_cast<uint32_t>(width_);
  const float across = u.y;
  const Vec3f image = inCell(x, y, across, toCoordinate(u.x)), world = fromImage(image);
  const float l = length(world);  // 1 / that of toImage() of the unit vector
  Place p{this, world / l, 0, 0, bands_[y].density * determinant_ * l * l * l, {0, 0}};
  const Vec2f uv = world_.map == SkyMap::kMirrorBall
                       ? mirrorBall(image)
                       : Vec2f{(static_cast<float>(x) + across) / static_cast<float>(width_), heightOf(image)};
  putInImage(p, uv, static_cast<int>(x), static_cast<int>(y));
  prefetch(p);
  return p;
}

std::vector<Environment> environmentsOf(const Scene& scene) {
  std::vector<Environment> out;
  out.reserve(scene.worlds.size());
  for (const World& world : scene.worlds) out.emplace_back(scene, world);
  return out;
}

}  // namespace wardmis
