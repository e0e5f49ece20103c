// SPDX-License-Identifier: GPL-3.0-or-later
// `auto` in a render: of a fixed set of fractions, the one whose predicted variance x cost over the pilot's samples is
// the least. The candidates' sums are made while the pilot runs, so that its samples need not be kept.
#pragma once

#include "mis/moments.h"

namespace wardmis {

inline constexpr int kCandidates = 19;  // of three techniques: proportional to 1, 4 or 16, the first ones equal

struct CandidateList {
  float a[kTechniques][kCandidates];  // fractions
  Fractions at(int c) const { return {a[0][c], a[1][c], a[2][c]}; }
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

// Sums over hits; per candidate the estimate of sum_i a_i E_{p_i}[y_i^2], y_i being what a sample of technique i adds
// to all integrands with balance weights, and the squared difference of its product with the cost from that of equal
// counts. mean: of each technique but the last, the estimate of E_{p_i}[y_i]; that of the last follows from
// sum_i a_i E_{p_i}[y_i] = integral f, which is `integral`.
struct CandidateSums {
  float value[kCandidates]{}, gain2[kCandidates]{};
  float mean[kTechniques - 1][kCandidates]{};
  float integral = 0, hits = 0;

  CandidateSums& operator+=(const CandidateSums& b) {
    for (int c = 0; c < kCandidates; ++c) {
      value[c] += b.value[c], gain2[c] += b.gain2[c];
      for (int i = 0; i < kTechniques - 1; ++i) mean[i][c] += b.mean[i][c];
    }
    integral += b.integral, hits += b.hits;
    return *this;
  }
};

// One hit: the samples of its integrands, then addTo() the sums.
class CandidateHit {
 public:
  explicit CandidateHit(const CandidateList& list) : list_(list) {}

  // f, p, expected counts n and techniques `used` as for Moments::add.
  void add(float f, const Fractions& p, const Fractions& n, TechniqueMask used) {
    if (!(f > 0)) return;
    Fractions own{};
    float q = 0;
    for (int k = 0; k < kTechniques; ++k)
      if ((used >> k & 1u) != 0) own[k] = p[k], q += n[k] * p[k];
    const float w = f / q, f2 = f * w, w0 = own[0] * w, w1 = own[1] * w;
    integral_ += w;
    for (int c = 0; c < kCandidates; ++c) {
      const float r = 1 / (list_.a[0][c] * own[0] + list_.a[1][c] * own[1] + list_.a[2][c] * own[2]);
      value_[c] += f2 * r;
      mean_[0][c] += w0 * r, mean_[1][c] += w1 * r;
    }
  }
  // A light sample that serves two integrands: E[(f_s/q_s + f_d/q_d)^2] has their product twice, with the light's a.
  void addBoth(float fs, float fd, const Fractions& p, const Fractions& n) {
    if (!(fs > 0) || !(fd > 0)) return;
    const float w = 2 * fs * (fd / (n[0] * p[0] + n[1] * p[1] + n[2] * p[2])) * p[2];
    for (int c = 0; c < kCandidates; ++c) {
      const float light = list_.a[2][c] * p[2];
      value_[c] += list_.a[2][c] * w / ((list_.a[0][c] * p[0] + light) * (list_.a[1][c] * p[1] + light));
    }
  }
  void addTo(CandidateSums& sums, const SampleCost& cost) const {
    const auto costOf = [&](int c) { return cost.of(list_.a[0][c], list_.a[1][c], list_.a[2][c]); };
    for (int c = 0; c < kCandidates; ++c) {
      const float gain = value_[0] * costOf(0) - value_[c] * costOf(c);
      sums.value[c] += value_[c];
      sums.gain2[c] += gain * gain;
      sums.mean[0][c] += mean_[0][c], sums.mean[1][c] += mean_[1][c];
    }
    sums.integral += integral_, sums.hits += 1;
  }

 private:
  const CandidateList& list_;
  float value_[kCandidates]{}, mean_[kTechniques - 1][kCandidates]{}, integral_ = 0;
};

// The candidate whose gain in predicted variance x cost over equal counts, less the gain's standard error, is the
// largest; equal counts where none is above nothing, or where hits are too few to tell.
Fractions chooseCandidate(const CandidateSums& sums, const CandidateList& list, const SampleCost& cost);

}  // namespace wardmis
