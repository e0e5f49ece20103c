// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/patterns.h"

#include "pattern/brick.h"
#include "pattern/gabor.h"
#include "pattern/magic.h"
#include "pattern/noise.h"
#include "pattern/simple.h"
#include "pattern/voronoi.h"
#include "pattern/wave.h"

namespace wardmis::patterns {
namespace {

using namespace pattern;

template <class E>
E choice(const Operands& o, int word) {
  return static_cast<E>(o.word(word));
}
int whole(const Operands& o, int word) { return static_cast<int>(o.word(word)); }

NoiseSettings noiseSettings(const Operands& o) {
  return {choice<Version>(o, 3), whole(o, 0), choice<FractalType>(o, 1), o.flag(2)};
}
NoiseInputs noiseInputs(const Operands& o) { return {o.n(2), o.n(3), o.n(4), o.n(5), o.n(6), o.n(7), o.n(8)}; }

VoronoiValue voronoiOf(const Operands& o) {
  const VoronoiSettings s{choice<Version>(o, 4), whole(o, 0), choice<VoronoiFeature>(o, 1), choice<VoronoiMetric>(o, 2),
                          o.flag(3)};
  return voronoi(s, {o.n(2), o.n(3), o.n(4), o.n(5), o.n(6), o.n(7), o.n(8)}, o.v(0), o.n(1));
}

GaborValue gaborOf(const Operands& o) { return gabor(whole(o, 0), {o.n(1), o.n(2), o.n(3), o.n(4), o.v(5)}, o.v(0)); }

// numbers: the first of the numbers among the arguments.
BrickValue brickOf(const Operands& o, Rgb color1, Rgb color2, Rgb mortar, int numbers) {
  const auto n = [&](int k) { return o.n(numbers + k); };
  const BrickSettings s{choice<Version>(o, 4), o.number(0), o.number(2), whole(o, 1), whole(o, 3)};
  return brick(s, {color1, color2, mortar, n(0), n(1), n(2), n(3), n(4), n(5)}, o.v(0));
}

}  // namespace

void run(Operation operation, const Operands& o) {
  using enum Operation;
  switch (operation) {
    case kNoise:
      return o.set(noiseFactor(noiseSettings(o), noiseInputs(o), o.v(0), o.n(1)));
    case kNoiseColor:
      return o.set(noiseColor(noiseSettings(o), noiseInputs(o), o.v(0), o.n(1)));
    case kMusgrave:
      return o.set(musgrave(choice<FractalType>(o, 1), whole(o, 0), {o.n(2), o.n(3), o.n(4), o.n(5), o.n(6), o.n(7)},
                            o.v(0), o.n(1)));
    case kVoronoiDistance:
      return o.set(voronoiOf(o).distance);
    case kVoronoiColor:
      return o.set(voronoiOf(o).color);
    case kVoronoiPosition:
      return o.set(voronoiOf(o).position);
    case kVoronoiW:
      return o.set(voronoiOf(o).w);
    case kVoronoiRadius:
      return o.set(voronoiOf(o).radius);
    case kGaborValue:
      return o.set(gaborOf(o).value);
    case kGaborPhase:
      return o.set(gaborOf(o).phase);
    case kGaborIntensity:
      return o.set(gaborOf(o).intensity);
    case kWave:
      return o.set(
          wave({choice<Version>(o, 3), choice<WaveShape>(o, 0), choice<WaveAxis>(o, 1), choice<WaveProfile>(o, 2)},
               {o.n(1), o.n(2), o.n(3), o.n(4), o.n(5), o.n(6)}, o.v(0)));
    case kMagic:
      return o.set(magic(choice<Version>(o, 1), whole(o, 0), o.n(1), o.n(2), o.v(0)));
    case kChecker:
      return o.set(checker(o.n(1), o.v(0)));
    case kGradient:
      return o.set(gradient(choice<GradientType>(o, 0), o.v(0)));
    case kWhiteNoise:
      return o.set(whiteNoise(whole(o, 0), o.v(0), o.n(1)));
    case kWhiteNoiseColor:
      return o.set(whiteNoiseColor(whole(o, 0), o.v(0), o.n(1)));
    case kBrick:
      return o.set(brickOf(o, o.v(1), o.v(2), o.v(3), 4).color);
    case kBrickFactor:
      return o.set(brickOf(o, {}, {}, {}, 1).factor);
    default:
      return;
  }
}

}  // namespace wardmis::patterns
