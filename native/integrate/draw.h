// SPDX-License-Identifier: GPL-3.0-or-later
// The first step at a vertex: samples of every technique, as one batch.
#pragma once

#include <array>
#include <cstddef>

#include "bsdf/batch.h"
#include "integrate/interaction.h"
#include "integrate/plan.h"
#include "integrate/trace.h"
#include "math/random.h"
#include "math/scratch.h"
#include "math/warp.h"

namespace wardmis {

template <class X, class T>
Vec3f inWorld(const X& x, const Vec3<T>& wi) {
  return normalize(
      x.frame.toWorld(Vec3f{static_cast<float>(wi.x), static_cast<float>(wi.y), static_cast<float>(wi.z)}));
}

// The integrands that a surface has of its own. Below its normal's horizon, which looks into the surface, a lobe is
// zero.
template <uint32_t N, size_t K, class X>
PerIntegrand<bool, K> integrandsOf(const X& x) {
  using Of = Techniques<K>;
  PerIntegrand<bool, K> present{};
  if constexpr ((N & kNeedsSpecular) != 0) {
    const bool seen = (N & kNeedsLobes) != 0 || x.frame.toLocal(x.wo).z > 0;
    for (size_t l = 0; l < Of::kLobes; ++l) present[l] = x.surface.hasLobe(l) && seen;
  }
  present[Of::kCosine] = (N & kNeedsDiffuse) != 0 && x.surface.hasDiffuse();
  return present;
}

// Samples in the order of their techniques. Directions are local, in double where T is.
template <uint32_t N, class T, size_t K>
struct Draws {
  static constexpr bool kGeneral = (N & kNeedsLobes) != 0;  // any lobes, else one of Ward's
  using LobeSample = typename LobeSurface<K>::Sample;
  using Surface = InteractionOf<SurfaceOf<N, K>>;

  int count = 0;
  std::array<int, K> end{};  // of each technique's
  LobeBatch<T, Techniques<K>::kLobes, kMaxSamplesPerHit> batch;
  Scratch<LobeSample, kGeneral ? kMaxSamplesPerHit : 1> lobe;  // of a lobe's sample: of which of a technique's
  Scratch<LightSample, kMaxSamplesPerHit> light;               // of a sample of the light
  Scratch<Environment::Place, kMaxSamplesPerHit> sky;          // of a sample of the surface: where it looks at a sky
  bool skyAhead;                                               // for which it then waits no more

  // view: of the lights; wo: local.
  Draws(const RenderScene& world, const Sampler& sampler, const Surface& x, const HitPlan<K>& plan,
        const LightView& view, const PerIntegrand<bool, K>& present, Vec3<T> wo)
      : skyAhead(world.emitters.skyAhead()) {
    using Of = Techniques<K>;
    const uint32_t dimension = plan.vertex * Dimensions<K>::kPerVertex;
    const Sampler::Visit visit(sampler, plan.pixelKey, dimension, plan.index);
    const auto technique = [&](size_t t) { return dimension + Dimensions<K>::kTechnique + static_cast<uint32_t>(t); };
    const auto point = [&](size_t t, int m) { return visit.point<Vec2f>(technique(t), static_cast<uint32_t>(m)); };
    const std::array<int, K> n =
        systematicCounts<K>(plan.fractions, plan.samples, visit.counts(dimension + Dimensions<K>::kSampleCounts));
    Scratch<LightChoice, kMaxSamplesPerHit> lights;  // first of all, see Emitters::choose()
    for (int m = 0; m < n[Of::kLight]; ++m)
      lights.make(m, [&] {
        return world.emitters.choose(view, visit.point<ChoicePoint>(technique(Of::kLight), static_cast<uint32_t>(m)));
      });

    for (size_t l = 0; l < Of::kLobes; ++l) {
      if constexpr ((N & kNeedsSpecular) != 0)
        for (int m = 0; m < n[l]; ++m) {
          const Vec2f u = point(l, m);
          if constexpr (kGeneral) {
            // by what the lobe is chosen, apart from its point: the complement of that one's dimension
            const float choice = visit.choice(~technique(l), static_cast<uint32_t>(m));
            LobeSample chosen;
            batch.set(count, present[l] ? x.surface.sample(l, wo, Vec2<T>{T(u.x), T(u.y)}, choice, chosen) : Vec3<T>{});
            lobe.set(count++, chosen);
          } else {
            batch.set(count++, x.surface.sampleLobe(l, wo, Vec2<T>{T(u.x), T(u.y)}));
          }
        }
      end[l] = count;
    }
    if constexpr ((N & kNeedsDiffuse) != 0)
      for (int m = 0; m < n[Of::kCosine]; ++m) {
        const Vec2f u = point(Of::kCosine, m);
        batch.set(count++, toCosineHemisphere<T>({T(u.x), T(u.y)}));
      }
    end[Of::kCosine] = count;

    for (int m = 0; m < n[Of::kLight]; ++m) world.emitters.aim(lights[m]);
    if (skyAhead)
      for (int k = 0; k < count; ++k) {
        const Vec3<T> wi = batch.wi(k);
        if (kGeneral ? dot(wi, wi) > T(0) : wi.z > T(0))  // else it is not followed
          sky.make(k, [&] { return world.emitters.skyAhead(inWorld(x, wi)); });
      }
    for (int m = 0; m < n[Of::kLight]; ++m, ++count) {
      light.make(count, [&] {
        return world.emitters.sample(x.position, lights[m], static_cast<int>(plan.vertex), x.path.time);
      });
      const Vec3f wi = x.frame.toLocal(light[count].direction);
      batch.set(count, {T(wi.x), T(wi.y), T(wi.z)});
    }
    end[Of::kLight] = count;
  }
};

}  // namespace wardmis
