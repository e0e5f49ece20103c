// SPDX-License-Identifier: GPL-3.0-or-later
// `auto`, of a render and of the study: of a fixed set of fractions, the one whose predicted variance x cost over the
// pilot's samples is the least. The candidates' sums are made while the pilot runs, so that its samples need not be
// kept.
#pragma once

#include <numeric>

#include "mis/moments.h"

namespace wardmis {

inline constexpr int kCandidates = 19;  // of three techniques: proportional to 1, 4 or 16, the first ones equal

struct CandidateList {
  float a[kTechniques][kCandidates];  // fractions
  // Variance of a technique's count over the hits, whole or not, over the samples of a hit.
  float spread[kTechniques][kCandidates];
  Fractions at(int c) const { return {a[0][c], a[1][c], a[2][c]}; }
  // E[y_i] of the last technique, from those of the others: sum_i a_i E[y_i] = integral f.
  float last(int c, float integral, float first, float second) const {
    return a[2][c] > 0 ? (integral - a[0][c] * first - a[1][c] * second) / a[2][c] : 0;
  }
};
// The candidates of a render with so many samples at a hit. All but the equal counts are rounded to quarters of a
// sample, so that over 2^k hits a technique's points are a few powers of two: as Sobol's want to be.
class CandidateLists {
 public:
  explicit CandidateLists(int samplesPerHit);
  // Restricted to the techniques that a hit has.
  const CandidateList& of(TechniqueMask available) const { return lists_[available & kAllTechniques]; }

 private:
  std::array<CandidateList, kAllTechniques + 1> lists_{};
};

// What a hit costs, in any unit: a share of the hit itself for each of its samples, and a sample of each technique.
struct SampleCost {
  float hit = 0;
  Fractions technique{1, 1, 1};

  // Of a sample, in mean over fractions a.
  float of(float a0, float a1, float a2) const {
    return hit + a0 * technique[0] + a1 * technique[1] + a2 * technique[2];
  }
};

// Sums over hits, per candidate. Of a technique's sample y_i, what it adds to all integrands with balance weights, only
// the scatter at one hit is what sharing can change: Var[y_i | hit] = E[y_i^2] - E[y_i | hit]^2. The square of the mean
// is the product of two estimates of it from samples of their own. Where counts are not whole numbers at each hit, the
// scatter of E[y_i | hit] over the hits counts, too: spread_i (E[E[y_i | hit]^2] - E[y_i]^2).
struct CandidateSums {
  float within[kCandidates]{};  // sum_i a_i Var[y_i | hit] + spread_i E[y_i | hit]^2
  float gain2[kCandidates]{};   // squared difference of its product with the cost from that of equal counts
  float mean[kTechniques - 1][kCandidates]{};  // E[y_i]; the last follows
  float integral = 0, hits = 0;

  CandidateSums& operator+=(const CandidateSums& b) {
    for (int c = 0; c < kCandidates; ++c) {
      within[c] += b.within[c], gain2[c] += b.gain2[c];
      for (int i = 0; i < kTechniques - 1; ++i) mean[i][c] += b.mean[i][c];
    }
    integral += b.integral, hits += b.hits;
    return *this;
  }
};

// The scatter of the gains over all hits of a surface: what a few of them are not likely to meet.
struct GainScatter {
  double gain2[kCandidates]{}, hits = 0;

  GainScatter& operator+=(const CandidateSums& b) {
    for (int c = 0; c < kCandidates; ++c) gain2[c] += double(b.gain2[c]);
    hits += double(b.hits);
    return *this;
  }
};

// The samples of a technique at a hit of the pilot: two, each of a set that estimates by itself.
inline constexpr int kSets = 2;

// One hit: the samples of its integrands, then addTo() the sums.
class CandidateHit {
 public:
  explicit CandidateHit(const CandidateList& list) : list_(list) {}

  // f, p, expected counts n (of both sets) and techniques `used` as for Moments::add.
  void add(float f, const Fractions& p, const Fractions& n, TechniqueMask used, int set) {
    if (!(f > 0)) return;
    Fractions own{};
    float q = 0;
    for (int k = 0; k < kTechniques; ++k)
      if ((used >> k & 1u) != 0) own[k] = p[k], q += n[k] * p[k];
    const float w = f / q, f2 = f * w, w0 = own[0] * w, w1 = own[1] * w;
    integral_[set] += w;
    for (int c = 0; c < kCandidates; ++c) {
      const float r = 1 / (list_.a[0][c] * own[0] + list_.a[1][c] * own[1] + list_.a[2][c] * own[2]);
      value_[c] += f2 * r;
      mean_[set][0][c] += w0 * r, mean_[set][1][c] += w1 * r;
    }
  }
  // A light sample that serves two integrands: E[(f_s/q_s + f_d/q_d)^2] has their product twice, with the light's a.
  void addBoth(float fs, float fd, const Fractions& p, const Fractions& n) {
    if (!(fs > 0) || !(fd > 0)) return;
    const float w = 2 * fs * (fd / (n[0] * p[0] + n[1] * p[1] + n[2] * p[2]));
    for (int c = 0; c < kCandidates; ++c) {
      const float light = list_.a[2][c] * p[2];  // of a far edge of a light it may be 1e-25: its square is no float
      value_[c] += light / (list_.a[0][c] * p[0] + light) * (w / (list_.a[1][c] * p[1] + light));
    }
  }
  void addTo(CandidateSums& sums, const SampleCost& cost) const {
    const float all = std::accumulate(value_, value_ + kCandidates, 0.0f);
    if (!(all < 1e18f)) return;  // its square, or it, is beyond float: it would be all that a surface says
    float equal = 0;
    for (int c = 0; c < kCandidates; ++c) {
      const float a[] = {list_.a[0][c], list_.a[1][c], list_.a[2][c]};
      float last[kSets];
      for (int s = 0; s < kSets; ++s) last[s] = list_.last(c, integral_[s], mean_[s][0][c], mean_[s][1][c]);
      // each set has half of the sum
      const float square[] = {4 * mean_[0][0][c] * mean_[1][0][c], 4 * mean_[0][1][c] * mean_[1][1][c],
                              4 * last[0] * last[1]};
      float within = value_[c];
      for (int i = 0; i < kTechniques; ++i) within -= (a[i] - list_.spread[i][c]) * square[i];
      const float priced = within * cost.of(a[0], a[1], a[2]);
      if (c == 0) equal = priced;
      sums.within[c] += within;
      sums.gain2[c] += (equal - priced) * (equal - priced);
      sums.mean[0][c] += mean_[0][0][c] + mean_[1][0][c], sums.mean[1][c] += mean_[0][1][c] + mean_[1][1][c];
    }
    sums.integral += integral_[0] + integral_[1], sums.hits += 1;
  }

 private:
  const CandidateList& list_;
  float value_[kCandidates]{}, mean_[kSets][kTechniques - 1][kCandidates]{}, integral_[kSets]{};
};

inline constexpr int kLeastHits = 8;  // fewer say nothing of their own noise

// The candidate whose gain in predicted variance x cost over equal counts, less two of the gain's standard errors, is
// the largest; equal counts where none is above nothing, or where hits are too few to tell. The errors are those of
// `sums` and of 16 more hits with the scatter of the whole `surface`, on which `sums` lies: rare bright samples that a
// neighbourhood did not meet show elsewhere on it.
Fractions chooseCandidate(const CandidateSums& sums, const GainScatter& surface, const CandidateList& list,
                          const SampleCost& cost);

}  // namespace wardmis
