// SPDX-License-Identifier: GPL-3.0-or-later
// Counters of what should be rare: samples that are not a number, infinite or negative. A sample that is counted is
// dropped; the counts are printed when they are not zero, so that nothing is hidden.
#pragma once

#include <cmath>
#include <cstdint>

#include "math/vec.h"

namespace wardmis {

struct RareCounts {
  uint64_t nan = 0, infinite = 0, negative = 0;

  uint64_t total() const { return nan + infinite + negative; }
  RareCounts& operator+=(const RareCounts& b) {
    nan += b.nan;
    infinite += b.infinite;
    negative += b.negative;
    return *this;
  }
  // True if the sample may enter the image. least: 0, and less than any number where a light is negative.
  bool admit(Rgb v, float least = 0) {
    const float lo = std::min(v.x, std::min(v.y, v.z)), sum = v.x + v.y + v.z;
    if (lo >= least && sum <= 3.4e38f && !(sum != sum)) return true;
    if (sum != sum)
      ++nan;
    else if (!(sum <= 3.4e38f) || !(sum >= -3.4e38f))
      ++infinite;
    else
      ++negative;
    return false;
  }
};

}  // namespace wardmis
