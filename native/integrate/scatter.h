// SPDX-License-Identifier: GPL-3.0-or-later
// What a surface sends of light out of one direction to its viewer, and the densities by which either end of a path
// goes on there: for connections, and for subpaths from the lights, whose surfaces are seen as by a path from the
// camera.
#pragma once

#include "integrate/interaction.h"
#include "integrate/shares.h"
#include "world/emitters.h"

namespace wardmis {

// The density at which a path from the lights goes on to the viewer of a surface, which it comes to out of the
// direction of a sample. By reciprocity: the surface sends light to the viewer as often as a path from there would be
// sent to the light, but for the cosines. It is for weights alone, which may take any density as long as all take the
// same: so no surface need be asked a second time what it is to light that comes the other way.
// p: of the techniques at that direction; cosines: absolute, with the face's normal.
template <size_t K, class S>
float lightDensity(const S& surface, const Fractions<K>& p, float cosViewer, float cosLight) {
  if (!(cosLight > 0)) return 0;
  const Fractions<K> a = albedoFractions<K>(surface);
  float mixture = 0;
  for (size_t t = 0; t < Techniques<K>::kSurface; ++t) mixture += 2 * a[t] * p[t];
  return mixture * (cosViewer / cosLight);
}

template <size_t I>
Rgb total(const std::array<Rgb, I>& f) {
  Rgb sum = f[0];
  for (size_t i = 1; i < I; ++i) sum += f[i];
  return sum;
}

// The same of a sharp lobe, per solid angle of the light's one direction. p: how often the lobe is drawn; spread: of
// viewers over light (LobeSurface::spread()).
template <size_t K, class S>
float sharpLightDensity(const S& surface, const Fractions<K>& p, float spread) {
  return lightDensity<K>(surface, p, 1, spread);
}

// Whether a sharp lobe has the same normal seen from where its light comes as from its viewer. Neither may look so that
// what a mirror showed it would lie behind the face, or nearly: such normals are bent (program/surface.h).
inline bool isReversible(Vec3f normal, Vec3f face, Vec3f wi, Vec3f wo) {
  constexpr float kLeast = 0.011f;  // normals are bent below .01
  const auto shown = [&](Vec3f w) {
    return dot(face, normal * (2 * dot(normal, w)) - w) * (dot(face, w) < 0 ? -1 : 1);
  };
  return shown(wi) > kLeast && shown(wo) > kLeast;
}

// One direction at a surface.
template <size_t K>
struct Scattering {
  using Values = std::array<Rgb, K - 1>;
  Values f{};  // f cos of each technique's lobes, as samples of surfaces bring it
  Fractions<K> p{};
  LitOtherwise<K> lit;
  bool ahead = true;                  // it leaves on the viewer's side
  float local = 0;                    // its cosine with the shading normal
  float cosLight = 0, cosViewer = 0;  // absolute, with the face's
  bool sharp = false;                 // of a lobe of one direction, as scatterSharp() has it
  float spread = 1;                   // of that

