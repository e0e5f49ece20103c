// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/emitters.h"

#include <algorithm>
#include <cmath>

#include "math/number.h"
#include "math/warp.h"
#include "program/vectors.h"
#include "scene/inputs.h"
#include "world/disk_lamp.h"
#include "world/shading.h"
#include "world/sphere_lamp.h"
#include "world/triangle_luminance.h"

namespace wardmis {
namespace {

constexpr float kFar = 3e38f;
constexpr float kPif = kPi<float>;
constexpr float kLeastRadius = 1e-15f;  // of a lamp; below it is a point, since no float holds its radiance

float fraction(float v) { return v - std::floor(v); }

// Whether it keeps angles.
bool isEven(const Affine& a) {
  const float x = length(a.x), y = length(a.y), z = length(a.z), most = std::max({x, y, z});
  const float askew = std::max({std::abs(dot(a.x, a.y)), std::abs(dot(a.y, a.z)), std::abs(dot(a.z, a.x))});
  return std::min({x, y, z}) > 0.999f * most && askew < 1e-3f * most * most;
}

// As LightBounds has them: what is no number is nothing.
float finiteOf(double w) { return std::isfinite(w) && w > 0 ? static_cast<float>(std::min(w, 1e30)) : 0; }

}  // namespace

LightBounds Emitters::boundsOf(const Lamp& lamp, const Light& light) {
  LightBounds b;
  b.lower = b.upper = lamp.center;
  b.cosO = -1;
  switch (lamp.kind) {
    case Kind::kArea:
      for (const Vec2f corner : {Vec2f{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}) {
        const Vec3f at = lamp.plane.at(corner.x, corner.y);
        b.lower = least(b.lower, at), b.upper = most(b.upper, at);
      }
      b.axis = lamp.plane.normal(), b.cosO = 1;
      b.cosE = lamp.plane.tilted() ? -1 : std::cos(std::min(0.5f * light.spread + 1e-3f, 0.5f * kPif));
      break;
    case Kind::kFacingDisk:
    case Kind::kSphere: {
      const Vec3f r{lamp.radius, lamp.radius, lamp.radius};
      b.lower = b.lower - r, b.upper = b.upper + r;
      break;
    }
    case Kind::kSun:
      b.distant = true;
      b.axis = lamp.center, b.cosO = 1 - lamp.sun.oneMinusCos();
      break;
    default:
      break;
  }
  if (lamp.spot && lamp.even) {
    b.axis = -normalize(light.toWorld.z);
    b.cosO = lamp.cosHalf - 1e-4f, b.cosE = 0.9999f;
  }
  return b;
}

Emitters::Emitters(const Scene& scene, Geometry& geometry, const std::vector<Environment>& environments,
                   bool catchersAlone)
    : scene_(scene), geometry_(geometry), environments_(environments) {
  const float crossSection = kPif * geometry.radius() * geometry.radius();
  std::vector<LightBounds> bounds;

  for (const Light& light : scene.lights) {
    if (isBlack(light.emitted) || (catchersAlone && !light.onCatchers)) continue;
    Lamp l{};
    l.emitted = light.emitted;
    l.visibility = translucence(light.visibility, kSeenByDiffuse);
    l.shadow = light.shadow;
    l.maxBounces = light.maxBounces;
    l.center = light.toWorld.t;
    const double intensity = double(strength(light.emitted));  // times an area: beyond float for the strongest
    double w = intensity;                                      // as LightBounds::intensity
    switch (light.type) {
      case LightType::kArea: {
        l.kind = Kind::kArea;
        l.plane = AreaLamp(light);
        if (!(l.plane.area() > 0)) continue;
        w = intensity * double(l.plane.area());
        break;
      }
      case LightType::kPoint:
      case LightType::kSpot: {
        l.radius = light.radius > kLeastRadius ? light.radius : 0;
        l.kind = !(l.radius > 0) ? Kind::kDeltaPoint : light.facing ? Kind::kFacingDisk : Kind::kSphere;
        if (l.radius > 0) l.emitted = light.emitted / (kPif * l.radius * l.radius);
        if (light.type == LightType::kSpot) {
          l.spot = true;
          l.cosine = light.cosine;
          l.cosHalf = std::cos(0.5f * light.angle);
          l.blend = light.blend;
          l.toLocal = light.toWorld;
          l.even = isEven(light.toWorld);
        }
        break;
      }
      case LightType::kSun:
        l.kind = Kind::kSun;
        l.center = normalize(light.toWorld.z);
        l.sun = Sun(l.center, light.angle, light.flat);
        l.emitted = l.sun.radiance(light.emitted);
        w = intensity * double(l.sun.excess());
        break;
    }
    if (light.program) {
      l.light = &light;
      w *= meanFactor(l, geometry.radius());
    }
    const auto index = static_cast<uint32_t>(lamps_.size());
    const bool seen = l.kind != Kind::kDeltaPoint && (l.kind != Kind::kSun || !l.sun.delta()) && l.shadow;
    l.exclusive = !seen || !light.met;
    (l.exclusive ? exclusive_ : shared_) = true;
    if (light.type == LightType::kSun) {
      if (!l.exclusive) infinite_.push_back(index);
    } else if (seen) {
      finite_.push_back({index, l.center, l.kind == Kind::kArea ? l.plane.reach2() : l.radius * l.radius});
    }
    lamps_.push_back(l);
    bounds.push_back(boundsOf(l, light));
    LightBounds& b = bounds.back();
    b.intensity = finiteOf(w);
    const double directions = light.type == LightType::kArea ? 1 : l.spot ? 2 * (1 - double(l.cosHalf)) : 4;
    b.power = finiteOf(w * (b.distant ? double(crossSection) : directions * kPi<double>));
  }

  for (uint32_t i = 0; i < environments.size(); ++i) {
    const Environment& environment = environments[i];
    if (!environment.exists()) continue;
    infinite_.push_back(static_cast<uint32_t>(lamps_.size()));
    Lamp l{};
    l.kind = Kind::kEnvironment;
    l.environment = i;
    l.visibility = translucence(environment.world().visibility, kSeenByDiffuse);
    l.maxBounces = environment.world().maxBounces;
    lamps_.push_back(l);
    sky_ |= (l.visibility & kSeenBySurfaces) != 0;
    LightBounds all;  // facing anywhere, on the average
    all.distant = true, all.cosO = -1;
    all.intensity = environment.sampled() ? finiteOf(double(environment.integral()) / 4) : 0;
    all.power = finiteOf(4 * double(all.intensity) * double(crossSection));
    bounds.push_back(all);
    shared_ |= environment.sampled();
    if (environment.tabulated()) skyAhead_ = &environment;
  }

  double area = 0;  // of all triangles
  TriangleLuminance luminances(scene);
  std::vector<std::vector<float>> ofShape(geometry.shapes.size());  // of its triangles, whatever its placements
  for (uint32_t p = 0; p < geometry.placements.size(); ++p) {
    Placement& placement = geometry.placements[p];
    placement.firstEmitter = static_cast<uint32_t>(emissive_.size());
    uint32_t offset = 0;
    for (uint32_t s = placement.firstShape; s < placement.firstShape + placement.shapes; ++s) {
      Shape& shape = geometry.shapes[s];
      if (isBlack(scene.materials[static_cast<size_t>(shape.material)].emission.value)) continue;
      if (shape.strands != nullptr) {
        strands_ = true;
        continue;
      }
      shape.emitterOffset = offset;
      offset += shape.triangles;
      std::vector<float>& strength = ofShape[s];
      for (uint32_t t = static_cast<uint32_t>(strength.size()); t < shape.triangles; ++t)
        strength.push_back(static_cast<float>(luminances.of(placement, shape, t)));
      for (uint32_t t = 0; t < shape.triangles; ++t) {
        const auto [a, b, c] = Geometry::corners(placement, shape, t);
        const Vec3f n = cross(b - a, c - a);
        LightBounds of;
        of.lower = least(least(a, b), c), of.upper = most(most(a, b), c);
        of.axis = safeNormalize(n);
        of.twoSided = true;
        of.intensity = finiteOf(0.5 * double(length(n)) * double(strength[t]));
        of.power = 2 * kPif * of.intensity;
        area += 0.5 * double(length(n));
        emissive_.push_back({p, s, t});
        bounds.push_back(of);
      }
    }
  }
  triangles_ = emissive_.size();
  shared_ |= triangles_ > 0;
  tree_ = LightTree(bounds);
  powers_.reserve(bounds.size());
  for (const LightBounds& b : bounds) powers_.push_back(b.power);
  const bool evenly = std::ranges::any_of(
      scene.materials, [](const Material& m) { return !m.closures.empty() && m.closures.front().version == 3; });
  if (evenly) {  // half of its samples are of lamps, where there are triangles, too
    const float share = area > 0 && !lamps_.empty() ? 0.5f : 1;
    if (!lamps_.empty()) evenLamp_ = share / static_cast<float>(lamps_.size());
    if (area > 0) evenArea_ = static_cast<float>(double(share) / area);
  }
  if (finite_.size() <= kFew) return;
  std::vector<SphereAccel::Sphere> spheres;
  for (const Finite& l : finite_) spheres.push_back({l.center, std::sqrt(l.radius2)});
  spheres_ = SphereAccel(spheres);
}

// Radiance (finite lights) or intensity (delta lights) leaving in unit direction d.
Rgb Emitters::profile(const Lamp& lamp, Vec3f d) {
  float f = 1;
  if (lamp.kind == Kind::kArea) return lamp.emitted * lamp.plane.profile(d);
  if (lamp.spot) {
    const Vec3f local = lamp.toLocal.inverseVector(d);
    const float c = -local.z / length(local);
    if (!(c > lamp.cosHalf)) return {0, 0, 0};
    const float x = lamp.blend > 0 ? std::min(1.0f, (c - lamp.cosHalf) / ((1 - lamp.cosHalf) * lamp.blend)) : 1.0f;
    f = x * x * (3 - 2 * x);
    if (lamp.cosine) f *= c;
  }
  return lamp.emitted * f;
}

Rgb Emitters::factor(const Lamp& lamp, Vec3f from, Vec3f d, float t, int bounces) const {
  LitPoint p{from + d * t, -d, -d, t, bounces};
  switch (lamp.kind) {
    case Kind::kArea:
      p.normal = lamp.plane.normal();
      break;
    case Kind::kSphere:
      p.normal = safeNormalize(p.position - lamp.center);
      break;
    case Kind::kDeltaPoint:
      p.position = lamp.center;
      break;
    case Kind::kSun:
      p.position = -d;
      break;
    default:
      break;
  }
  return lightFactor(scene_, *lamp.light, p);
}

double Emitters::meanFactor(const Lamp& lamp, float distance) const {
  constexpr int kPoints = 256;
  // what shines between them must be aimed at, too
  constexpr double kLeast = 0.02, kLeastOfMost = 0.02;
  double sum = 0, all = 0, most = 0;
  for (int i = 0; i < kPoints; ++i) {
    const Vec2f u{(static_cast<float>(i) + 0.5f) / kPoints, fraction(0.618033989f * static_cast<float>(i))};
    Vec3f d = toCone(u, 2.0f);  // of the light
    Vec3f position = lamp.center;
    if (lamp.kind == Kind::kSun) {
      d = -lamp.center;
    } else if (lamp.kind == Kind::kArea) {
      const float a = 2 * fraction(0.754877666f * static_cast<float>(i)) - 1;
      const float b = 2 * fraction(0.569840291f * static_cast<float>(i)) - 1;
      const float within = lamp.plane.ellipse() ? 0.7f : 1.0f;
      position = lamp.plane.at(a * within, b * within);
    }
    const float cosLight = lamp.kind == Kind::kArea ? lamp.plane.cosine(d) : 1;
    if (!(cosLight > 0)) continue;
    const double here = double(strength(profile(lamp, d)) * cosLight);
    const double given = double(strength(factor(lamp, position + d * distance, -d, distance, 0)));
    all += here;
    if (!std::isfinite(given)) continue;
    sum += here * given;
    most = std::max(most, given);
  }
  const double mean = all > 0 ? sum / all : 0;
  return std::max({mean, kLeastOfMost * most, mean > 0 ? 0 : kLeast});
}

LightChoice Emitters::choose(const LightView& view, ChoicePoint u) const {
  LightChoice c;
  c.point = u;
  const LightTree::Choice drawn = tree_.choose(view, c.point.x);
  c.emitter = drawn.light, c.entry = drawn.entry, c.probability = drawn.probability;
  if (c.emitter < lamps_.size() && lamps_[c.emitter].kind == Kind::kEnvironment)
    environments_[lamps_[c.emitter].environment].prefetch(c.point);
  return c;
}

void Emitters::aim(LightChoice& c) const {
  if (c.emitter < lamps_.size() && lamps_[c.emitter].kind == Kind::kEnvironment)
    c.cell = environments_[lamps_[c.emitter].environment].cell(c.point);
}

void Emitters::look(LightSample& s, Vec3f from, int bounces) const {
  if (s.sky.sky == nullptr) return;
  const Environment::Look look = s.sky.sky->look(s.sky, {from, false, bounces});
  s.radiance = look.radiance;
  s.pdf *= look.pdf, s.counted *= look.pdf;
  s.sky.sky = nullptr;
}

// The radiance of a triangle's point, by the weights of its second and third corner.
Rgb Emitters::emitted(const Triangle& e, float u, float v, Vec3f from, int bounces, float time) const {
  const Shape& shape = geometry_.shapes[e.shape];
  const ColorInput& emission = scene_.materials[static_cast<size_t>(shape.material)].emission;
  if (emission.result >= 0)
    return emissionAt(scene_, geometry_.placements[e.placement], shape, e.triangle, u, v, from, bounces, time);
  if (emission.texture.texture < 0 || shape.part->uvs.empty()) return emission.value;
  const uint32_t* i = shape.indices + 3 * size_t{e.triangle};
  const Vec2f a = shape.part->uvs[i[0]], b = shape.part->uvs[i[1]], c = shape.part->uvs[i[2]];
  const float w = 1 - u - v;
  return emission.value *
         sampleRgb(scene_, emission.texture, {w * a.x + u * b.x + v * c.x, w * a.y + u * b.y + v * c.y});
}

LightSample Emitters::sample(Vec3f from, const LightChoice& choice, int bounces, float time) const {
  LightSample s;
  if (!(choice.probability > 0)) return s;
  s.entry = choice.entry, s.emitter = choice.emitter;
  const uint32_t index = choice.emitter;
  const Vec2f u{toCoordinate(choice.point.x), choice.point.y};
  if (index >= lamps_.size()) {
    const Triangle& e = emissive_[index - lamps_.size()];
    const Placement& p = geometry_.placements[e.placement];
    const Corners corner = Geometry::corners(p, geometry_.shapes[e.shape], e.triangle, time);
    const Vec3f a = corner[0], ab = corner[1] - a, ac = corner[2] - a;
    const Vec2f b = toTriangle(u);
    const Vec3f to = (a - from) + ab * b.x + ac * b.y;
    const Vec3f n = cross(ab, ac);  // twice the area
    const float t2 = dot(to, to);
    if (!(t2 > 0)) return s;
    s.distance = std::sqrt(t2);
    s.direction = to / s.distance;
    const float cosArea = std::abs(dot(s.direction, n)) * 0.5f;
    if (!(cosArea > 0)) return s;
    s.pdf = choice.probability * t2 / cosArea;
    s.counted = evenArea_ > 0 ? evenArea_ * length(n) * 0.5f * t2 / cosArea : s.pdf;
    s.radiance = emitted(e, b.x, b.y, from, bounces, time);
    s.visibility = p.visibility;
    s.on = {e.placement, e.shape, e.triangle};
    return s;
  }

  const Lamp& lamp = lamps_[index];
  if (bounces > lamp.maxBounces) return s;
  const auto on = [&](const LampSample& surface) {
    if (!(surface.pdf > 0)) return;
    s.direction = surface.direction, s.distance = surface.distance, s.pdf = surface.pdf;
    s.radiance = profile(lamp, -s.direction);
  };
  switch (lamp.kind) {
    case Kind::kArea:
      on(lamp.plane.sample(from, u));
      break;
    case Kind::kFacingDisk:
      on(DiskLamp{lamp.center, lamp.radius}.sample(from, u));
      break;
    case Kind::kSphere:
      on(SphereLamp{lamp.center, lamp.radius}.sample(from, u));
      break;
    case Kind::kDeltaPoint: {
      const Vec3f to = lamp.center - from;
      const float d2 = dot(to, to);
      if (!(d2 > 0)) return s;
      s.distance = std::sqrt(d2);
      s.direction = to / s.distance;
      s.radiance = profile(lamp, -s.direction) / d2;
      s.pdf = 1;
      break;
    }
    case Kind::kSun: {
      const Sun::Sample sun = lamp.sun.sample(u);
      s.direction = sun.direction, s.distance = kFar, s.pdf = sun.pdf;
      s.radiance = lamp.emitted / sun.cos3;
      break;
    }
    case Kind::kEnvironment: {
      const Environment& environment = environments_[lamp.environment];
      s.distance = kFar;
      s.sky = environment.sample(choice.cell, choice.point);
      s.direction = s.sky.direction;
      s.pdf = 1;
      break;
    }
  }
  if (lamp.light != nullptr && s.pdf > 0) s.radiance *= factor(lamp, from, s.direction, s.distance, bounces);
  s.counted = s.pdf * (evenLamp_ > 0 ? evenLamp_ : choice.probability);
  s.pdf *= choice.probability;
  s.visibility = lamp.visibility;
  s.shadow = lamp.shadow;
  s.exclusive = lamp.exclusive;
  return s;
}

// Whether the ray meets a lamp that it may meet.
bool Emitters::meets(uint32_t index, const Ray& ray, float tMax, int bounces, const LightView* view,
                     const Environment::Place& ahead, EmitterHit& hit) const {
  const Lamp& lamp = lamps_[index];
  // where two lobes share a technique, both get what any of its rays meets: who sees it is the estimator's to say
  const int seers = ray.kind == kSeenByCamera ? kSeenByCamera : kSeenBySurfaces;
  if ((lamp.visibility & seers) == 0 || (lamp.exclusive && ray.kind != kSeenByCamera)) return false;
  return shows(index, ray, tMax, bounces, view, ahead, hit);
}

// Whether it is there.
bool Emitters::shows(uint32_t index, const Ray& ray, float tMax, int bounces, const LightView* view,
                     const Environment::Place& ahead, EmitterHit& hit) const {
  const Lamp& lamp = lamps_[index];
  const Vec3f d = ray.direction;
  float pdf = 0, t = kFar;
  const auto met = [&](const LampHit& surface) {
    t = surface.t, pdf = surface.pdf;
    if (!(t > ray.tMin) || !(t < tMax)) return false;
    hit.radiance = profile(lamp, -d);
    return true;
  };
  switch (lamp.kind) {
    case Kind::kArea:
      if (!met({lamp.plane.meet(ray.origin, d), 0})) return false;
      pdf = lamp.plane.pdf(ray.origin, d, t);
      break;
    case Kind::kFacingDisk:
      if (!met(DiskLamp{lamp.center, lamp.radius}.meet(ray.origin, d))) return false;
      break;
    case Kind::kSphere:
      if (!met(SphereLamp{lamp.center, lamp.radius}.meet(ray.origin, d))) return false;
      break;
    case Kind::kSun: {
      const Sun::Sample seen = lamp.sun.at(d);
      if (!(seen.pdf > 0)) return false;
      pdf = seen.pdf;
      hit.radiance = lamp.emitted / seen.cos3;
      break;
    }
    case Kind::kEnvironment: {
      const Environment& environment = environments_[lamp.environment];
      const SkyRay from{ray.origin, ray.kind == kSeenByCamera, bounces};
      if (from.camera) {  // who does not ask for a density
        hit.radiance = environment.radiance(d, from);
        break;
      }
      const Environment::Look look = environment.look(ahead.sky == &environment ? ahead : environment.find(d), from);
      pdf = look.pdf;
      hit.radiance = look.radiance;
      break;
    }
    case Kind::kDeltaPoint:
      return false;
  }
  if (lamp.light != nullptr) hit.radiance *= factor(lamp, ray.origin, d, t, bounces);
  hit.pdf = pdf > 0 && view != nullptr ? pdf * tree_.probability(*view, index) : 0;
  hit.counted = evenLamp_ > 0 && hit.pdf > 0 ? pdf * evenLamp_ : hit.pdf;
  hit.visibility = lamp.visibility;
  hit.sky = lamp.kind == Kind::kEnvironment, hit.emitter = index, hit.distance = t;
  return true;
}

LightSample Emitters::arriving(uint32_t emitter, const LightView* view, Vec3f at, Vec3f towards, float distance,
                               int bounces, float time) const {
  LightSample s;
  s.direction = towards, s.distance = distance, s.emitter = emitter;
  if (emitter >= lamps_.size()) {
    const Triangle& e = emissive_[emitter - lamps_.size()];
    const Placement& p = geometry_.placements[e.placement];
    s.on = {e.placement, e.shape, e.triangle};
    s.visibility = p.visibility;
    const auto [a, b, c] = Geometry::corners(p, geometry_.shapes[e.shape], e.triangle, time);
    const Vec3f n = cross(b - a, c - a), on = at + towards * distance - a;
    const float n2 = dot(n, n), cosArea = std::abs(dot(towards, n)) * 0.5f;
    if (!(n2 > 0) || !(cosArea > 0)) return s;
    s.radiance = emitted(e, dot(cross(on, c - a), n) / n2, dot(cross(b - a, on), n) / n2, at, bounces, time);
    const float byArea = distance * distance / cosArea;
    s.pdf = view != nullptr ? tree_.probability(*view, emitter) * byArea : 0;
    s.counted = evenArea_ > 0 ? evenArea_ * std::sqrt(n2) * 0.5f * byArea : s.pdf;
    return s;
  }
  const Lamp& lamp = lamps_[emitter];
  if (bounces > lamp.maxBounces) return s;
  s.visibility = lamp.visibility, s.shadow = lamp.shadow, s.exclusive = lamp.exclusive;
  Ray ray;
  ray.origin = at, ray.direction = towards, ray.kind = kSeenByDiffuse;
  EmitterHit hit;
  const bool delta = lamp.kind == Kind::kDeltaPoint || (lamp.kind == Kind::kSun && lamp.sun.delta());
  if (!delta) {
    if (!shows(emitter, ray, kFar, bounces, view, {}, hit)) return s;
    s.radiance = hit.radiance, s.pdf = hit.pdf, s.counted = hit.counted;
    return s;
  }
  const float probability = view != nullptr ? tree_.probability(*view, emitter) : 0;
  if (lamp.kind == Kind::kDeltaPoint)
    s.radiance = profile(lamp, -towards) / (distance * distance);
  else
    s.radiance = lamp.emitted;
  if (lamp.light != nullptr) s.radiance *= factor(lamp, at, towards, distance, bounces);
  s.pdf = probability;
  s.counted = evenLamp_ > 0 && probability > 0 ? evenLamp_ : probability;
  return s;
}

Emitters::Densities Emitters::trianglePdf(const LightView& view, const Placement& p, const Hit& hit, Vec3f direction,
                                          float time) const {
  const Shape& shape = geometry_.shapes[hit.shape];
  if (shape.strands != nullptr) return {};
  const auto [a, b, c] = Geometry::corners(p, shape, hit.triangle, time);
  const Vec3f n = cross(b - a, c - a);
  const float cosArea = std::abs(dot(direction, n)) * 0.5f;
  if (!(cosArea > 0)) return {};
  const auto emitter = static_cast<uint32_t>(lamps_.size()) + p.firstEmitter + shape.emitterOffset + hit.triangle;
  const float byArea = hit.t * hit.t / cosArea, pdf = tree_.probability(view, emitter) * byArea;
  return {pdf, evenArea_ > 0 ? evenArea_ * length(n) * 0.5f * byArea : pdf, emitter};
}

}  // namespace wardmis
