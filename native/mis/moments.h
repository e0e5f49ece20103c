// SPDX-License-Identifier: GPL-3.0-or-later
// The sampling techniques, and the moments of an integrand under them, pooled over the samples of all techniques.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

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

// A part of an integrand that the same techniques find. Sums over hits of estimates, per technique i, of
//   second = m_i^2 = integral f^2/p_i  (of F_i,prim = f/p_i, Def. 9)
//   square = integral f^2/sum_k p_k, integral = integral f
struct PartMoments {
  Fractions second{};
  float square = 0, integral = 0;

  PartMoments& operator+=(const PartMoments& b) {
    for (int i = 0; i < kTechniques; ++i) second[i] += b.second[i];
    square += b.square, integral += b.integral;
    return *this;
  }
};

// Sums over hits of estimates of an integrand's moments, each from the samples of *all* techniques: of the integral of
// h sum_kj h(X_kj)/sum_l n_l p_l(X_kj). The second moments are apart for the light that the light technique finds with
// the others, that it does not find (a constant sky, what other surfaces reflect), and that it finds alone: a technique
// is not better than another since it sees less.
struct Moments {
  PartMoments shared, unaimed, exclusive;
  // of all light: integrals of g^2 p_i and g p_i with g = f/sum_k p_k   (sigma^2_i,eq = square - mean^2, Def. 8)
  Fractions square{}, mean{};
  float hits = 0;

  float second(int i) const { return shared.second[i] + unaimed.second[i] + exclusive.second[i]; }

  Moments& operator+=(const Moments& b) {
    shared += b.shared, unaimed += b.unaimed, exclusive += b.exclusive;
    for (int i = 0; i < kTechniques; ++i) {
      square[i] += b.square[i];
      mean[i] += b.mean[i];
    }
    hits += b.hits;
    return *this;
  }

  // One sample: value f, densities p, expected counts n, of the techniques `used` for this integrand.
  void add(float f, const Fractions& p, const Fractions& n, TechniqueMask used) {
    // Of a technique whose density is no float where there is light; at the end of a lobe there is none, either.
    constexpr float kBeyond = 1e30f, kLeast = std::numeric_limits<float>::min();
    constexpr TechniqueMask light = maskOf(kLight);
    if (!(f > 0)) return;  // zeros count in the number of hits
    float q = 0, sum = 0;
    for (int k = 0; k < kTechniques; ++k)
      if ((used >> k & 1u) != 0) q += n[k] * p[k], sum += p[k];
    if (!(q > 0)) return;
    const bool alone = used == light, aimed = (used & light) == 0 || p[kLight] > 0;
    PartMoments& part = alone ? exclusive : aimed ? shared : unaimed;
    if (!aimed) used &= static_cast<TechniqueMask>(~light);
    const float overQ = f / q, g = f / sum;
    part.square += g * overQ, part.integral += overQ;
    for (int k = 0; k < kTechniques; ++k) {
      if ((used >> k & 1u) == 0) continue;
      part.second[k] += std::min(kBeyond, f / std::max(p[k], kLeast) * overQ);
      const float gp = g * p[k] / q;
      square[k] += g * gp;
      mean[k] += gp;
    }
  }
};

}  // namespace wardmis
