// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/light_emission.h"

#include <algorithm>
#include <cmath>

#include "math/number.h"
#include "math/warp.h"

namespace wardmis {
namespace {

constexpr float kPif = kPi<float>;

// A point of a disk across a direction.
Vec3f across(Vec3f center, Vec3f direction, float radius, Vec2f u) {
  const Framef f = Framef::around(direction);
  const Vec2f d = toDisk(u);
  return center + (f.x * d.x + f.y * d.y) * radius;
}

}  // namespace

LightEmission::LightEmission(const Emitters& emitters, const Geometry& geometry)
    : emitters_(emitters),
      geometry_(geometry),
      center_(geometry.center()),
      radius_(1.001f * geometry.radius()) {  // what lies in the corners of the bounds is not lost to rounding
  powers_ = emitters.powers_;
  // what shines through everything, and what asks how a path came to it, is for the camera's paths alone
  const auto asks = [](const std::shared_ptr<const Program>& p) { return p && (p->reads & kReadsRay) != 0; };
  for (size_t i = 0; i < emitters.lamps_.size(); ++i) {
    const Emitters::Lamp& l = emitters.lamps_[i];
    const bool sky = l.kind == Emitters::Kind::kEnvironment;
    if (!l.shadow || (l.light != nullptr && asks(l.light->program)) ||
        (sky && asks(emitters.environments_[l.environment].world().program)))
      powers_[i] = 0;
  }
  for (size_t i = 0; i < emitters.emissive_.size(); ++i) {
    const Shape& shape = geometry.shapes[emitters.emissive_[i].shape];
    if (asks(emitters.scene_.materials[static_cast<size_t>(shape.material)].program))
      powers_[emitters.lamps_.size() + i] = 0;
  }
  cumulated_.reserve(powers_.size());
  for (const float power : powers_) cumulated_.push_back(total_ += double(power));
}

EmittedRay LightEmission::sample(ChoicePoint choice, Vec2f u, float time) const {
  EmittedRay ray;
  if (!any()) return ray;
  const double at = choice.x * total_;
  const auto found = std::upper_bound(cumulated_.begin(), cumulated_.end(), at);
  ray.emitter = static_cast<uint32_t>(std::min(found - cumulated_.begin(), std::ptrdiff_t(cumulated_.size()) - 1));
  const double power = double(powers_[ray.emitter]);
  if (!(power > 0)) return ray;
  choice.x = std::clamp((at - (cumulated_[ray.emitter] - power)) / power, 0.0, 0x1.fffffffffffffp-1);
  const float chosen = probability(ray.emitter);
  const Vec2f place{toCoordinate(choice.x), choice.y};

  if (ray.emitter >= emitters_.lamps_.size()) {
    const Emitters::Triangle& e = emitters_.emissive_[ray.emitter - emitters_.lamps_.size()];
    const Placement& placement = geometry_.placements[e.placement];
    const auto [a, b, c] = Geometry::corners(placement, geometry_.shapes[e.shape], e.triangle, time);
    const Vec3f n = cross(b - a, c - a);
    const float twice = length(n);
    if (!(twice > 0)) return ray;
    const Vec2f w = toTriangle(place);
    const float side = u.x < 0.5f ? 1.0f : -1.0f;
    const float clear = clearance(placement, cornersOf(geometry_.shapes[e.shape], e.triangle, time), n / twice);
    ray.origin = a + ((b - a) * w.x + (c - a) * w.y) + n * (side / twice * clear);
    u.x = std::min(u.x < 0.5f ? 2 * u.x : 2 * u.x - 1, 0x1.fffffep-1f);
    ray.direction = Framef::around(n * (side / twice)).toWorld(toCosineHemisphere(u));
    ray.pdf = chosen / (kPif * twice);  // half of cos/pi over the area, whose part across the ray is as the cosine
    ray.on = {e.placement, e.shape, e.triangle};
    return ray;
  }
  const Emitters::Lamp& lamp = emitters_.lamps_[ray.emitter];
  switch (lamp.kind) {
    case Emitters::Kind::kArea: {
      const AreaLamp::Emitted emitted = lamp.plane.emit(place, u);
      ray.origin = emitted.origin, ray.direction = emitted.direction, ray.pdf = emitted.pdf;
      break;
    }
    case Emitters::Kind::kDeltaPoint:
    case Emitters::Kind::kFacingDisk:
    case Emitters::Kind::kSphere: {
      const float height = lamp.oneMinusCos();
      ray.direction = Framef::around(lamp.axis()).toWorld(toCone(u, height));
      ray.pdf = 1 / (2 * kPif * height);
      ray.origin = lamp.center;
      if (lamp.kind == Emitters::Kind::kDeltaPoint) break;
      ray.origin = across(lamp.center, ray.direction, lamp.radius, place);
      ray.pdf /= kPif * lamp.radius * lamp.radius;
      break;
    }
    case Emitters::Kind::kSun: {
      const Sun::Sample sun = lamp.sun.sample(u);
      ray.direction = -sun.direction;
      ray.pdf = sun.pdf;
      break;
    }
    case Emitters::Kind::kEnvironment: {
      const Environment& sky = emitters_.environments_[lamp.environment];
      Environment::Place towards = sky.sample({double(u.x), u.y});
      ray.direction = -towards.direction;
      ray.pdf = sky.look(towards).pdf;
      break;
    }
  }
  if (lamp.kind == Emitters::Kind::kSun || lamp.kind == Emitters::Kind::kEnvironment) {
    ray.origin = across(center_, ray.direction, radius_, place) - ray.direction * radius_;
    ray.pdf /= kPif * radius_ * radius_;
  }
  ray.pdf *= chosen;
  return ray;
}

float LightEmission::density(uint32_t emitter, Vec3f at, Vec3f towards, float distance, float time) const {
  if (!any()) return 0;
  const float chosen = probability(emitter);
  if (!(chosen > 0)) return 0;
  if (emitter >= emitters_.lamps_.size()) {
    const Emitters::Triangle& e = emitters_.emissive_[emitter - emitters_.lamps_.size()];
    const auto [a, b, c] =
        Geometry::corners(geometry_.placements[e.placement], geometry_.shapes[e.shape], e.triangle, time);
    const float twice = length(cross(b - a, c - a));
    return twice > 0 ? chosen / (kPif * twice) : 0;
  }
  const Emitters::Lamp& lamp = emitters_.lamps_[emitter];
  const float even = 1 / (kPif * radius_ * radius_);
  switch (lamp.kind) {
    case Emitters::Kind::kArea:
      return chosen * lamp.plane.emittedDensity(-towards);
    case Emitters::Kind::kDeltaPoint:
    case Emitters::Kind::kFacingDisk:
    case Emitters::Kind::kSphere: {
      const float height = lamp.oneMinusCos();
      if (1 + dot(towards, lamp.axis()) > height) return 0;
      const float byDirection = chosen / (2 * kPif * height);
      return lamp.kind == Emitters::Kind::kDeltaPoint ? byDirection / (distance * distance)
                                                      : byDirection / (kPif * lamp.radius * lamp.radius);
    }
    case Emitters::Kind::kSun:
      return chosen * even * (lamp.sun.delta() ? 1 : lamp.sun.at(towards).pdf);
    case Emitters::Kind::kEnvironment:
      return chosen * even * emitters_.environments_[lamp.environment].look(towards, {at, false, 0}).pdf;
  }
  return 0;
}

}  // namespace wardmis
