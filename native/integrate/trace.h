// SPDX-License-Identifier: GPL-3.0-or-later
// Rays through surfaces that let light straight through: a ray that is followed goes on at random, with the probability
// that its surface is transparent; a shadow ray takes what all surfaces on its way leave.
#pragma once

#include "integrate/interaction.h"
#include "math/random.h"
#include "world/emitters.h"
#include "world/light_visibility.h"

namespace wardmis {

// The built scene, read-only, shared by all threads.
struct RenderScene {
  const Scene& scene;
  const Geometry& geometry;
  const Accel& accel;
  const Emitters& emitters;
  bool surfaceRays;  // rays of the surfaces' techniques can find light
  // Surfaces that a path passes straight, all its rays together, and a shadow ray from there, to which the next one is
  // opaque. 0 also where no surface lets light through.
  int mostTransparent = 0;
  // Those after which other rays pass no more, and what they meet shows them its emission alone.
  int mostFollowed = 1;
  // What is known of hidden lights, and what learns it, in a pilot; null: nothing.
  const LightVisibility* lights = nullptr;
  LightVisibility* learning = nullptr;
  // Whether a ray has passed more than shadow rays do.
  bool isHidden(const Ray& ray) const { return ray.path.transparent > mostTransparent; }
  // Whether it has passed as many as it may.
  bool isBeyond(const Ray& ray) const { return ray.path.transparent >= mostFollowed; }
};

// The lights as samples of them are drawn at x.
template <uint32_t N, class X>
LightView lightsAt(const RenderScene& world, const X& x) {
  const auto& s = x.surface;
  const float matte = s.strength() > 0 ? s.diffuseStrength() / s.strength() : 1;
  bool oneSided = true;  // no light goes through from behind
  if constexpr ((N & kNeedsLobes) != 0) oneSided = !s.transmits();
  const Vec3f facing = oneSided ? x.geometric : Vec3f{0, 0, 0};
  return world.emitters.view(x.position, facing, matte,
                             world.lights != nullptr ? &world.lights->at(x.position, facing) : nullptr);
}

namespace detail {

// The probability to go on behind x, by what its surface lets through and what else it sends. That is below 1 wherever
// there is anything else: what is added to a transparent surface would be lost. Its emission counts as one more lobe of
// that albedo.
template <class X>
float passing(const X& x) {
  const Rgb through = x.surface.transparent;
  const float passes = std::min(std::abs(through.x + through.y + through.z) / 3, 1.0f);
  const auto sent = [](Rgb c) { return std::min(std::abs(c.x) + std::abs(c.y) + std::abs(c.z), 1.0f); };
  const float stays = x.surface.strength() + x.surface.holdout + sent(x.emission);
  return passes > 0 ? passes / (passes + stays) : 0;
}
// From where a ray goes on behind x, which it met at t.
template <class X>
float behind(const X& x, Vec3f direction, float t) {
  constexpr float kGrazing = 1e-3f;
  return t + std::max(2 * x.clearance / std::max(std::abs(dot(x.geometric, direction)), kGrazing), t * 1e-6f);
}
inline bool mayPass(const RenderScene& world, const Ray& ray, const Hit& hit, int most) {
  return ray.path.transparent < most &&
         world.scene.materials[static_cast<size_t>(world.geometry.shapes[hit.shape].material)].transparent;
}

}  // namespace detail

// The surface at which a ray ends; its t is from the ray's origin, whatever it passed. weight: of what is seen there.
// Before that, calls along(hit t, escaped) for each stretch between two surfaces, with `weight` as it is there.
// key: of the random numbers. met(x, hit): of surfaces that it passes.
template <uint32_t N, size_t K, class Along, class Met>
Hit trace(const RenderScene& world, Ray& ray, uint32_t key, Rgb& weight, Along&& along, Met&& met) {
  for (uint32_t passed = 0;; ++passed) {
    const Hit hit = world.accel.intersect(ray);
    along(hit.t, !hit.valid());
    if constexpr ((N & kNeedsLobes) == 0) {
      return hit;
    } else {
      if (!hit.valid() || !detail::mayPass(world, ray, hit, world.mostFollowed)) return hit;
      const auto x = interact<N, K>(world.scene, world.geometry, ray, hit);
      const float q = detail::passing(x);
      if (!(q > 0)) return hit;
      if (toUnit(combine(key, 0x51ed270bu + passed)) >= q) {
        weight = weight / (1 - q);
        return hit;
      }
      met(x, hit);
      weight = weight * x.surface.straight() / q;
      ray.tMin = detail::behind(x, ray.direction, hit.t);
      ray.left = x.primitive;
      ray.path = ray.path.passed();
    }
  }
}

template <uint32_t N, size_t K, class Along>
Hit trace(const RenderScene& world, Ray& ray, uint32_t key, Rgb& weight, Along&& along) {
  return trace<N, K>(world, ray, key, weight, along, [](const auto&, const Hit&) {});
}

namespace detail {

// What a shadow ray has left behind a curve, and what of its path. As Cycles has it: colours as their mean, and the far
// side of a tube whose inside is seen counts as one more of the same.
inline Rgb throughCurve(const Strands& strands, Rgb transparent, PathState& path) {
  const float mean = std::clamp((transparent.x + transparent.y + transparent.z) / 3, 0.0f, 1.0f);
  const bool twice = strands.form != Form::kRibbons && strands.inside;
  if (twice) path = path.passed();
  const float left = twice ? mean * mean : mean;
  return {left, left, left};
}

}  // namespace detail

// What arrives of light at the end of a ray that goes on as long as it is let through: of a shadow ray, or else as rays
// of the surfaces' techniques find it. ray.path.transparent: surfaces that have been passed; those of the ray are
// added.
template <uint32_t N, size_t K, bool kShadow = true>
Rgb transmittance(const RenderScene& world, Ray& ray) {
  constexpr Rgb kAll{1, 1, 1}, kNone{0, 0, 0};
  if ((N & kNeedsLobes) == 0 || world.mostTransparent == 0) return world.accel.occluded(ray) ? kNone : kAll;
  Rgb left = kAll;
  for (;;) {
    const Hit hit = world.accel.intersect(ray);
    if (!hit.valid()) return left;
    const Shape& shape = world.geometry.shapes[hit.shape];
    if (!detail::mayPass(world, ray, hit, world.mostTransparent) ||
        (kShadow && world.scene.materials[static_cast<size_t>(shape.material)].opaqueShadow))
      return kNone;
    const auto x = interact<N, K>(world.scene, world.geometry, ray, hit);
    if constexpr (!kShadow)
      left *= x.surface.straight();
    else
      left *= isCurve(shape) ? detail::throughCurve(*shape.strands, x.surface.transparent, ray.path)
                             : x.surface.transparent;
    if (!(strength(left) > 0)) return kNone;
    ray.tMin = detail::behind(x, ray.direction, hit.t);
    ray.left = x.primitive;
    if (!(ray.tMin < ray.tMax)) return left;
    ray.path = ray.path.passed();
  }
}

}  // namespace wardmis
