// SPDX-License-Identifier: GPL-3.0-or-later
// Runs a material's program at a point of a surface.
#pragma once

#include "program/run.h"
#include "world/geometry.h"

namespace wardmis {

// A point of a triangle, or of a curve or sphere, as a ray sees it. World space; unit vectors.
struct ShadedPoint {
  const Placement& placement;
  const Shape& shape;
  uint32_t triangle;
  float u, v;  // as of a Hit
  Vec3f position;
  Vec3f geometric, normal;  // on the side of wo
  Vec3f wo;
  bool turned;  // the triangle's own normal, by the order of its vertices in the mesh, looks the other way; a curve or
                // sphere is seen from inside
  PathState path;
  float rayLength;
};

// What the program of the point's material makes there. Returns the normal that it leaves: the point's, or a bent one.
Vec3f runProgram(const Scene& scene, const ShadedPoint& point, Slots& slots);

// A triangle's own point, for its light: seen from `from`, where a path of this time has come to by so many
// scatterings.
Rgb emissionAt(const Scene& scene, const Placement& placement, const Shape& shape, uint32_t triangle, float u, float v,
               Vec3f from, int bounces, float time = kMiddle);

// Who looks at the sky, and from where.
struct SkyRay {
  Vec3f origin{};
  bool camera = false;  // else a surface
  int bounces = 0;      // by which the path has come there
};
// What the world's program makes in a unit direction, times its constant.
Rgb skyRadiance(const Scene& scene, const World& world, Vec3f direction, const SkyRay& ray);

// A point of a light as it is seen. World space; of a sun, all but the distance is the direction of its light.
struct LitPoint {
  Vec3f position, normal;
  Vec3f direction;  // of the light from there: unit
  float distance;   // that it goes
  int bounces;      // by which the path has come to where it goes
};
// What the light's program multiplies it by.
Rgb lightFactor(const Scene& scene, const Light& light, const LitPoint& point);

// A value that an input refers to; 0 for what is not finite.
inline float finiteOrZero(float v) { return std::isfinite(v) ? v : 0; }
inline float numberOf(const Program& program, const Slots& slots, int result) {
  return finiteOrZero(slots[program.results[static_cast<size_t>(result)]]);
}
inline Vec3f vectorOf(const Program& program, const Slots& slots, int result) {
  const float* p = slots.data() + program.results[static_cast<size_t>(result)];
  return {finiteOrZero(p[0]), finiteOrZero(p[1]), finiteOrZero(p[2])};
}
// A normal or a tangent, from the axes that the scene is told in to the file's.
inline Vec3f directionOf(const Scene& scene, const Program& program, const Slots& slots, int result) {
  const Vec3f v = vectorOf(program, slots, result);
  return scene.zUp ? Vec3f{v.x, v.z, -v.y} : v;
}

}  // namespace wardmis
