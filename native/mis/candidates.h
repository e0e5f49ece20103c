// SPDX-License-Identifier: GPL-3.0-or-later
// `auto`, of a render and of the study: of a fixed set of fractions, the one whose predicted variance x cost over the
// pilot's samples is the least. The candidates' sums are made while the pilot runs, so that its samples need not be
// kept.
#pragma once

#include <numeric>

#include "mis/technique.h"

namespace wardmis {

// Fractions proportional to 1, 4 or 16 of which the least is 1, as far as there are not too many.
template <size_t K>
inline constexpr int kCandidates = [] {
  int all = 1, above = 1;
  for (size_t i = 0; i < K; ++i) all *= 3, above *= 2;
  return all - above < 33 ? all - above : 33;
}();

template <size_t K>
struct CandidateList {
  float a[K][kCandidates<K>];  // fractions, equal ones first
  // Variance of a technique's count over the hits, whole or not, over the samples of a hit.
  float spread[K][kCandidates<K>];

  Fractions<K> at(int c) const {
    Fractions<K> f;
    for (size_t i = 0; i < K; ++i) f[i] = a[i][c];
    return f;
  }
  // E[y_i] of the last technique, from `mean(i)`, those of the others: sum_i a_i E[y_i] = integral f.
  template <class Mean>
  float last(int c, float integral, Mean&& mean) const {
    if (!(a[K - 1][c] > 0)) return 0;
    for (size_t i = 0; i + 1 < K; ++i) integral -= a[i][c] * mean(i);
    return integral / a[K - 1][c];
  }
};
// The candidates of a render with so many samples at a hit. All but the equal counts are rounded to quarters of a
// sample, so that over 2^k hits a technique's points are a few powers of two: as Sobol's want to be.
template <size_t K>
class CandidateLists {
 public:
  explicit CandidateLists(int samplesPerHit);
  // Restricted to the techniques that a hit has.
  const CandidateList<K>& of(TechniqueMask available) const { return lists_[available & Techniques<K>::kAll]; }

 private:
  std::array<CandidateList<K>, Techniques<K>::kAll + 1> lists_{};
};

// What a hit costs, in any unit: a share of the hit itself for each of its samples, and a sample of each technique.
template <size_t K>
struct SampleCost {
  float hit = 0;
  Fractions<K> technique = [] {
    Fractions<K> one;
    one.fill(1);
    return one;
  }();

  // Of a sample, in mean over candidate c's fractions.
  float of(const CandidateList<K>& list, int c) const {
    float sum = hit;
    for (size_t i = 0; i < K; ++i) sum += list.a[i][c] * technique[i];
    return sum;
  }
};

// Sums over hits, per candidate. Of a technique's sample y_i, what it adds to all integrands with balance weights, only
// the scatter at one hit is what sharing can change: Var[y_i | hit] = E[y_i^2] - E[y_i | hit]^2. The square of the mean
// is the product of two estimates of it from samples of their own. Where counts are not whole numbers at each hit, the
// scatter of E[y_i | hit] over the hits counts, too: spread_i (E[E[y_i | hit]^2] - E[y_i]^2).
template <size_t K>
struct CandidateSums {
  static constexpr int kCount = kCandidates<K>;
  float within[kCount]{};       // sum_i a_i Var[y_i | hit] + spread_i E[y_i | hit]^2
  float gain2[kCount]{};        // squared difference of its product with the cost from that of equal counts
  float mean[K - 1][kCount]{};  // E[y_i]; the last follows
  float integral = 0, hits = 0;

  CandidateSums& operator+=(const CandidateSums& b) {
    for (int c = 0; c < kCount; ++c) {
      within[c] += b.within[c], gain2[c] += b.gain2[c];
      for (size_t i = 0; i < K - 1; ++i) mean[i][c] += b.mean[i][c];
    }
    integral += b.integral, hits += b.hits;
    return *this;
  }
};

// Of all hits of a surface, what a few of them are not likely to meet: the scatter of the gains, and that of samples of
// equal counts.
template <size_t K>
struct SurfaceScatter {
  double gain2[kCandidates<K>]{}, within = 0, integral = 0, hits = 0;

  SurfaceScatter& operator+=(const CandidateSums<K>& b) {
    for (int c = 0; c < kCandidates<K>; ++c) gain2[c] += double(b.gain2[c]);
    within += double(b.within[0]), integral += double(b.integral);
    hits += double(b.hits);
    return *this;
  }
};

// The samples of a technique at a hit of the pilot: two, each of a set that estimates by itself.
inline constexpr int kSets = 2;

// One hit: the samples of its integrands, then addTo() the sums.
template <size_t K>
class CandidateHit {
 public:
  explicit CandidateHit(const CandidateList<K>& list) : list_(list) {}

