// SPDX-License-Identifier: GPL-3.0-or-later
// The node Wave Texture: bands or rings, distorted by noise.
#pragma once

#include "math/number.h"
#include "pattern/fractal.h"

namespace wardmis::pattern {

enum class WaveShape { kBands, kRings };
// Bands run across the axis, or across the diagonal of all three; rings lie around it, or around the origin.
enum class WaveAxis { kX, kY, kZ, kAll };
enum class WaveProfile { kSine, kSaw, kTriangle };

struct WaveSettings {
  Version version = Version::kBlender5;
  WaveShape shape = WaveShape::kBands;
  WaveAxis axis = WaveAxis::kX;
  WaveProfile profile = WaveProfile::kSine;
};
struct WaveInputs {
  float scale = 5, distortion = 0, detail = 2, detailScale = 1, detailRoughness = 0.5f, phase = 0;
};

// In [0, 1].
inline float wave(const WaveSettings& s, const WaveInputs& in, Vec3f p) {
  // The least bit aside, so that walls at whole numbers do not lie on a jump.
  const auto aside = [&in](float x) { return (x * in.scale + 0.000001f) * 0.999999f; };
  const Vec3f q{aside(p.x), aside(p.y), aside(p.z)};
  const float along[] = {q.x, q.y, q.z};
  const int axis = static_cast<int>(s.axis);
  float n;
  if (s.shape == WaveShape::kBands) {
    n = s.axis == WaveAxis::kAll ? (q.x + q.y + q.z) * 10 : along[axis] * 20;
  } else {
    Vec3f r = q;
    if (s.axis == WaveAxis::kX) r.x = 0;
    if (s.axis == WaveAxis::kY) r.y = 0;
    if (s.axis == WaveAxis::kZ) r.z = 0;
    n = length(r) * 20;
  }
  n += in.phase;
  if (in.distortion != 0) {
    Fractal f{.version = s.version, .roughness = in.detailRoughness, .normalize = true};
    if (s.version == Version::kBlender3) {
      f.roughness = limit(f.roughness, 0, 1);
      f.setDetail(limit(in.detail, 0, 15));
    } else {
      f.setDetail(limit(in.detail, -1, 40));  // Cycles has no limits: no octaves are no number, very many take for ever
    }
    const Vec3f d = q * in.detailScale;
    n += in.distortion * (fbm(f, Point<3>{{d.x, d.y, d.z}}) * 2 - 1);
  }
  constexpr float kTurn = 2 * kPi<float>;
  switch (s.profile) {
    case WaveProfile::kSine:
      return 0.5f + 0.5f * std::sin(n - kPi<float> / 2);
    case WaveProfile::kSaw:
      return n / kTurn - std::floor(n / kTurn);
    case WaveProfile::kTriangle:
      return std::abs(n / kTurn - std::floor(n / kTurn + 0.5f)) * 2;
  }
  return 0;
}

}  // namespace wardmis::pattern
