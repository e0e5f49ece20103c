// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that emits, as one list that the light technique picks from by what each may send to a point: light
// objects, the images of skies, emissive triangles. Each emitter is an integral of its own: a direction that meets
// several is weighted for each by itself.
#pragma once

#include <limits>

#include "world/accel.h"
#include "world/area_lamp.h"
#include "world/environment.h"
#include "world/light_tree.h"
#include "world/sphere_accel.h"
#include "world/sun.h"

namespace wardmis {

// A direction towards an emitter, as seen from a point.
struct LightSample {
  Vec3f direction{0, 0, 0};  // unit
  float distance = 0;        // to the emitter; 3e38 for the infinitely far
  Rgb radiance{0, 0, 0};     // arriving, without occlusion; of a delta light: irradiance facing it
  float pdf =
      0;  // per solid angle, the choice of the emitter included; of a delta light: of the choice; 0: nothing arrives
  float counted = 0;       // the density that Cycles weighs it by against samples of surfaces
  Environment::Place sky;  // of an environment: radiance and density are still to be looked up there
  bool exclusive = false;  // no other technique meets this emitter: a delta light, or one without shadows
  bool shadow = true;      // occluders count
  uint32_t entry = 0;      // of the tree that it was drawn from
  uint32_t emitter = 0;
  PrimitiveId on;  // the triangle, which is not an occluder itself
  uint8_t visibility = kSeenByAll;
};

using LightView = LightTree::View;

// An emitter that was drawn, and what is left of the random numbers.
struct LightChoice {
  uint32_t emitter = 0, entry = 0;  // entry: of the tree
  float probability = 0;
  ChoicePoint point{};
  uint32_t cell = 0;  // of a sky's table
};

// What a ray meets: one emitter.
struct EmitterHit {
  Rgb radiance{0, 0, 0};
  float pdf = 0;  // density of the light technique at this direction, for this emitter; 0 where it does not sample it
  float counted = 0;  // as of a LightSample
  uint8_t visibility = kSeenByAll;
  bool sky = false;  // a world's, else a light's
  uint32_t emitter = 0;
  float distance = 0;
};

class Emitters {
  friend class LightEmission;

 public:
  // Fills Placement::firstEmitter. catchersAlone: what lights the world of Geometry's shadow catchers.
  Emitters(const Scene& scene, Geometry& geometry, const std::vector<Environment>& environments,
           bool catchersAlone = false);

  bool any() const { return !tree_.empty(); }
  // Whether some lights may be drawn more often than others where these are hidden.
  bool several() const { return tree_.entries() > 1; }
  // Emitters that the surface's techniques meet too, and emitters that they cannot (delta lights, lights without
  // shadows).
  bool anyShared() const { return shared_; }
  bool anyExclusive() const { return exclusive_; }
  // Whether surfaces see a sky.
  bool anySky() const { return sky_; }
  // Whether curves or spheres shine, which are not aimed at.
  bool anyStrands() const { return strands_; }
  uint64_t emissiveTriangles() const { return triangles_; }

  // A sample is made in four steps, each of which asks for the memory that the next one reads: work between them hides
  // the wait. bounces: by which the path has come to `from`; time: of the path. A choice of probability 0 is none.
  // matte, known: as LightTree has them.
  LightView view(Vec3f from, Vec3f facing, float matte, const LightTree::Factors* known = nullptr) const {
    return tree_.from(from, facing, matte, known);
  }
  LightChoice choose(const LightView& view, ChoicePoint u) const;
  void aim(LightChoice& choice) const;
  LightSample sample(Vec3f from, const LightChoice& choice, int bounces = 0, float time = kMiddle) const;
  void look(LightSample& sample, Vec3f from, int bounces = 0) const;
  // Whether there is a sky that is looked up in memory, and where a ray of this direction meets it, if it does: for
  // along(). Of several, of one.
  bool skyAhead() const { return skyAhead_ != nullptr; }
  Environment::Place skyAhead(Vec3f direction) const { return skyAhead_->find(direction); }

  // Calls f(EmitterHit) for each light object that the ray meets before tMax, and, where the ray goes on for ever
  // (escaped), for the environment and suns. bounces: by which the path has come to the ray's origin; 0 from the
  // camera. view: of the point from which light samples are drawn; null: there are none, and all densities are 0.
  template <class F>
  void along(const Ray& ray, float tMax, bool escaped, int bounces, const LightView* view, F&& f,
             const Environment::Place& ahead = {}) const;

  // What an emitter sends to a point out of a unit direction in which it lies, if nothing is between; of a triangle
  // also at which distance. It is of no density where it sends nothing. view: as for along().
  LightSample arriving(uint32_t emitter, const LightView* view, Vec3f at, Vec3f towards, float distance,
                       int bounces = 0, float time = kMiddle) const;

  // Of the emissive triangle that was hit, the densities that an EmitterHit has.
  struct Densities {
    float pdf = 0, counted = 0;
    uint32_t emitter = 0;
  };
  // Whether its light is seen after so many bounces.
  bool reaches(uint32_t emitter, int bounces) const {
    return emitter >= lamps_.size() || bounces <= lamps_[emitter].maxBounces;
  }
  Densities trianglePdf(const LightView& view, const Placement& p, const Hit& hit, Vec3f direction,
                        float time = kMiddle) const;

