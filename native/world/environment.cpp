// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/environment.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
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
// Of an image whose texels are the nodes.
constexpr int kMaxImageWidth = 8192, kMaxImageHeight = 4096;

// From -z, for u and v of [0, 1].
struct Polar {
  Vec3f direction;
  float sinTheta;
};
Polar directionAt(Vec2f uv) {
  float s, c, r, z;
  sincos2Pi(uv.x, s, c);
  sincos2Pi(0.5f * uv.y, r, z);
  return {{-r * c, r * s, -z}, r};
}

// Of what is even over u and v, per solid angle; at the poles, where it has none, it is that very near to them.
float overSphere(float sinTheta) { return 1 / (2 * kPi<float> * kPi<float> * std::max(sinTheta, 1e-6f)); }

// Where the linear density from a to b over [0, 1] has the share u below.
float toLinear(float u, float a, float b) {
  const float root = std::sqrt(a * a + (b * b - a * a) * u);
  return a + root > 0 ? std::min(u * (a + b) / (a + root), 1.0f) : u;
}

constexpr float between(float a, float b, float t) { return a * (1 - t) + b * t; }

// The part of the way from the nodes below to those above that is a row of cells.
struct RowSpan {
  float from = 0, to = 1;
  RowSpan(int y, int height) {
    if (y == 0) from = 0.5f;
    if (y == height) to = 0.5f;
  }
};

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

// The weights of the four nodes around a cell: below and above, left and right.
struct Environment::Cell {
  std::array<float, 2> below, above;

  std::array<float, 2> row(float t) const { return {between(below[0], above[0], t), between(below[1], above[1], t)}; }
  float across(float t) const { return row(t)[0] + row(t)[1]; }
  float at(Vec2f share) const {
    const std::array<float, 2> r = row(share.y);
    return between(r[0], r[1], share.x);
  }
  float mean(RowSpan span) const { return 0.25f * (across(span.from) + across(span.to)); }
};

Environment::Cell Environment::cellAt(uint32_t node) const {
  const uint32_t above = node + static_cast<uint32_t>(width_ + 2);
  if (!nodes_.empty()) return {{nodes_[node], nodes_[node + 1]}, {nodes_[above], nodes_[above + 1]}};
  const auto weight = [&](uint32_t i) {
    const Texel& t = texels_[i];
    return drawnAs(Rgb{t.r, t.g, t.b} * world_.radiance);
  };
  return {{weight(node), weight(node + 1)}, {weight(above), weight(above + 1)}};
}

// Density over [0, 1]^2, of the cell, over the mean of its weights.
float Environment::densityOverMean(uint32_t node, const Cell& cell) const {
  const uint32_t y = node / static_cast<uint32_t>(width_ + 2), x = node - y * static_cast<uint32_t>(width_ + 2) - 1;
  const RowSpan span(static_cast<int>(y), height_);
  const float area = (span.to - span.from) / (static_cast<float>(width_) * static_cast<float>(height_)),
              mean = cell.mean(span) * area;
  return mean > 0 ? std::min(table_.probability(y * static_cast<uint32_t>(width_) + x) / mean, 1e37f) : 0;
}

// weight(x, y): at each node, and in the rows before the first and after the last one. Of texels, from them.
template <class Weight>
void Environment::tabulate(const Weight& weight) {
  if (texels_.empty()) {
    nodes_.resize(static_cast<size_t>(width_ + 2) * static_cast<size_t>(height_ + 2));
    tbb::parallel_for(-1, height_ + 1, [&](int y) {
      for (int x = -1; x <= width_; ++x) nodes_[nodeAt(x, y)] = weight((x + width_) % width_, y);
    });
  }
  // a matrix that only turns takes a solid angle to one as large
  bool turns = true;
  for (const Vec3f d : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}, Vec3f{0.6f, 0.8f, 0}, Vec3f{0, 0.6f, 0.8f},
                        Vec3f{0.8f, 0, 0.6f}})
    turns = turns && std::abs(length(toImage(d)) - 1) < 1e-5f;
  table_ = PiecewiseConstant2D(static_cast<size_t>(height_) + 1, width_, [&](size_t row, double* weights) {
    const int y = static_cast<int>(row);
    const RowSpan span(y, height_);
    const double from = (y - 0.5 + double(span.from)) / height_, to = (y - 0.5 + double(span.to)) / height_;
    const double middle = (from + to) / 2;
    const double band = 2 * std::sin(kPi<double> * middle) * std::sin(kPi<double> * (to - from) / 2);
    for (int x = 0; x < width_; ++x) {
      const Vec2f at{static_cast<float>((x + 1.0) / width_), static_cast<float>(middle)};
      const float stretched = turns ? 1 : stretch(toImage(normalize(fromImage(directionAt(at).direction))));
      weights[x] = double(cellAt(nodeAt(x, y - 1)).mean(span)) * band * 2 * kPi<double> / width_ / double(stretched);
    }
  });
  integral_ = static_cast<float>(table_.sum());
}

