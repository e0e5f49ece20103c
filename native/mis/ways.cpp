// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/ways.h"

#include <utility>

namespace wardmis {

WayCandidates::WayCandidates() {
  counts_.push_back({1, 0, 0, 0});
  for (const double atHit : {1.0, 0.34})
    for (const double paths : {0.25, 1.0, 4.0})
      for (const auto& [first, later] : {std::pair{0, 0}, {1, 0}, {1, 1}, {3, 0}, {3, 1}, {2, 2}})
        counts_.push_back({atHit, paths, first, later});
  for (size_t c = 0; c < kCount; ++c) {
    const auto factor = factors(counts_[c < counts_.size() ? c : 0]);
    for (size_t j = 0; j < kJoins; ++j) factor_[j][c] = factor[j];
  }
}

std::array<double, kJoins> WayCandidates::factors(const WayCounts& n) {
  std::array<double, kJoins> f{};
  f[kByCamera] = n.atHit;
  if (n.paths > 0) f[kAtFirst] = n.connections, f[kAtLater] = n.laterConnections * n.atHit, f[kAtFilm] = n.paths;
  return f;
}

}  // namespace wardmis
