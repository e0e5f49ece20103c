// SPDX-License-Identifier: GPL-3.0-or-later
// The sampling techniques, and the moments of an integrand under them, pooled over the samples of all techniques.
#pragma once

#include <array>
#include <cstdint>

namespace wardmis {

enum Technique : uint8_t { kLobe = 0, kCosine = 1, kLight = 2 };  // p_1: Ward's lobe, p_2: cos/pi, p_3: emitters
inline constexpr int kTechniques = 3;
inline constexpr const char* kTechniqueNames[kTechniques] = {"lobe", "cosine", "light"};   // in what is written
inline constexpr const char* kTechniqueLabels[kTechniques] = {"Lobe", "Cosine", "Light"};  // in the names of passes
using TechniqueMask = uint8_t;                                                             // bit i: technique i
using Fractions = std::array<float, kTechniques>;

constexpr TechniqueMask maskOf(Technique t) { return static_cast<TechniqueMask>(1u << t); }
inline constexpr TechniqueMask kAllTechniques = 7;
inline constexpr TechniqueMask kSpecularTechniques = maskOf(kLobe) | maskOf(kLight);
inline constexpr TechniqueMask kDiffuseTechniques = maskOf(kCosine) | maskOf(kLight);

// Per technique i, sums over hits of estimates of
//   second = m_i^2 = integral f^2/p_i            (of F_i,prim = f/p_i, Def. 9)
//   square, mean: integrals of g^2 p_i and g p_i with g = f/sum_k p_k   (sigma^2_i,eq = square - mean^2, Def. 8)
// each from the samples of *all* techniques: sum_kj h(X_kj)/sum_l n_l p_l(X_kj) for the integral of h.
struct Moments {
  Fractions second{}, square{}, mean{};
  float hits = 0;

  Moments& operator+=(const Moments& b) {
    for (int i = 0; i < kTechniques; ++i) {
      second[i] += b.second[i];
      square[i] += b.square[i];
      mean[i] += b.mean[i];
    }
    hits += b.hits;
    return *this;
  }

  // One sample: value f, densities p, expected counts n, of the techniques `used` for this integrand.
  void add(float f, const Fractions& p, const Fractions& n, TechniqueMask used) {
    if (!(f > 0)) return;  // zeros count in the number of hits
    float q = 0, sum = 0;
    for (int k = 0; k < kTechniques; ++k)
      if ((used >> k & 1u) != 0) q += n[k] * p[k], sum += p[k];
    const float overQ = f / q, g = f / sum;
    for (int k = 0; k < kTechniques; ++k) {
      if ((used >> k & 1u) == 0 || !(p[k] > 0)) continue;
      second[k] += f / p[k] * overQ;
      const float gp = g * p[k] / q;
      square[k] += g * gp;
      mean[k] += gp;
    }
  }
};

}  // namespace wardmis