void Environment::tabulate(const std::vector<float>& weights) {
  tabulate([&](int x, int y) {
    return weights[static_cast<size_t>(std::clamp(y, 0, height_ - 1)) * static_cast<size_t>(width_) +
                   static_cast<size_t>(x)];
  });
}

// What the program makes of a grid of directions: of the middle of each node's part, and eight around it on the
// borders, of which the mean has a fourth of a say, since what shines between the grid's points alone is left to the
// surface's techniques; every part has a chance, so that they are not the only ones that find it.
void Environment::tabulateProgram() {
  width_ = 512, height_ = 256;
  for (const uint32_t t : world_.program->textures) {
    const Image& image = scene_.images[static_cast<size_t>(scene_.textures[t].image)];
    width_ = std::clamp(image.width, width_, kMaxTableWidth),
    height_ = std::clamp(image.height, height_, kMaxTableHeight);
  }
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
  std::vector<float> weights(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  double all = 0, area = 0;
  for (size_t y = 0; y < static_cast<size_t>(height_); ++y) {
    const double part = std::sin(kPi<double> * (double(y) + 0.5) / height_);
    for (size_t x = 0; x < static_cast<size_t>(width_); ++x) {
      float sum = 0;
      for (size_t j = 0; j < 3; ++j)
        for (size_t i = 0; i < 3; ++i) sum += grid[(2 * y + j) * columns + (2 * x + i) % columns];
      float& weight = weights[y * static_cast<size_t>(width_) + x];
      weight = std::max(grid[(2 * y + 1) * columns + 2 * x + 1], sum / 9 / 4);
      all += double(weight) * part, area += part;
    }
  }
  constexpr double kLeast = 0.01;  // of the mean
  const auto least = static_cast<float>(kLeast * all / area);
  for (float& weight : weights) weight = std::max(weight, least);
  tabulate(weights);
}

void Environment::tabulateImage() {
  const World& world = world_;
  const Scene& scene = scene_;
  const Texture& texture = scene.textures[static_cast<size_t>(world.texture)];
  const Image& image = scene.images[static_cast<size_t>(texture.image)];
  image_ = &image;
  const bool ball = world.map == SkyMap::kMirrorBall;
  if (!ball && texture.filter == Filter::kLinear && image.width <= kMaxImageWidth && image.height <= kMaxImageHeight) {
    width_ = image.width, height_ = image.height;
    if (texture.wrapU == Wrap::kRepeat && !image.filterEncoded && width_ <= kMaxTableWidth &&
        height_ <= kMaxTableHeight &&
        std::none_of(image.floats.begin(), image.floats.end(), [](float v) { return v < 0; }))
      makeTexels();
    tabulate([&](int x, int y) {
      const int row = wrappedTexel(y, height_, texture.wrapV);
      if (row < 0) return 0.0f;
      return drawnAs(texelRgb(image, static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(x)) *
                     world.radiance);
    });
    tbb::parallel_for(-1, texels_.empty() ? -1 : height_, [&](int y) {
      for (int x = 0; x < width_; ++x) {
        const uint32_t node = nodeAt(x, y);
        texels_[node].scale = densityOverMean(node, cellAt(node));
      }
    });
  } else {
    tabulateMeans();
  }
  exists_ = !table_.empty();
}

// The weights are means over the nodes' parts, from a grid of looked-up values, so that the density is positive
// wherever the filtered image is.
void Environment::tabulateMeans() {
  const bool ball = world_.map == SkyMap::kMirrorBall;
  // of a ball: the rim, and a meridian at the middle, where it is the finest
  const int side = std::max(image_->width, image_->height);
  const int columns = ball ? static_cast<int>(std::ceil(kPi<double> * side)) : image_->width;
  const int rows = ball ? static_cast<int>(std::ceil(kPi<double> / 4 * side)) : image_->height;
  width_ = std::min(columns, kMaxTableWidth), height_ = std::min(rows, kMaxTableHeight);
  const int subX = (columns + width_ - 1) / width_ * 2, subY = (rows + height_ - 1) / height_ * 2;
  const auto onBall = [](Vec2f uv) {
    const float phi = kPi<float> * (1 - 2 * uv.x), radius = 0.5f * std::sin(0.5f * kPi<float> * uv.y);
    return Vec2f{0.5f + radius * std::sin(phi), 0.5f + radius * std::cos(phi)};
  };
  std::vector<float> weights(static_cast<size_t>(width_) * static_cast<size_t>(height_));
  tbb::parallel_for(0, height_, [&](int y) {
    for (int x = 0; x < width_; ++x) {
      double sum = 0;
      for (int j = 0; j <= subY; ++j)
        for (int i = 0; i <= subX; ++i) {
          const Vec2f uv{
              (static_cast<float>(x) + static_cast<float>(i) / static_cast<float>(subX)) / static_cast<float>(width_),
              (static_cast<float>(y) + static_cast<float>(j) / static_cast<float>(subY)) / static_cast<float>(height_)};
          sum += double(drawnAs(imageAt(ball ? onBall(uv) : uv)));
        }
      weights[static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x)] =
          static_cast<float>(sum / double((subX + 1) * (subY + 1)));
    }
  });
  tabulate(weights);
}

