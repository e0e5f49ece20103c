// SPDX-License-Identifier: GPL-3.0-or-later
#include "pattern/noise.h"

namespace wardmis::pattern {
namespace {

// Noise has no seed: it is taken elsewhere instead, between 100 and 200 along each axis. There a float's last bit moves
// what is seen by 1e-5, so that it matters whether 100 + 100 u is rounded once or twice: as the releases were compiled.
template <int D>
constexpr Point<D> elsewhere(bool once, float seed) {
  Point<D> r;
  for (int d = 0; d < D; d++) {
    const float u = D == 1 ? hashToUnit(Point<1>{{seed}}) : hashToUnit(Point<2>{{seed, static_cast<float>(d)}});
    r[d] = once ? static_cast<float>(100 + double{u} * 100) : 100 + u * 100;
  }
  return r;
}
// Those of the distortion along each axis, then those of green and blue.
template <int D>
using Elsewhere = std::array<Point<D>, D + 2>;
template <int D>
constexpr std::array<Elsewhere<D>, 2> kElsewhere = [] {
  std::array<Elsewhere<D>, 2> r;
  for (int once = 0; once < 2; once++) {
    for (int i = 0; i < D + 2; i++) r[once][i] = elsewhere<D>(once == 1, static_cast<float>(i));
  }
  return r;
}();
template <int D>
const Elsewhere<D>& elsewhereOf(Version version) {
  return kElsewhere<D>[version == Version::kBlender5 ? 1 : 0];
}

Fractal fractalOf(const NoiseSettings& s, const NoiseInputs& in) {
  Fractal f{.version = s.version,
            .type = s.type,
            .roughness = limit(in.roughness, 0, 3.4e38f),
            .lacunarity = in.lacunarity,
            .normalize = s.normalize,
            .offset = in.offset,
            .gain = in.gain};
  if (s.version == Version::kBlender3) {
    f.type = FractalType::kFbm;
    f.normalize = true;
    f.roughness = limit(in.roughness, 0, 1);
    f.lacunarity = 2;
  }
  f.setDetail(limit(in.detail, 0, 15));
  return f;
}

template <int D>
Point<D> distorted(Version version, float distortion, const Point<D>& p) {
  if (distortion == 0) return p;
  Point<D> r = p;
  for (int d = 0; d < D; d++) r[d] += signedNoise(version, p + elsewhereOf<D>(version)[d]) * distortion;
  return r;
}

}  // namespace

float noiseFactor(const NoiseSettings& settings, const NoiseInputs& inputs, Vec3f p, float w) {
  const Fractal f = fractalOf(settings, inputs);
  return atDimensions(settings.dimensions, p * inputs.scale, w * inputs.scale, [&]<int D>(const Point<D>& at) {
    return fractal(f, distorted(settings.version, inputs.distortion, at));
  });
}

Rgb noiseColor(const NoiseSettings& settings, const NoiseInputs& inputs, Vec3f p, float w) {
  const Fractal f = fractalOf(settings, inputs);
  return atDimensions(settings.dimensions, p * inputs.scale, w * inputs.scale, [&]<int D>(const Point<D>& at) {
    const Point<D> q = distorted(settings.version, inputs.distortion, at);
    const Elsewhere<D>& e = elsewhereOf<D>(settings.version);
    return Rgb{fractal(f, q), fractal(f, q + e[D]), fractal(f, q + e[D + 1])};
  });
}

float musgrave(FractalType type, int dimensions, const MusgraveInputs& in, Vec3f p, float w) {
  const float detail = limit(in.detail, 0, 15), lacunarity = limit(in.lacunarity, 1e-5f, 3.4e38f);
  const Fractal f{.version = Version::kBlender3,
                  .type = type,
                  .octaves = toInt(detail),
                  .rest = detail - std::floor(detail),
                  .roughness = std::pow(lacunarity, -limit(in.dimension, 1e-5f, 3.4e38f)),
                  .lacunarity = lacunarity,
                  .offset = in.offset,
                  .gain = in.gain};
  return atDimensions(dimensions, p * in.scale, w * in.scale,
                      [&]<int D>(const Point<D>& at) { return fractal(f, at); });
}

}  // namespace wardmis::pattern
