// SPDX-License-Identifier: GPL-3.0-or-later
// One path from a light: its vertices, and what each brings to the film by itself. Surfaces send light on as a path
// from the camera sees it (Veach 1997, chapter 5: the adjoint of a surface whose shading normal is not its own, or
// through which light bends, is another): where light goes is drawn from the surface as it meets it, and what it brings
// is asked of the surface as its viewer does.
#pragma once

#include "integrate/connect.h"
#include "integrate/kernel.h"
#include "math/warp.h"

namespace wardmis {

// Names of the random numbers of a path from a light, by vertex; beyond those of the camera's.
enum LightDimension : uint32_t {
  kEmitterPoint = 0x40000000u,
  kEmissionPoint,
  kLightTechnique,
  kLightPoint,
  kLightChoice,
  kLightRoulette,
  kLightLens,
  kLightBounce,
  kLightStraight,
  kLightLobe,
  kLightPerVertex = 16
};

namespace detail {

// The next surface that a ray of light ends at, and what is left of it, as the camera finds it.
template <uint32_t N, size_t K>
Hit traceLight(const RenderScene& world, Ray& ray, bool first, uint32_t key, Rgb& left, uint16_t& passed) {
  for (uint32_t k = 0;; ++k) {
    const Hit hit = world.accel.intersect(ray);
    if (!hit.valid() || !mayPass(world, ray, hit, world.mostTransparent)) return hit;
    const auto x = interact<N, K>(world.scene, world.geometry, reversed(ray.direction, ray.path.time, 1), hit);
    const float q = passing(x);
    if (!(q > 0)) return hit;
    if (toUnit(combine(key, k)) >= q) {
      left = left / (1 - q);
      return hit;
    }
    left *= (first ? x.surface.transparent : x.surface.straight()) / q;
    ray.tMin = behind(x, ray.direction, hit.t);
    ray.left = x.primitive;
    ray.path = ray.path.passed();
    ++passed;
  }
}

// Where light goes on from a surface that it came to: a direction of its lobes, by their strength, or now and then any,
// since what the surface is to its viewer may send light where it does not. Its density by solid angle; 0: it ends.
template <size_t K>
struct Onward {
  Vec3f direction{0, 0, 1};
  float pdf = 0;
  bool sharp = false;  // by a lobe of one direction; pdf: how often it is taken
};

template <size_t K, class X>
Onward<K> onward(const X& x, const Sampler& sampler, uint32_t key, uint32_t dimension, uint32_t index) {
  using Of = Techniques<K>;
  const auto& surface = x.surface;
  const auto sharp = [&](size_t t) { return isSharp<K>(surface, t); };
  const Fractions<K> a = albedoFractions<K>(surface);
  float all = 0, rough = 0;
  for (size_t t = 0; t < Of::kSurface; ++t) {
    all += a[t];
    if (!sharp(t)) rough += a[t];
  }
  Onward<K> to;
  const bool through = surface.transmits();
  float choice = sampler.get1D(key, dimension + kLightTechnique, index);
  const Vec2f u = sampler.get2D(key, dimension + kLightPoint, index);
  const float any = rough > 0 ? 0.1f : all > 0 ? 0.01f : 1;
  if (choice < any) {
    choice /= any;
    const float side = !through || choice < 0.5f ? 1.0f : -1.0f;
    to.direction = Framef::around(x.geometric * side).toWorld(toCosineHemisphere(u));
  } else {
    choice = (choice - any) / (1 - any) * all;
    size_t t = 0, last = 0;
    for (; t < Of::kSurface; ++t) {
      if (!(a[t] > 0)) continue;
      last = t;
      if (choice < a[t]) break;
      choice -= a[t];
    }
    if (t == Of::kSurface) t = last;
    if (t == Of::kCosine) {
      to.direction = x.frame.toWorld(toCosineHemisphere(u));
    } else {
      const auto in = [&]<class T>(T) {
        const Vec3f wo = x.frame.toLocal(x.wo);
        typename LobeSurface<K>::Sample from;
        const Vec3<T> d = surface.sample(t, Vec3<T>{T(wo.x), T(wo.y), T(wo.z)}, Vec2<T>{T(u.x), T(u.y)},
                                         sampler.get1D(key, dimension + kLightChoice, index), from);
        if (!(dot(d, d) > T(0))) return false;
        to.direction =
            x.frame.toWorld(Vec3f{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)});
        if (from.lost || from.transmits != (dot(x.geometric, to.direction) < 0)) return false;
        if (sharp(t)) {
          to.sharp = true;
          surface.eachSharp(d, Vec3<T>{T(wo.x), T(wo.y), T(wo.z)}, [&](size_t slot, const auto& lobe) {
            to.pdf += (1 - any) * a[slot] / all * surface.share(lobe);
          });
        }
        return true;
      };
      const bool found = surface.needsDouble(dot(x.frame.z, x.wo)) ? in(double{}) : in(float{});
      if (!found) return {};
    }
  }
  to.direction = normalize(to.direction);
  if (to.sharp) return to;
  Scattering<K> s;
  scatter<K>(x, to.direction, s);
  if (!(s.cosLight > 0)) return {};
  const float byCosine = through || s.ahead ? s.cosLight * (1 / kPi<float>)*(through ? 0.5f : 1.0f) : 0;
  to.pdf = any * byCosine;
  if (all > 0)
    for (size_t t = 0; t < Of::kSurface; ++t) to.pdf += sharp(t) ? 0 : (1 - any) * a[t] / all * s.p[t];
  return to;
}

}  // namespace detail