  // The density of the camera's path, with its expected numbers of samples.
  float camera(const Fractions<K>& n) const {
    float q = 0;
    for (size_t t = 0; t < Techniques<K>::kSurface; ++t) q += n[t] * p[t];
    return q;
  }
  template <class S>
  float light(const S& surface) const {
    return sharp ? sharpLightDensity<K>(surface, p, spread) : lightDensity<K>(surface, p, cosViewer, cosLight);
  }
};

// wi: unit, world.
template <size_t K, class X>
void scatter(const X& x, Vec3f wi, Scattering<K>& s) {
  const float side = dot(x.geometric, wi);
  s.ahead = side > 0;
  s.cosLight = std::abs(side), s.cosViewer = std::abs(dot(x.geometric, x.wo));
  const auto in = [&]<class T>(T) {
    const auto local = [&](Vec3f w) {
      const Vec3f l = x.frame.toLocal(w);
      return Vec3<T>{T(l.x), T(l.y), T(l.z)};
    };
    const Vec3<T> d = local(wi);
    s.local = static_cast<float>(d.z);
    if (side != 0) x.surface.evaluate(d, local(x.wo), s.ahead, s.f, s.p, s.lit);
  };
  if (x.surface.needsDouble(dot(x.frame.z, x.wo)))
    in(double{});
  else
    in(float{});
}

// The same where a sharp lobe sends light from wi to the viewer: f is f cos over the density of wi, and p how often the
// lobe is drawn. Of several, one at random (u), which stands for all. Without any, f and p are zero.
template <size_t K, class X>
void scatterSharp(const X& x, Vec3f wi, float u, Scattering<K>& s) {
  const float side = dot(x.geometric, wi);
  s.sharp = true, s.ahead = side > 0;
  s.cosLight = std::abs(side), s.cosViewer = std::abs(dot(x.geometric, x.wo));
  const auto in = [&]<class T>(T) {
    const auto local = [&](Vec3f w) {
      const Vec3f l = x.frame.toLocal(w);
      return Vec3<T>{T(l.x), T(l.y), T(l.z)};
    };
    const Vec3<T> d = local(wi), wo = local(x.wo);
    float all = 0;
    x.surface.eachSharp(d, wo, [&](size_t slot, const auto& lobe) {
      if (lobe.transmits == s.ahead || !isReversible(x.surface.normal(lobe), x.geometric, wi, x.wo)) return;
      const Rgb each = x.surface.weight(lobe, d, wo) * x.surface.share(lobe);
      const float strength = maxComponent(absolute(each));
      if (!(strength > 0)) return;
      all += strength;
      if (u * all >= strength && all > strength) {
        u = (u * all - strength) / (all - strength);
        return;
      }
      u = u * all / strength;
      s.f = {}, s.p = {};
      s.f[slot] = each / strength, s.p[slot] = x.surface.share(lobe);
      s.spread = x.surface.spread(lobe, d, wo);
    });
    for (Rgb& value : s.f) value *= all;
  };
  if (x.surface.needsDouble(dot(x.frame.z, x.wo)))
    in(double{});
  else
    in(float{});
}

// Values of those lobes alone whose rays see what has this visibility.
template <size_t K, class S>
std::array<Rgb, K - 1> seen(const S& surface, std::array<Rgb, K - 1> f, uint8_t visibility, bool ahead) {
  for (size_t l = 0; l < Techniques<K>::kLobes; ++l) {
    uint8_t rays = kSeenByGlossy;
    if constexpr (requires { surface.rays(l, ahead); }) rays = surface.rays(l, ahead);
    if ((visibility & rays) == 0) f[l] = {0, 0, 0};
  }
  if ((visibility & kSeenByDiffuse) == 0) f[Techniques<K>::kCosine] = {0, 0, 0};
  return f;
}

// How a path from the lights may replace what the camera's find of an emitter.
template <size_t K>
struct LightEdge {
  Rgb f{0, 0, 0};        // f cos of its light that such a path brings, too
  float light = 0;       // density of samples of lights that find the same, per solid angle
  bool surfaces = true;  // whether samples of the surface find it
};

// Where light samples are moved (terminator.h), they alone bring their part.
template <size_t K, class X>
LightEdge<K> lightEdge(const X& x, const Scattering<K>& s, const LightSample& light) {
  LightEdge<K> edge;
  if (s.sharp) {
    edge.surfaces = !light.exclusive;
    if (edge.surfaces) edge.f = total(seen<K>(x.surface, s.f, light.visibility, s.ahead));
    return edge;
  }
  const float moved = x.smooth.cutoff > 0 ? x.smooth.amount(s.local, dot(x.geometric, light.direction)) : 0;
  edge.surfaces = !light.exclusive;
  edge.light = moved > 0 ? 0 : light.pdf;
  if (light.exclusive) {
    if (moved > 0) return edge;
    edge.f = total(seen<K>(x.surface, s.lit.any ? s.lit.same : s.f, light.visibility, s.ahead));
    if (s.lit.any) edge.f += total(seen<K>(x.surface, s.lit.other, light.visibility, !s.ahead));
    return edge;
  }
  const float strength = x.surface.strength();
  const auto all = moved > 0   ? s.lit.bySurface(s.f, light.counted, strength)
                   : s.lit.any ? s.lit.blended(s.f, light.counted, strength)
                               : s.f;
  edge.f = total(seen<K>(x.surface, all, light.visibility, s.ahead));
  return edge;
}

}  // namespace wardmis