  // f, p, expected counts n (of both sets) and techniques `used` as for Moments::add.
  void add(float f, const Fractions<K>& p, const Fractions<K>& n, TechniqueMask used, int set) {
    if (!(f > 0)) return;
    Fractions<K> own{};
    float q = 0;
    for (size_t k = 0; k < K; ++k)
      if (has(used, k)) own[k] = p[k], q += n[k] * p[k];
    const float w = f / q, f2 = f * w;
    integral_[set] += w;
    for (int c = 0; c < kCount; ++c) {
      float mixture = list_.a[0][c] * own[0];
      for (size_t k = 1; k < K; ++k) mixture += list_.a[k][c] * own[k];
      const float r = 1 / mixture;
      value_[c] += f2 * r;
      for (size_t k = 0; k < K - 1; ++k) mean_[set][k][c] += own[k] * w * r;
    }
  }
  // A light sample that serves the integrands of techniques i and k: E[(f_i/q_i + f_k/q_k)^2] has their product twice,
  // with the light's a.
  void addBoth(size_t i, float fi, size_t k, float fk, const Fractions<K>& p, const Fractions<K>& n) {
    constexpr size_t kLight = Techniques<K>::kLight;
    if (!(fi > 0) || !(fk > 0)) return;
    const float w = 2 * fi * (fk / (n[i] * p[i] + n[k] * p[k] + n[kLight] * p[kLight]));
    for (int c = 0; c < kCount; ++c) {
      const float light =
          list_.a[kLight][c] * p[kLight];  // of a light's far edge it may be 1e-25: its square is no float
      value_[c] += light / (list_.a[i][c] * p[i] + light) * (w / (list_.a[k][c] * p[k] + light));
    }
  }
  void addTo(CandidateSums<K>& sums, const SampleCost<K>& cost) const {
    const float all = std::accumulate(value_, value_ + kCount, 0.0f);
    if (!(all < 1e18f)) return;  // its square, or it, is beyond float: it would be all that a surface says
    float equal = 0;
    for (int c = 0; c < kCount; ++c) {
      float last[kSets];
      for (int s = 0; s < kSets; ++s) last[s] = list_.last(c, integral_[s], [&](size_t i) { return mean_[s][i][c]; });
      float within = value_[c];
      for (size_t i = 0; i < K; ++i) {
        // each set has half of the sum
        const float square = 4 * (i + 1 < K ? mean_[0][i][c] * mean_[1][i][c] : last[0] * last[1]);
        within -= (list_.a[i][c] - list_.spread[i][c]) * square;
      }
      const float priced = within * cost.of(list_, c);
      if (c == 0) equal = priced;
      sums.within[c] += within;
      sums.gain2[c] += (equal - priced) * (equal - priced);
      for (size_t i = 0; i < K - 1; ++i) sums.mean[i][c] += mean_[0][i][c] + mean_[1][i][c];
    }
    sums.integral += integral_[0] + integral_[1], sums.hits += 1;
  }

 private:
  static constexpr int kCount = kCandidates<K>;
  const CandidateList<K>& list_;
  float value_[kCount]{}, mean_[kSets][K - 1][kCount]{}, integral_[kSets]{};
};

inline constexpr int kLeastHits = 8;  // fewer say nothing of their own noise

// The candidate whose gain in predicted variance x cost over equal counts, less two of the gain's standard errors, is
// the largest; equal counts where none is above nothing, or where hits are too few to tell. The errors are those of
// `sums` and of 16 more hits with the scatter of the whole `surface`, on which `sums` lies: rare bright samples that a
// neighbourhood did not meet show elsewhere on it.
template <size_t K>
Fractions<K> chooseCandidate(const CandidateSums<K>& sums, const SurfaceScatter<K>& surface,
                             const CandidateList<K>& list, const SampleCost<K>& cost);

// Whether so few samples at a hit are as good as more: of equal counts they leave a scatter of less than half a percent
// of what a hit sends. All other noise is of which hits are met, as at the edges of what a mirror shows. Of the whole
// surface, which meets what is rare, less than 10 %.
template <size_t K>
bool suffice(int samples, const CandidateSums<K>& sums, const SurfaceScatter<K>& surface);

}  // namespace wardmis