// The camera's first vertices: what techniques get there, whatever pixel shows them.
template <size_t K>
struct FirstCounts {
  const KernelInput<K>& in;
  const RenderScene& world;
  template <class S>
  Fractions<K> operator()(const S& surface) const {
    Fractions<K> n = firstFractions<K>(in, surface, techniquesAt<K>(surface, world.emitters.any(), world.surfaceRays));
    for (float& each : n) each *= static_cast<float>(in.samplesPerHit);
    return n;
  }
};

// What a vertex brings to the film.
template <uint32_t N, size_t K>
void splat(const KernelInput<K>& in, const LightVertex& v, Vec2f lens, std::vector<Splat>& splats, Counts& counts) {
  const RenderScene& world = in.scene;
  const LightPaths& light = *in.light;
  if (world.geometry.placements[v.hit.placement].holdout || !world.emitters.reaches(v.emitter, v.length - 1)) return;
  const auto seen = in.camera.seen(v.position, lens, kMiddle);
  const float margin = in.filter.radius();
  if (!seen || !(seen->px > static_cast<float>(in.x0) - margin) || !(seen->py > static_cast<float>(in.y0) - margin) ||
      !(seen->px < static_cast<float>(world.scene.film.x1) + margin) ||
      !(seen->py < static_cast<float>(world.scene.film.y1) + margin))
    return;
  Ray ray = detail::reversed(seen->towards, kMiddle, 0);
  ray.kind = kSeenByCamera;
  const SeenVertex<N, K> at(world, light, v, ray, v.length - 1, FirstCounts<K>{in, world}, kAtFirst);
  if (!(maxComponent(at.f) > 0) || at.x.surface.holdout >= 1) return;
  ray.origin = at.x.leave(seen->towards), ray.direction = seen->towards;
  ray.left = at.x.primitive;
  ray.tMax = seen->clear;
  ray.path.transparent = static_cast<uint16_t>(v.passed + v.passedFirst);
  ++counts.lightRays;
  const Rgb left = transmittance<N, K, false>(world, ray);
  if (isBlack(left) || ray.path.transparent > world.mostTransparent) return;
  const double camera = double(seen->importance) * double(at.s.cosViewer);
  Ways ways = at.others * light.power(camera);
  ways += Ways::one(kAtFilm, light.power(light.perPixel()));
  const Rgb value = at.f * v.flux * left * static_cast<float>(camera / (double(at.s.cosLight) * double(light.paths)));
  splats.push_back({seen->px, seen->py, value, v.length, ways});
}

// Adds a vertex to those that are connected.
template <size_t K, class X>
void keep(const LightPaths& light, const LightVertex& v, const X& x, float cosLight, LightList& to) {
  const double others = light.endAt(v, kAtLater).others(light.power(1 / kPi<double>)).sum();
  to.vertices.push_back(v);
  to.sketches.push_back({v.position, dot(x.geometric, v.towards) < 0 ? -x.geometric : x.geometric,
                         luminance(absolute(v.flux)) / cosLight, static_cast<float>(std::min(others, 1e30)), v.length,
                         x.surface.transmits(), onlySharp<K>(x.surface)});
}