void Environment::makeTexels() {
  const Texture& texture = scene_.textures[static_cast<size_t>(world_.texture)];
  texels_.resize(static_cast<size_t>(width_ + 2) * static_cast<size_t>(height_ + 2));
  tbb::parallel_for(-1, height_ + 1, [&](int y) {
    for (int x = -1; x <= width_; ++x) {
      const int column = wrappedTexel(x, width_, texture.wrapU), row = wrappedTexel(y, height_, texture.wrapV);
      if (column < 0 || row < 0) continue;
      const Rgb c =
          texelRgb(*image_, static_cast<size_t>(row) * static_cast<size_t>(width_) + static_cast<size_t>(column));
      texels_[nodeAt(x, y)] = {c.x, c.y, c.z, 0};
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

// uv in [0, 1]^2, of the table.
void Environment::putInTable(Place& p, Vec2f uv) const {
  const auto fall = [](float u, int n, int most, float& share) {  // as texelFall()
    const float at = u * static_cast<float>(n) - 0.5f;
    const int i = std::min(static_cast<int>(at) - (at < 0 ? 1 : 0), most);
    share = at - static_cast<float>(i);
    return i;
  };
  const int x = fall(uv.x, width_, width_ - 1, p.share.x), y = fall(uv.y, height_, height_ - 1, p.share.y);
  p.node = nodeAt(x < 0 ? width_ - 1 : x, y);
}

// The bilinear filter, all of a texel's numbers at once.
Environment::Look Environment::filtered(const Place& p) const {
  using Lanes = float __attribute__((vector_size(16)));
  const auto at = [&](uint32_t i) {
    Lanes l;
    std::memcpy(&l, &texels_[i], sizeof l);
    return l;
  };
  const Vec2f share = p.share;
  const uint32_t above = p.node + static_cast<uint32_t>(width_ + 2);
  const Lanes first = at(p.node), c = (first * (1 - share.x) + at(p.node + 1) * share.x) * (1 - share.y) +
                                      (at(above) * (1 - share.x) + at(above + 1) * share.x) * share.y;
  const Rgb radiance = world_.radiance * Rgb{c[0], c[1], c[2]};
  return {radiance, drawnAs(radiance) * first[3] * p.density};
}

Rgb Environment::imageAt(Vec2f uv) const {
  TextureUse use;
  use.texture = world_.texture;
  return world_.radiance * sampleRgb(scene_, use, uv);
}

Environment::Place Environment::find(Vec3f direction) const {
  Place p{this, direction};
  if (oneMinusCos_ > 0) p.density = inCone(direction) ? 1 / (2 * kPi<float> * oneMinusCos_) : 0;
  if (!tabulated()) return p;
  const Vec3f image = toImage(direction);
  const float l2 = dot(image, image), l = std::sqrt(l2);
  const Vec2f uv = equirectangular(image);
  p.uv = world_.map == SkyMap::kMirrorBall ? mirrorBall(image) : uv;
  p.density = overSphere(std::sqrt(image.x * image.x + image.y * image.y) / l) * determinant_ / (l2 * l);
  putInTable(p, uv);
  prefetch(p);
  return p;
}

void Environment::prefetchNodes(uint32_t node) const {
  const auto ask = [&](const auto& nodes) {
    for (const auto* first : {&nodes[node], &nodes[node] + width_ + 2}) fetch(first), fetch(first + 1);
  };
  if (!texels_.empty())
    ask(texels_);
  else
    ask(nodes_);
}

void Environment::prefetch(const Place& p) const {
  prefetchNodes(p.node);
  if (!texels_.empty()) return;
  const uint32_t y = p.node / static_cast<uint32_t>(width_ + 2);
  table_.prefetchProbability(p.node - 2 * y - 1);
  if (image_ != nullptr) wardmis::prefetch(*image_, p.uv);
}

Environment::Look Environment::look(const Place& p, const SkyRay& ray) const {
  if (!texels_.empty()) return filtered(p);
  if (!tabulated()) return {radiance(p.direction, ray), p.density};
  const Cell cell = cellAt(p.node);
  return {world_.program ? radiance(p.direction, ray) : imageAt(p.uv),
          densityOverMean(p.node, cell) * cell.at(p.share) * p.density};
}

uint32_t Environment::cell(ChoicePoint& u) const {
  if (!tabulated()) return 0;
  const uint32_t cell = table_.sample(u), y = cell / static_cast<uint32_t>(width_);
  prefetchNodes(cell + 2 * y + 1);
  return cell;
}

Environment::Place Environment::sample(uint32_t cell, ChoicePoint u) const {
  if (oneMinusCos_ > 0) {
    Place p{this, Framef::around(axis_).toWorld(toCone(Vec2f{toCoordinate(u.x), u.y}, oneMinusCos_))};
    p.density = 1 / (2 * kPi<float> * oneMinusCos_);
    return p;
  }
  const auto y = static_cast<int>(cell / static_cast<uint32_t>(width_)), x = static_cast<int>(cell) - y * width_;
  Place p{this};
  p.node = nodeAt(x, y - 1);
  const Cell weights = cellAt(p.node);
  const RowSpan span(y, height_);
  p.share.y =
      between(span.from, span.to, toLinear(toCoordinate(u.x), weights.across(span.from), weights.across(span.to)));
  const std::array<float, 2> row = weights.row(p.share.y);
  p.share.x = toLinear(u.y, row[0], row[1]);
  const float across = (static_cast<float>(x) + 0.5f + p.share.x) / static_cast<float>(width_);
  const Vec2f uv{across < 1 ? across : across - 1,
                 (static_cast<float>(y) - 0.5f + p.share.y) / static_cast<float>(height_)};
  const auto [image, sinTheta] = directionAt(uv);
  const Vec3f world = fromImage(image);
  p.uv = world_.map == SkyMap::kMirrorBall ? mirrorBall(image) : uv;
  const float l = length(world);  // 1 / that of toImage() of the unit vector
  p.direction = world / l;
  p.density = overSphere(sinTheta) * determinant_ * l * l * l;
  if (image_ != nullptr && texels_.empty()) wardmis::prefetch(*image_, p.uv);  // all else has just been read
  return p;
}

std::vector<Environment> environmentsOf(const Scene& scene) {
  std::vector<Environment> out;
  out.reserve(scene.worlds.size());
  for (const World& world : scene.worlds) out.emplace_back(scene, world);
  return out;
}

}  // namespace wardmis
