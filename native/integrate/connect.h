// SPDX-License-Identifier: GPL-3.0-or-later
// A camera's path and one from a light, joined by a ray between their last vertices.
#pragma once

#include <optional>

#include "integrate/light_paths.h"
#include "integrate/scatter.h"
#include "integrate/trace.h"

namespace wardmis {
namespace detail {

// Whether paths from the lights know what a surface is to the camera: not a curve, which shows itself to each ray
// otherwise, nor one whose program asks how the path came there.
inline bool lightReaches(const RenderScene& world, const Hit& hit) {
  const Shape& shape = world.geometry.shapes[hit.shape];
  const Material& m = world.scene.materials[static_cast<size_t>(shape.material)];
  return shape.strands == nullptr && !(m.program && (m.program->reads & (kReadsRay | kReadsShift)) != 0);
}

// A ray of light's path, as one from the camera would have come the other way.
inline Ray reversed(Vec3f direction, float time, int depth) {
  Ray ray;
  ray.direction = -direction;
  ray.kind = kSeenByDiffuse;
  ray.path.time = time;
  if (depth > 0)
    ray.path.kinds = kDiffuseRay | kReflectionRay, ray.path.depth = static_cast<uint8_t>(std::min(depth, 255));
  return ray;
}

// The kind of bounce by which the camera's path would have gone out of a surface in this direction: at random, as often
// as it would have been each.
template <size_t K, class S>
Bounce bounceOf(const S& surface, const Scattering<K>& s, const Fractions<K>& n, float u) {
  if (!s.ahead) return kTransmissionBounce;
  float diffuse = 0, all = 0;
  for (size_t t = 0; t < Techniques<K>::kSurface; ++t) {
    const float q = n[t] * s.p[t];
    all += q;
    if (t == Techniques<K>::kCosine || (surface.rays(t, true) & kSeenByGlossy) == 0) diffuse += q;
  }
  return u * all < diffuse ? kDiffuseBounce : kGlossyBounce;
}

}  // namespace detail

// A vertex of a light's path as a path from the camera sees it.
template <uint32_t N, size_t K>
struct SeenVertex {
  InteractionOf<SurfaceOf<N, K>> x;
  Scattering<K> s;
  Rgb f{0, 0, 0};  // f cos of the light that comes there, which any technique brings
  Ways others;     // PathEnd::others(), in which the camera made more of the path

