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
// Restricted to the techniques that a hit has.
const CandidateList& candidatesOf(TechniqueMask available);

// Sums over hits; per candidate the estimate of integral f^2/q, and the squared difference of its product with the cost
// from that of equal counts.
struct CandidateSums {
  float value[kCandidates]{}, gain2[kCandidates]{};

  CandidateSums& operator+=(const CandidateSums& b) {
    for (int c = 0; c < kCandidates; ++c) value[c] += b.value[c], gain2[c] += b.gain2[c];
    return *this;
  }
};

// One hit: the samples of its integrands, then add() to the sums.
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
    const float f2 = f * (f / q);
    for (int c = 0; c < kCandidates; ++c)
      value_[c] += f2 / (list_.a[0][c] * own[0] + list_.a[1][c] * own[1] + list_.a[2][c] * own[2]);
  }
  void addTo(CandidateSums& sums, const Fractions& cost) const {
    const auto costOf = [&](int c) {
      return list_.a[0][c] * cost[0] + list_.a[1][c] * cost[1] + list_.a[2][c] * cost[2];
    };
    for (int c = 0; c < kCandidates; ++c) {
      const float gain = value_[0] * costOf(0) - value_[c] * costOf(c);
      sums.value[c] += value_[c];
      sums.gain2[c] += gain * gain;
    }
  }

 private:
  const CandidateList& list_;
  float value_[kCandidates]{};
};

// squares: sum over the hits' integrands of (integral f)^2, which is no variance. Equal counts where no candidate's
// gain is above twice its standard error.
Fractions chooseCandidate(const CandidateSums& sums, float squares, TechniqueMask available, const Fractions& cost);

}  // namespace wardmis
