// SPDX-License-Identifier: GPL-3.0-or-later
// The moments of an integrand under each technique, pooled over the samples of all of them.
#pragma once

#include <algorithm>
#include <bit>
#include <limits>

#include "mis/technique.h"

namespace wardmis {

// A part of an integrand that the same techniques find. Sums over hits of estimates, per technique i, of
//   second = m_i^2 = integral f^2/p_i  (of F_i,prim = f/p_i, Def. 9)
//   square = integral f^2/sum_k p_k, integral = integral f
template <size_t K>
struct PartMoments {
  Fractions<K> second{};
  float square = 0, integral = 0;

  PartMoments& operator+=(const PartMoments& b) {
    for (size_t i = 0; i < K; ++i) second[i] += b.second[i];
    square += b.square, integral += b.integral;
    return *this;
  }
};

// Sums over hits of estimates of an integrand's moments, each from the samples of *all* techniques: of the integral of
// h sum_kj h(X_kj)/sum_l n_l p_l(X_kj). The second moments are apart for the light that the light technique finds with
// the others, that it does not find (a constant sky, what other surfaces reflect), and that one technique finds
// alone (light without area, what a mirror reflects): a technique is not better than another since it sees less.
template <size_t K>
struct Moments {
  PartMoments<K> shared, unaimed, exclusive;
  // of all light: integrals of g^2 p_i and g p_i with g = f/sum_k p_k   (sigma^2_i,eq = square - mean^2, Def. 8)
  Fractions<K> square{}, mean{};
  float hits = 0;

  float second(size_t i) const { return shared.second[i] + unaimed.second[i] + exclusive.second[i]; }

  Moments& operator+=(const Moments& b) {
    shared += b.shared, unaimed += b.unaimed, exclusive += b.exclusive;
    for (size_t i = 0; i < K; ++i) {
      square[i] += b.square[i];
      mean[i] += b.mean[i];
    }
    hits += b.hits;
    return *this;
  }

  // One sample: value f, densities p, expected counts n, of the techniques `used` for this integrand.
  void add(float f, const Fractions<K>& p, const Fractions<K>& n, TechniqueMask used) {
    // Of a technique whose density is no float where there is light; at the end of a lobe there is none, either.
    constexpr float kBeyond = 1e30f, kLeast = std::numeric_limits<float>::min();
    constexpr size_t kLight = Techniques<K>::kLight;
    constexpr TechniqueMask light = maskOf(kLight);
    if (!(f > 0)) return;  // zeros count in the number of hits
    float q = 0, sum = 0;
    for (size_t k = 0; k < K; ++k)
      if (has(used, k)) q += n[k] * p[k], sum += p[k];
    if (!(q > 0)) return;
    const bool alone = std::has_single_bit(used), aimed = (used & light) != 0 && p[kLight] > 0;
    PartMoments<K>& part = alone ? exclusive : aimed ? shared : unaimed;
    if (!aimed) used &= static_cast<TechniqueMask>(~light);
    const float overQ = f / q, g = f / sum;
    part.square += g * overQ, part.integral += overQ;
    for (size_t k = 0; k < K; ++k) {
      if (!has(used, k)) continue;
      part.second[k] += std::min(kBeyond, f / std::max(p[k], kLeast) * overQ);
      const float gp = g * p[k] / q;
      square[k] += g * gp;
      mean[k] += gp;
    }
  }
};

}  // namespace wardmis