  // ray: to the vertex; depth: bounces of the whole path; counts: expected samples of the camera's techniques there, of
  // its surface; join: of connections that are made from there; sharp: random, where a sharp lobe is asked for.
  template <class Counts>
  SeenVertex(const RenderScene& world, const LightPaths& light, const LightVertex& v, const Ray& ray, int depth,
             Counts&& counts, Join join, std::optional<float> sharp = {})
      : x(interact<N, K>(world.scene, world.geometry, ray, v.hit)) {
    if (sharp)
      scatterSharp<K>(x, v.towards, *sharp, s);
    else
      scatter<K>(x, v.towards, s);
    if (!(s.cosLight > 0) || !(s.cosViewer > 0)) return;
    const Fractions<K> n = counts(x.surface);
    if (v.length == 1) {
      const LightView view = lightsAt<N>(world, x);
      const LightSample arriving =
          world.emitters.arriving(v.emitter, &view, v.position, v.towards, v.distance, depth, ray.path.time);
      const LightEdge<K> edge = lightEdge<K>(x, s, arriving);
      f = edge.f;
      // each technique that finds the emitter is one of its own in the weights of a hit
      double found = 0;
      for (size_t t = 0; edge.surfaces && t < Techniques<K>::kSurface; ++t)
        found += light.power(double(n[t]) * double(s.p[t]));
      found += light.power(double(n[Techniques<K>::kLight]) * double(edge.light));
      others = PathEnd{kByCamera, found, {}, v.density}.others(0);
    } else {
      f = total(s.f);
      others = light.endAt(v, join).others(light.power(double(s.camera(n))), !s.sharp);
    }
  }
};

// The expected samples of the techniques at a vertex from the second on.
template <size_t K>
struct LaterCounts {
  bool lights;
  template <class S>
  Fractions<K> operator()(const S& surface) const {
    Fractions<K> n = albedoFractions<K>(surface);
    for (float& each : n) each *= 2;
    if (!lights) n[Techniques<K>::kLight] = 0;
    return n;
  }
};

// A vertex for a connection, one of several at random, by about what each would bring; and the number of vertices that
// it stands for.
struct Chosen {
  size_t index = 0;
  float weight = 0;  // 0: none would bring anything
};
template <class X>
Chosen chooseVertex(const CameraVertex& c, const X& x, uint32_t vertex, uint32_t key) {
  const LightPaths& light = c.light;
  constexpr uint32_t kAmong = 8;
  constexpr float kBehind = 0.01f, kMatte = 1 / kPi<float>;  // the latter: a density
  const bool through = x.surface.transmits();
  const auto own = static_cast<float>(c.perVertex(vertex));
  Chosen chosen;
  float sum = 0, value = 0;
  for (uint32_t k = 0; k < kAmong; ++k) {
    const uint32_t random = combine(key, 2 * k);
    const auto i = static_cast<size_t>(uint64_t{random} * light.sketches.size() >> 32);
    const LightSketch& s = light.sketches[i];
    if (static_cast<int>(vertex) + 1 + s.length > c.depth) continue;
    const Vec3f to = s.position - x.position;
    const float d2 = dot(to, to);
    if (!(d2 > 0)) continue;
    const float inverse = 1 / d2, here = dot(to, x.geometric), there = -dot(to, s.normal);
    float each = s.flux * std::abs(here * there) * inverse * inverse;
    if (here < 0 && !through) each *= kBehind;
    if (there < 0 && !s.transmits) each *= kBehind;
    if (s.sharp) each *= kBehind;
    each *= own / (own + kMatte * std::abs(there) * inverse * std::sqrt(inverse) * s.others);
    if (!(each > 0)) continue;
    sum += each;
    if (toUnit(combine(key, 2 * k + 1)) * sum < each) chosen.index = i, value = each;
  }
  if (value > 0) chosen.weight = static_cast<float>(light.sketches.size()) * sum / (kAmong * value);
  return chosen;
}

// What a connection brings, times the number of vertices; of what is not black, all ways by which it may come and the
// weight of this one.
struct Connection {
  Rgb value{0, 0, 0};
  double weight = 0;
  Ways ways{};
};

// One of x and a light's vertex. n: expected samples of the techniques at x; u: random.
template <uint32_t N, size_t K, class Counts>
Connection connect(const RenderScene& world, const CameraVertex& c, const InteractionOf<SurfaceOf<N, K>>& x,
                   const Fractions<K>& n, int vertex, const LightVertex& v, Vec2f u, Counts& counts) {
  const Connection none;
  if (vertex + 1 + v.length > c.depth || !world.emitters.reaches(v.emitter, vertex + v.length)) return none;
  const Vec3f to = v.position - x.position;
  const float d2 = dot(to, to);
  if (!(d2 > 0)) return none;
  const Vec3f d = to / std::sqrt(d2);
  Scattering<K> here;
  scatter<K>(x, d, here);
  const Rgb f = total(here.f);
  if (!(maxComponent(f) > 0) || !(here.cosLight > 0)) return none;
  Ray ray = detail::reversed(-d, x.path.time, x.path.depth + 1);
  const SeenVertex<N, K> there(world, c.light, v, ray, vertex + v.length, LaterCounts<K>{world.emitters.any()},
                               kAtLater);
  if (!(maxComponent(there.f) > 0)) return none;
  if (c.light.countsBounces) {
    auto left = c.left;
    for (size_t k = 0; k < kBounceKinds; ++k) left[k] -= v.bounces[k];
    --left[detail::bounceOf<K>(x.surface, here, n, u.x)];
    if (v.length > 1) --left[detail::bounceOf<K>(there.x.surface, there.s, LaterCounts<K>{true}(there.x.surface), u.y)];
    for (const int l : left)
      if (l < 0) return none;
  }
  ray.origin = x.leave(d);
  const Vec3f way = there.x.leave(-d) - ray.origin;
  const float length2 = dot(way, way);
  if (!(length2 > 0)) return none;
  const float length = std::sqrt(length2);
  ray.direction = way / length;
  ray.tMax = length * (1 - 1e-4f);  // where nothing rounds in the surface's position, the ray's end does
  ray.left = x.primitive, ray.aimed = there.x.primitive;
  ray.path.transparent = static_cast<uint16_t>(x.path.transparent + v.passed + v.passedFirst);
  ++counts.connections;
  const Rgb left = transmittance<N, K, false>(world, ray);
  if (isBlack(left) || ray.path.transparent > world.mostTransparent ||
      ray.path.transparent - v.passedFirst >= world.mostFollowed)
    return none;
  const WeightPower& power = c.light.power;
  const Join join = joinAt(static_cast<uint32_t>(vertex));
  const double g = double(there.s.cosViewer) / double(d2), back = double(here.cosLight) / double(d2),
               own = power(c.perVertex(static_cast<uint32_t>(vertex)));
  const double reverse = double(there.s.light(there.x.surface));
  Ways ways = there.others * power(double(here.camera(n)) * g);
  ways.of[kAtLater] *= power(c.ways.laterConnections);
  ways += c.end.others(power(double(here.light(x.surface)))) * power(reverse * back);
  ways += Ways::one(join, own);
  const double weight = c.ways.weight(join, own, ways);
  return {f * there.f * v.flux * left * static_cast<float>(weight * g / double(there.s.cosLight)), weight, ways};
}

}  // namespace wardmis