// Adds the vertices of a path, and what they bring to the film. index: of the path, among all of the image.
template <uint32_t N, size_t K>
void traceLightPath(const KernelInput<K>& in, uint32_t index, LightList& to, Counts& counts) {
  const RenderScene& world = in.scene;
  const LightPaths& light = *in.light;
  const uint32_t key = in.sampler.pixelKey(0x4c494748u, 0x54u);
  constexpr float time = kMiddle;
  const EmittedRay emitted = light.emission.sample(in.sampler.getChoice(key, kEmitterPoint, index),
                                                   in.sampler.get2D(key, kEmissionPoint, index), time);
  if (!(emitted.pdf > 0)) return;
  Ray ray;
  ray.origin = emitted.origin, ray.direction = emitted.direction;
  ray.kind = kSeenByDiffuse;
  ray.path.time = time;
  if (emitted.on.valid() && world.accel.shared(emitted.on)) ray.left = emitted.on;
  LightVertex v{};
  v.emitter = emitted.emitter;
  Rgb left{1, 1, 1};
  float survived = 1;
  for (int length = 1; length <= in.limits.depth; ++length) {
    const uint32_t dimension = static_cast<uint32_t>(length) * kLightPerVertex;
    const bool first = length == 1;
    ++counts.lightRays;
    const uint32_t straight = combine(combine(key, dimension + kLightStraight), index);
    v.hit = detail::traceLight<N, K>(world, ray, first, straight, left, first ? v.passedFirst : v.passed);
    if (!v.hit.valid() || !detail::lightReaches(world, v.hit)) return;
    const auto x = interact<N, K>(world.scene, world.geometry, ray, v.hit);
    const float cosLight = std::abs(dot(x.geometric, ray.direction));
    if (!x.surface.reflects() || !(cosLight > 0)) return;
    const Vec3f before = v.position;
    v.position = x.position, v.towards = -ray.direction;
    v.length = static_cast<uint16_t>(length);
    if (first) {
      v.distance = wardmis::length(emitted.origin - x.position);
      const LightSample arriving =
          world.emitters.arriving(v.emitter, nullptr, v.position, v.towards, v.distance, 0, time);
      const float density = light.emission.density(v.emitter, v.position, v.towards, v.distance, time);
      if (!(density > 0)) return;
      v.flux = arriving.radiance / density;
      v.density = light.power(double(density) * double(cosLight));
    } else {
      const Vec3f way = v.position - before;
      const double d2 = double(dot(way, way));
      if (!(d2 > 0)) return;
      v.density *= light.power(double(cosLight) / d2), v.back = v.back * light.power(1 / d2);
    }
    v.flux *= left;
    left = {1, 1, 1};
    if (isBlack(v.flux)) return;
    if (light.connects()) keep<K>(light, v, x, cosLight, to);
    if (light.toFilm) {
      if (v.length < to.tried.size()) ++to.tried[v.length];
      splat<N, K>(in, v, in.sampler.get2D(key, dimension + kLightLens, index), to.splats, counts);
    }
    if (length == in.limits.depth) return;

    const auto next = detail::onward<K>(x, in.sampler, key, dimension, index);
    if (!(next.pdf > 0)) return;
    const auto lobe = next.sharp ? std::optional(in.sampler.get1D(key, dimension + kLightLobe, index)) : std::nullopt;
    const SeenVertex<N, K> seen(world, light, v, detail::reversed(next.direction, time, 1), length - 1,
                                LaterCounts<K>{world.emitters.any()}, kAtLater, lobe);
    if (!(maxComponent(seen.f) > 0)) return;
    const Rgb step = seen.f * (seen.s.spread * seen.s.cosViewer / (seen.s.cosLight * next.pdf));
    v.flux *= step;
    survived *= maxComponent(step);
    // what the light's path carries on, as the camera's, but for cosines that it is told without
    const float q = std::sqrt(survived);
    if (q < 1) {
      if (in.sampler.get1D(key, dimension + kLightRoulette, index) >= q) return;
      v.flux *= 1 / q;
      survived /= q;
    }
    if (light.countsBounces && length > 1)
      ++v.bounces[detail::bounceOf<K>(seen.x.surface, seen.s, LaterCounts<K>{true}(seen.x.surface),
                                      in.sampler.get1D(key, dimension + kLightBounce, index))];
    v.joins = !next.sharp;
    v.density = light.power(double(seen.s.light(seen.x.surface)));
    v.back = seen.others * light.power(double(seen.s.cosViewer));
    ray.origin = x.leave(next.direction), ray.direction = next.direction;
    ray.tMin = Ray{}.tMin;
    ray.left = x.primitive;
  }
}

}  // namespace wardmis
