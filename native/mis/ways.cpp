// SPDX-License-Identifier: GPL-3.0-or-later
#include "mis/ways.h"

#include <cmath>
#include <utility>

#include "math/rel_mse.h"
#include "mis/adaptive.h"

namespace wardmis {

WayCandidates::WayCandidates() {
  counts_.push_back({1, 0, 0, 0});
  for (const double paths : {0.25, 1.0, 4.0})
    for (const double atHit : {1.0, 1.0 / 3, 1.0 / 6})
      for (const auto& [first, later] : {std::pair{0.0, 0.0}, {1, 0}, {1, 1}, {3, 1}, {2, 2}})
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

void WayMoments::add(float v, const Ways& ways) {
  constexpr double kFinds = 1e-12, kBeyond = 1e30;  // of all ways; a float's
  const double all = ways.sum(), f = double(v);
  if (!(f > 0) || !(all > 0)) return;
  size_t mask = 0;
  for (size_t j = 0; j < kJoins; ++j)
    if (ways.of[j] > kFinds * all) mask |= size_t{1} << j;
  Part& p = part[mask];
  p.square += static_cast<float>(f * f), p.integral += v;
  for (size_t j = 0; j < kJoins; ++j) {
    const double share = ways.of[j] / all;
    square[j] += static_cast<float>(f * f * share), mean[j] += static_cast<float>(f * share);
    if ((mask >> j & 1) != 0) p.second[j] += static_cast<float>(std::min(kBeyond, f * f / share));
  }
}

std::array<double, kJoins> wayShares(Allocation rule, const std::vector<WayMoments>& pixels,
                                     const std::vector<double>& means, uint32_t samples, uint32_t available,
                                     double least) {
  // The groups of a mask, as a strategy's techniques.
  const auto groupsOf = [](uint32_t mask) {
    std::vector<size_t> groups;
    for (size_t j = 0; j < kJoins; ++j)
      if ((mask >> j & 1) != 0) groups.push_back(j);
    return groups;
  };
  const double n = samples;
  std::array<double, kJoins> shares{};
  const auto addShares = [&](uint32_t mask, const IntegrandMoments& known, double demand) {
    const std::vector<size_t> groups = groupsOf(mask);
    const Densities a = fractions(rule, known);
    for (size_t k = 0; k < groups.size(); ++k) shares[groups[k]] += demand * a[k];
  };
  if (rule == Allocation::kSecondMoment || rule == Allocation::kInverseVariance) {
    constexpr double kLeast = 1e-3;  // of m^2: of a pilot, m^2 may come out below mu^2; then not infinitely good
    for (uint32_t mask = 1; mask < WayMoments::kParts; ++mask) {
      const std::vector<size_t> groups = groupsOf(mask & available);
      std::array<double, kJoins> second{}, prim{};
      double square = 0;
      for (size_t i = 0; i < pixels.size(); ++i) {
        const WayMoments::Part& p = pixels[i].part[mask];
        const double over = 1 / (means[i] * means[i] + kRelMseEpsilon), mu = double(p.integral) / n;
        square += over * double(p.square) / n;
        for (const size_t j : groups) {
          const double m2 = double(p.second[j]) / n;
          second[j] += over * m2, prim[j] += over * std::max(m2 - mu * mu, kLeast * m2);
        }
      }
      if (groups.empty() || !(square > 0)) continue;
      IntegrandMoments known;
      known.techniques = static_cast<int>(groups.size());
      for (size_t k = 0; k < groups.size(); ++k)
        known.logSecond[k] = std::log(second[groups[k]]), known.variancePrim[k] = prim[groups[k]];
      addShares(mask & available, known, std::sqrt(square));
    }
  } else {
    const std::vector<size_t> groups = groupsOf(available);
    IntegrandMoments known;
    known.techniques = static_cast<int>(groups.size());
    for (size_t k = 0; k < groups.size(); ++k)
      for (size_t i = 0; i < pixels.size(); ++i) {
        const double over = 1 / (means[i] * means[i] + kRelMseEpsilon), mean = double(pixels[i].mean[groups[k]]) / n,
                     square = double(pixels[i].square[groups[k]]) / n;
        known.mean[k] += std::sqrt(over) * mean, known.square[k] += over * square;
        known.variance[k] += over * std::max(0.0, square - mean * mean);
      }
    addShares(available, known, 1);
  }
  const std::vector<size_t> groups = groupsOf(available);
  double sum = 0;
  for (const double s : shares) sum += s;
  Densities a{};
  for (size_t k = 0; k < groups.size(); ++k)
    a[k] = sum > 0 && std::isfinite(sum) ? shares[groups[k]] / sum : 1 / double(groups.size());
  a = clampFractions(a, static_cast<int>(groups.size()), least);
  shares = {};
  for (size_t k = 0; k < groups.size(); ++k) shares[groups[k]] = a[k];
  return shares;
}

std::array<float, kJoins> varianceAware(const std::vector<const GroupSums*>& pixels, uint32_t samples) {
  constexpr double kMost = 16;
  const double n = samples;
  std::array<float, kJoins> v{};
  for (size_t j = 0; j < kJoins; ++j) {
    double second = 0, variance = 0;
    for (const GroupSums* p : pixels) {
      const double mean = double(p->sum[j]) / n, square = double(p->squares[j]) / n;
      second += square, variance += std::max(0.0, square - mean * mean) * n / std::max(n - 1, 1.0);
    }
    v[j] = static_cast<float>(second > 0 ? std::clamp(second / std::max(variance, second / kMost), 1.0, kMost) : 1);
  }
  return v;
}

}  // namespace wardmis
