// SPDX-License-Identifier: GPL-3.0-or-later
// Ward over arrays of floats in several ways, all of one form: scalar, with the standard library's functions, as one
// writes it without a thought of vectors; and the renderer's own loops, for each instruction set.
#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <vector>

#include "bsdf/batch.h"
#include "math/clones.h"
#include "statistics.h"

namespace wardmis::test {

using Evaluate = void (*)(WardVariant, const WardArrays<float>&, Vec3f wo, float invAx, float invAy);

// n numbers (u1, u2), and where to put the directions of wardSample().
struct SampleArrays {
  int n;
  const float *u1, *u2;
  float *x, *y, *z;
};
using Sample = void (*)(const SampleArrays&, Vec3f wo, float ax, float ay);

struct Loops {
  const char* name;
  bool here;  // this processor has the instructions
  Evaluate evaluate;
  Sample sample;
};

inline void evaluateLibm(WardVariant variant, const WardArrays<float>& a, Vec3f wo, float invAx, float invAy) {
  for (int j = 0; j < a.n; ++j) {
    a.fCos[j] = a.pdf[j] = 0;
    const float ci = a.z[j], co = wo.z;
    if (!(ci > 0) || !(co > 0)) continue;
    const float hz = ci + co, sx = (a.x[j] + wo.x) / hz, sy = (a.y[j] + wo.y) / hz;
    const float x = sx * invAx, y = sy * invAy, slope = 1 + sx * sx + sy * sy;
    const float e = invAx * invAy * (1 / kPi<float>)*std::exp(-(x * x + y * y));
    a.pdf[j] = 0.5f * e * slope / hz;
    a.fCos[j] = variant == WardVariant::kWard      ? 0.25f * e * std::sqrt(ci / co)
                : variant == WardVariant::kWardDur ? 0.25f * e / co
                                                   : e * slope * ci / (hz * hz);
  }
}
inline void sampleLibm(const SampleArrays& a, Vec3f wo, float ax, float ay) {
  for (int j = 0; j < a.n; ++j) {
    const float r = std::sqrt(-std::log(1 - a.u1[j])), phi = 2 * kPi<float> * a.u2[j];
    const float sx = ax * r * std::cos(phi), sy = ay * r * std::sin(phi);
    const float k = 2 * (sx * wo.x + sy * wo.y + wo.z) / (1 + sx * sx + sy * sy);
    a.x[j] = k * sx - wo.x, a.y[j] = k * sy - wo.y, a.z[j] = k - wo.z;
  }
}

inline void sampleLoop(const SampleArrays& a, Vec3f wo, float ax, float ay) {
  const float* __restrict u1 = a.u1, * __restrict u2 = a.u2;
  float* __restrict x = a.x, * __restrict y = a.y, * __restrict z = a.z;
  for (int j = 0; j < a.n; ++j) {
    const Vec3f wi = wardSample(wo, ax, ay, {u1[j], u2[j]});
    x[j] = wi.x, y[j] = wi.y, z[j] = wi.z;
  }
}

#if WARDMIS_HAS_CLONES
#define WARDMIS_LOOPS(NAME, ISA)                                                                                    \
  __attribute__((target(ISA), flatten)) inline void evaluate##NAME(WardVariant variant, const WardArrays<float>& a, \
                                                                   Vec3f wo, float invAx, float invAy) {            \
    wardLoop(variant, a, wo, invAx, invAy);                                                                         \
  }                                                                                                                 \
  __attribute__((target(ISA), flatten)) inline void sample##NAME(const SampleArrays& a, Vec3f wo, float ax,         \
                                                                 float ay) {                                        \
    sampleLoop(a, wo, ax, ay);                                                                                      \
  }
WARDMIS_LOOPS(Sse2, "arch=x86-64")
WARDMIS_LOOPS(Avx2, "arch=x86-64-v3")
WARDMIS_LOOPS(Avx512, "arch=x86-64-v4")
#undef WARDMIS_LOOPS
#endif

// The first is the scalar one.
inline std::vector<Loops> loops() {
  std::vector<Loops> all{{"scalar libm", true, evaluateLibm, sampleLibm}};
#if WARDMIS_HAS_CLONES
  all.push_back({"SSE2", true, evaluateSse2, sampleSse2});
  all.push_back({"AVX2", __builtin_cpu_supports("x86-64-v3") != 0, evaluateAvx2, sampleAvx2});
  all.push_back({"AVX-512", __builtin_cpu_supports("x86-64-v4") != 0, evaluateAvx512, sampleAvx512});
#endif
  return all;
}

// Samples of a lobe and of the sphere, so that all of the exponential's range is met.
struct Directions {
  static constexpr float kAx = 0.3f, kAy = 0.1f;
  Vec3f wo{0.6f, 0, 0.8f};
  std::vector<float> u1, u2, x, y, z, fCos, pdf, sampledX, sampledY, sampledZ;

  explicit Directions(int n) {
    Random random(1);
    for (int j = 0; j < n; ++j) {
      const Vec2f u = random.square<float>();
      const Vec3<double> d = random.direction();
      const Vec3f wi = j % 2 == 0 ? wardSample(wo, kAx, kAy, u)
                                  : Vec3f{static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
      u1.push_back(u.x), u2.push_back(u.y), x.push_back(wi.x), y.push_back(wi.y), z.push_back(wi.z);
    }
    for (std::vector<float>* result : {&fCos, &pdf, &sampledX, &sampledY, &sampledZ}) result->resize(u1.size());
  }
  int count() const { return static_cast<int>(u1.size()); }
  void evaluate(Evaluate f, WardVariant v = WardVariant::kWardGmd) {
    f(v, {count(), x.data(), y.data(), z.data(), fCos.data(), pdf.data()}, wo, 1 / kAx, 1 / kAy);
  }
  void sample(Sample f) {
    f({count(), u1.data(), u2.data(), sampledX.data(), sampledY.data(), sampledZ.data()}, wo, kAx, kAy);
  }
};

// Seconds of one call: on a machine with other work, the least of many is the nearest to the truth. What is compared is
// timed in turn, so that a change of pace meets all.
template <class... F>
std::array<double, sizeof...(F)> bestSeconds(int rounds, F&&... calls) {
  std::array<double, sizeof...(F)> best;
  best.fill(1e30);
  for (int round = 0; round < rounds; ++round) {
    size_t i = 0;
    const auto time = [&](auto&& call) {
      const auto began = std::chrono::steady_clock::now();
      call();
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
      best[i] = std::min(best[i], seconds), ++i;
    };
    (time(calls), ...);
  }
  return best;
}

}  // namespace wardmis::test
