// SPDX-License-Identifier: GPL-3.0-or-later
// Sums over all ways to make a path against the table of their densities, and numbers of samples against what is known
// of the second moment.
#include "mis/ways.h"

#include <gtest/gtest.h>

#include <numeric>

#include "statistics.h"

namespace wardmis {
namespace {

// Densities of a path of five surfaces: of the camera's going on from each (q), the light's going back (g), geometry of
// each edge from either side, and whether each can be connected.
struct Chain {
  static constexpr int kVertices = 5;
  std::array<double, kVertices> q{}, g{}, toLight{}, toCamera{};
  std::array<bool, kVertices> rough{};
  double pixel = 0, film = 0, first = 0, later = 0, emitted = 0, found = 0;

  explicit Chain(test::Random& random) {
    const auto some = [&] { return std::exp(4 * random.uniform() - 2); };
    for (int i = 0; i < kVertices; ++i) {
      q[i] = some(), g[i] = some(), toLight[i] = some(), toCamera[i] = some();
      rough[i] = random.uniform() < 0.7;
    }
    pixel = some(), film = some(), first = some(), later = some(), emitted = some(), found = some();
  }
  // Of the camera's vertices up to number n, and of the light's down to it.
  double camera(int n) const {
    double c = pixel;
    for (int i = 0; i < n; ++i) c *= q[i] * toLight[i + 1];
    return c;
  }
  double light(int n) const {
    double f = emitted;
    for (int i = kVertices - 1; i > n; --i) f *= rough[i] ? g[i] * toCamera[i - 1] : 0;
    return f;
  }
  // toLight[i]: |cos|/d^2 at i of the edge from i - 1; toCamera[i]: at i of the edge from i + 1.
  Ways table() const {
    constexpr int kLast = kVertices - 1;
    Ways w = Ways::one(kByCamera, camera(kLast) * found);
    for (int i = 0; i < kLast; ++i)
      if (rough[i] && rough[i + 1])
        w += Ways::one(i == 0 ? kAtFirst : kAtLater, camera(i) * (i == 0 ? first : later) * light(i + 1));
    if (rough[0]) w += Ways::one(kAtFilm, film * light(0));
    return w;
  }
};

void expectSame(const Ways& a, const Ways& b) {
  for (size_t j = 0; j < kJoins; ++j) EXPECT_NEAR(a.of[j], b.of[j], 1e-12 * b.of[j]) << j;
}

TEST(PathEnd, CarriesAllOtherWays) {
  test::Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const Chain c(random);
    // the camera's end at the last vertex
    PathEnd end{kAtFilm, c.film, {}, c.pixel};
    for (int i = 0; i + 1 < Chain::kVertices; ++i)
      end = {i == 0 ? kAtFirst : kAtLater, c.rough[i] ? (i == 0 ? c.first : c.later) : 0,
             end.others(c.rough[i] ? c.g[i] : 0, c.rough[i]) * c.toCamera[i], c.q[i] * c.toLight[i + 1]};
    constexpr int kLast = Chain::kVertices - 1;
    Ways all = end.others(c.rough[kLast] ? c.g[kLast] : 0, c.rough[kLast]) * (c.camera(kLast) * c.emitted);
    all += Ways::one(kByCamera, c.camera(kLast) * c.found);
    expectSame(all, c.table());

    // the light's at the first, where all can be connected
    Chain open = c;
    open.rough.fill(true);
    PathEnd light{kByCamera, open.found, {}, open.emitted};
    for (int i = kLast; i > 0; --i)
      light = {i == 1 ? kAtFirst : kAtLater, i == 1 ? open.first : open.later,
               light.others(i == kLast ? 0 : open.q[i]) * open.toLight[i], open.g[i] * open.toCamera[i - 1]};
    Ways others = light.others(open.q[0]) * (open.pixel * open.light(0));
    others += Ways::one(kAtFilm, open.film * open.light(0));
    expectSame(others, open.table());
  }
}

// Two groups of ways over [0, 1): the second moment of other numbers, from samples of the pilot's.
TEST(WayCandidates, PredictTheSecondMoment) {
  const auto f = [](double x) { return x < 0.1 ? 9.0 : 0.3; };
  const auto densities = [](double x) {
    Ways w = Ways::one(kByCamera, 1);
    w += Ways::one(kAtFilm, x < 0.1 ? 8 : 0.2);
    return w;
  };
  const WayCandidates candidates;
  WaySums sums{};
  test::Random random(5);
  constexpr int kSamples = 1 << 17;
  for (int k = 0; k < kSamples; ++k) {
    const double camera = random.uniform(), a = random.uniform(), b = random.uniform();
    const double film = a < 0.8 ? 0.1 * b : 0.1 + 0.9 * b;
    for (const double x : {camera, film}) {
      const Ways w = densities(x);
      candidates.add(sums, static_cast<float>(f(x) / (w.of[kByCamera] + w.of[kAtFilm])), w);
    }
  }
  for (size_t c = 0; c < candidates.size(); ++c) {
    const auto factor = WayCandidates::factors(candidates.at(c));
    double exact = 0;
    for (const auto& [x, width] : {std::pair{0.05, 0.1}, {0.5, 0.9}}) {
      const Ways w = densities(x);
      exact += width * f(x) * f(x) / (factor[kByCamera] * w.of[kByCamera] + factor[kAtFilm] * w.of[kAtFilm]);
    }
    // the film's second group has 0.2 / 0.9 of its density there
    EXPECT_NEAR(double(sums[c]) / kSamples, exact, 0.03 * exact) << c;
  }
}

// Light that two groups find and some that one finds alone, in pixels of other brightness: shares by the paper's rules,
// from moments that are known.
TEST(WayMoments, ShareByTheRules) {
  test::Random random(9);
  constexpr uint32_t kSamples = 1 << 16;
  std::vector<WayMoments> pixels(2);
  const std::vector<double> means{1, 100};  // of one of which nothing but the scale is other
  // f is 1 over [0, 1); the camera's density is 1, the film's 2 x, over one of each
  for (uint32_t k = 0; k < kSamples; ++k)
    for (const bool film : {false, true}) {
      const double u = random.uniform(), x = film ? std::sqrt(u) : u;
      Ways w = Ways::one(kByCamera, 1);
      w += Ways::one(kAtFilm, 2 * x);
      const auto v = static_cast<float>(1 / w.sum());
      pixels[0].add(v, w), pixels[1].add(100 * v, w);
    }
  constexpr uint32_t kGroups = 1u << kByCamera | 1u << kAtFilm;
  const auto integral = [](auto&& f) {
    constexpr int kSteps = 1 << 16;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) sum += f((i + 0.5) / kSteps) / kSteps;
    return sum;
  };
  const auto g = [](double x) { return 1 / (1 + 2 * x); };
  const double camera = integral([&](double x) { return g(x) * g(x); }) -
                        std::pow(integral([&](double x) { return g(x); }), 2),
               film = integral([&](double x) { return g(x) * g(x) * 2 * x; }) -
                      std::pow(integral([&](double x) { return g(x) * 2 * x; }), 2);
  const auto byVariance = wayShares(Allocation::kVariance, pixels, means, kSamples, kGroups, 0);
  EXPECT_NEAR(byVariance[kByCamera], camera / (camera + film), 0.01);
  EXPECT_NEAR(byVariance[kByCamera] + byVariance[kAtFilm], 1, 1e-6);
  // m^2 of the camera is 1, and of the film infinite
  const auto bySecond = wayShares(Allocation::kSecondMoment, pixels, means, kSamples, kGroups, 0);
  EXPECT_GT(bySecond[kByCamera], 0.75);
  // what the film alone finds wants as much of it as its root says
  for (WayMoments& m : pixels) m = {};
  for (uint32_t k = 0; k < kSamples; ++k) {
    pixels[0].add(3, Ways::one(kByCamera, 1)), pixels[0].add(1, Ways::one(kAtFilm, 1));
    pixels[1].add(300, Ways::one(kByCamera, 1)), pixels[1].add(100, Ways::one(kAtFilm, 1));
  }
  const auto apart = wayShares(Allocation::kSecondMoment, pixels, means, kSamples, kGroups, 0);
  EXPECT_NEAR(apart[kByCamera], 0.75, 1e-4);
  const auto least = wayShares(Allocation::kSecondMoment, pixels, means, kSamples, kGroups, 0.3);
  EXPECT_NEAR(least[kAtFilm], 0.3, 1e-4);
}

// Of a technique's equal samples nothing scatters; of one alone all may.
TEST(WayScatter, CountsWhatScatters) {
  WayScatter even;
  for (int k = 0; k < 4; ++k) even.sum += 2, even.squares += 4;
  even.sums.fill(16);
  WaySums to{};
  even.addTo(to, 4);
  EXPECT_NEAR(to[0], 0, 1e-5f);
  WayScatter rare;
  rare.sum = 2, rare.squares = 4;
  rare.sums.fill(4);
  rare.addTo(to, 4);
  EXPECT_FLOAT_EQ(to[0], 4);  // 4 x (1 - 1/4) x 4/3
}

}  // namespace
}  // namespace wardmis
