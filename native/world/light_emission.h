// SPDX-License-Identifier: GPL-3.0-or-later
// Where paths from the lights begin: rays of light, drawn by the power of the emitters, each with its density among all
// rays. All lights have one measure, that of rays: per area across the ray and per solid angle (Veach 1997, section
// 4.1), so that nobody need know what surface sends them. What a ray brings to where it arrives, who finds it asks for
// (Emitters::arriving()), by the same functions as of a path that comes from the camera.
#pragma once

#include <cstdint>
#include <vector>

#include "world/emitters.h"

namespace wardmis {

// A ray of light that leaves an emitter.
struct EmittedRay {
  Vec3f origin{0, 0, 0}, direction{0, 0, 1};  // unit; away from the light
  // Per m^2 and sr; of a point, which has no area, per sr; of a sun of one direction per m^2. The choice of the emitter
  // included. 0: none was drawn.
  float pdf = 0;
  uint32_t emitter = 0;
  PrimitiveId on;  // the triangle that it leaves, clear of which the origin is
};

class LightEmission {
 public:
  LightEmission(const Emitters& emitters, const Geometry& geometry);

  // Whether any light is drawn.
  bool any() const { return total_ > 0; }
  // choice: of the emitter, then of a place on it; u: of the direction.
  EmittedRay sample(ChoicePoint choice, Vec2f u, float time = kMiddle) const;
  // The density at which that draws rays of an emitter that come to `at` from the unit direction `towards`, the
  // distance away where the emitter has one: per m^2 across the ray and, of emitters that fill directions, per sr.
  float density(uint32_t emitter, Vec3f at, Vec3f towards, float distance, float time = kMiddle) const;

 private:
  float probability(uint32_t emitter) const { return powers_[emitter] / static_cast<float>(total_); }

  const Emitters& emitters_;
  const Geometry& geometry_;
  Vec3f center_;  // of the disk that light from infinitely far is sent through
  float radius_;
  double total_ = 0;               // of the powers
  std::vector<float> powers_;      // of the emitters; 0: none of its light is sent
  std::vector<double> cumulated_;  // powers up to each emitter's
};

}  // namespace wardmis