 private:
  enum class Kind : uint8_t { kArea, kFacingDisk, kSphere, kDeltaPoint, kSun, kEnvironment };
  struct Lamp {
    Kind kind;
    Vec3f center{};    // or, for suns, the direction towards it
    AreaLamp plane;    // of kArea
    float radius = 0;  // of disks and spheres
    Sun sun;           // of kSun
    Rgb emitted{};     // radiance; point intensity; delta sun's irradiance
    // angular profile
    bool spot = false, cosine = false;
    float cosHalf = 0, blend = 0;
    Affine toLocal{};  // spot: linear part only
    uint8_t visibility = kSeenByAll;
    bool shadow = true, exclusive = false;
    int maxBounces = std::numeric_limits<int>::max();
    uint32_t environment = 0;      // its index
    const Light* light = nullptr;  // where it has a program

    // The cone of directions in which a point or a sphere shines.
    bool even = false;  // of spots: the light's node keeps angles
    Vec3f axis() const { return spot && even ? -normalize(toLocal.z) : Vec3f{0, 0, 1}; }
    float oneMinusCos() const { return spot && even ? std::min(1 - cosHalf + 1e-6f, 2.0f) : 2; }
  };
  // Where a lamp is and where it shines; its intensity is still to be set.
  static LightBounds boundsOf(const Lamp& lamp, const Light& light);
  static Rgb profile(const Lamp& lamp, Vec3f fromLight);  // radiance or intensity in a direction leaving the light
  // What the lamp's program makes of its light in the direction d from a point, t away.
  Rgb factor(const Lamp& lamp, Vec3f from, Vec3f d, float t, int bounces) const;
  // The mean of that over directions, by the light that goes there.
  double meanFactor(const Lamp& lamp, float distance) const;
  bool shows(uint32_t index, const Ray& ray, float tMax, int bounces, const LightView* view,
             const Environment::Place& ahead, EmitterHit& hit) const;
  bool meets(uint32_t index, const Ray& ray, float tMax, int bounces, const LightView* view,
             const Environment::Place& ahead, EmitterHit& hit) const;

  const Scene& scene_;
  const Geometry& geometry_;
  const std::vector<Environment>& environments_;
  std::vector<Lamp> lamps_;
  struct Triangle {
    uint32_t placement, shape, triangle;
  };
  std::vector<Triangle> emissive_;  // emitters lamps_.size() ...
  Rgb emitted(const Triangle& e, float u, float v, Vec3f from, int bounces, float time) const;
  // A lamp somewhere, which a ray can meet, and a sphere around it, which most rays pass by.
  struct Finite {
    uint32_t lamp;  // its index
    Vec3f center;
    float radius2;  // squared

    bool isPassedBy(const Ray& ray) const {
      constexpr float kRoundings = 1e-5f;  // of squared distances; many more than there are
      const Vec3f to = center - ray.origin;
      const float d2 = dot(to, to), along = std::max(dot(ray.direction, to), 0.0f);
      return d2 - along * along > radius2 + kRoundings * d2;
    }
  };
  LightTree tree_;             // of lamps, then emissive triangles
  std::vector<float> powers_;  // likewise, in W, as LightBounds has them
  std::vector<Finite> finite_;
  static constexpr size_t kFew = 16;  // of so many each is asked
  SphereAccel spheres_;               // of finite_, where there are more
  std::vector<uint32_t> infinite_;    // indices of suns and skies
  const Environment* skyAhead_ = nullptr;
  // What Cycles 3.4 picks from without asking where: a lamp, and a part of the triangles' area. 0: it is counted as
  // here.
  float evenLamp_ = 0, evenArea_ = 0;
  bool shared_ = false, exclusive_ = false, sky_ = false, strands_ = false;
  uint64_t triangles_ = 0;
};

template <class F>
void Emitters::along(const Ray& ray, float tMax, bool escaped, int bounces, const LightView* view, F&& f,
                     const Environment::Place& ahead) const {
  EmitterHit hit;
  const auto ask = [&](const Finite& l) {
    if (l.isPassedBy(ray)) return;
    if (bounces <= lamps_[l.lamp].maxBounces && meets(l.lamp, ray, tMax, bounces, view, ahead, hit)) f(hit);
  };
  if (finite_.size() <= kFew) {
    for (const Finite& l : finite_) ask(l);
  } else {
    SphereAccel::Found found;
    spheres_.find(ray.origin, ray.direction, tMax, found);
    if (found.tooMany)
      for (const Finite& l : finite_) ask(l);
    else
      for (size_t i = 0; i < found.count; ++i) ask(finite_[found.index[i]]);
  }
  if (!escaped) return;
  for (uint32_t i : infinite_)
    if (bounces <= lamps_[i].maxBounces && meets(i, ray, tMax, bounces, view, ahead, hit)) f(hit);
}

}  // namespace wardmis
