// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/cost.h"

#include <tbb/enumerable_thread_specific.h>

#include <Eigen/Dense>

namespace wardmis {
namespace {

constexpr double kLongest = 0.5;  // seconds
constexpr float kHeavy = 0.8f;    // share of the technique whose turn it is

// The least squares solution of a x = b among those without a negative part: the best of all subsets of the unknowns,
// which are few.
Eigen::VectorXd nonnegative(const Eigen::MatrixXd& a, const Eigen::VectorXd& b) {
  Eigen::VectorXd best = Eigen::VectorXd::Zero(a.cols());
  double least = b.squaredNorm();
  for (unsigned subset = 1; subset < (1u << a.cols()); ++subset) {
    std::vector<Eigen::Index> chosen;
    for (Eigen::Index k = 0; k < a.cols(); ++k)
      if ((subset >> k & 1u) != 0) chosen.push_back(k);
    const Eigen::VectorXd x = a(Eigen::all, chosen).colPivHouseholderQr().solve(b);
    if (!(x.minCoeff() >= 0)) continue;
    const double residual = (a(Eigen::all, chosen) * x - b).squaredNorm();
    if (!(residual < least)) continue;
    least = residual;
    best.setZero();
    best(chosen) = x;
  }
  return best;
}

template <size_t K>
TechniqueCost measureWith(const BuiltScene& built, const RenderSettings& settings) {
  TechniqueCost cost;
  RenderSettings s = settings;
  s.allocation = Allocation::kEqual;
  RenderSetup<K> setup(built, s);
  struct Turn {
    Fractions<K> fractions;
    int samples;  // per hit
  };
  // twice the samples in one: else nothing could tell what a hit costs from what all its samples cost
  const int once = std::min(s.samplesPerHit, kMaxSamplesPerHit / 2);
  std::vector<Turn> turns{{setup.input.fractions, once}, {setup.input.fractions, 2 * once}};
  for (size_t t = 0; t < K; ++t) {
    if (!has(setup.techniques, t) || setup.techniques == maskOf(t)) continue;
    Fractions<K> f;
    f.fill((1 - kHeavy) / (K - 1));
    f[t] = kHeavy;
    turns.push_back({restrict<K>(f, setup.techniques), once});
  }

  // A row for each turn; CPU seconds = cameraSample * paths + sum sample[i] * n_i.
  using Row = std::array<double, 2 + K>;
  std::vector<Row> rows(turns.size());
  const auto pass = [&](uint32_t round, const Turn& turn) {
    setup.input.fractions = turn.fractions;
    setup.input.samplesPerHit = turn.samples;
    FilmBuffer film = setup.film();
    film.first = round;
    tbb::enumerable_thread_specific<Counts> counts;
    std::atomic<int> done{0};
    const double before = cpuSeconds();
    renderTiles<K>(setup, film, 1, nullptr, [&]() -> Counts& { return counts.local(); }, done, {});
    const double seconds = cpuSeconds() - before;
    Counts sum;
    for (const Counts& c : counts) sum += c;
    Row row{seconds, double(sum.cameraRays)};
    std::copy_n(sum.samples.begin(), K, row.begin() + 2);
    return row;
  };
  pass(0, turns[0]);  // meets cold caches, and threads that must begin
  const double start = wallSeconds();
  const double allowed = settings.seconds > 0 ? std::min(kLongest, settings.seconds / 50) : kLongest;
  const uint32_t rounds = settings.seconds > 0 ? 64 : std::clamp(settings.spp / 50, 1u, 64u);
  const uint32_t least = std::min(rounds, 3u);
  for (uint32_t round = 0; round < rounds && (round < least || wallSeconds() - start < allowed); ++round)
    for (size_t k = 0; k < turns.size(); ++k) {
      const size_t turn = round % 2 == 0 ? k : turns.size() - 1 - k;  // ABCCBA
      const auto row = pass(round, turns[turn]);
      // of several rounds the quickest: what comes on top is what else the machine does
      if (round == 0 || row[0] / row[1] < rows[turn][0] / rows[turn][1]) rows[turn] = row;
    }

  std::vector<size_t> unknowns{0};  // column of each
  for (size_t t = 0; t < K; ++t)
    if (has(setup.techniques, t)) unknowns.push_back(1 + t);
  Eigen::MatrixXd a(Eigen::Index(rows.size()), Eigen::Index(unknowns.size()));
  Eigen::VectorXd b(Eigen::Index(rows.size()));
  for (size_t r = 0; r < rows.size(); ++r) {
    b[Eigen::Index(r)] = rows[r][0];
    for (size_t u = 0; u < unknowns.size(); ++u) a(Eigen::Index(r), Eigen::Index(u)) = rows[r][1 + unknowns[u]];
  }
  const Eigen::VectorXd x = nonnegative(a, b);
  double sum = 0;
  int found = 0;
  for (size_t u = 0; u < unknowns.size(); ++u) {
    const double value = std::max(0.0, x[Eigen::Index(u)]);
    if (unknowns[u] == 0)
      cost.cameraSample = value;
    else
      cost.sample[unknowns[u] - 1] = value;
    if (unknowns[u] == 0 || !(value > 0)) continue;
    sum += value, ++found;
  }
  if (found == 0) return cost;
  const double mean = sum / found;
  cost.relativeHit = static_cast<float>(cost.cameraSample / (settings.samplesPerHit * mean));
  for (size_t t = 0; t < K; ++t)  // a cost of nothing is the clock's noise
    if (has(setup.techniques, t)) cost.relative[t] = static_cast<float>(std::max(cost.sample[t], 0.1 * mean) / mean);
  return cost;
}

}  // namespace

TechniqueCost measureCost(const BuiltScene& built, const RenderSettings& settings) {
  return withTechniques(built.lobes(), [&](auto k) { return measureWith<k()>(built, settings); });
}

}  // namespace wardmis
