// SPDX-License-Identifier: GPL-3.0-or-later
// Mixture: the weight rules against their formulas.
#include <gtest/gtest.h>

#include "mis/allocation.h"
#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

constexpr Weights kRules[] = {Weights::kBalance, Weights::kNonbalance, Weights::kPower, Weights::kCutoff,
                              Weights::kMaximum};

bool in(TechniqueMask mask, int i) { return (mask >> i & 1) != 0; }

// w_i as the literature writes it, over the techniques that take samples.
long double weight(Weights rule, int i, const Fractions<3>& n, const Fractions<3>& p, TechniqueMask used) {
  const auto term = [&](int k) -> long double {
    if (!in(used, k) || !(n[static_cast<size_t>(k)] > 0)) return 0;
    const long double pk = p[static_cast<size_t>(k)], np = pk * static_cast<long double>(n[static_cast<size_t>(k)]);
    return rule == Weights::kNonbalance ? pk : rule == Weights::kPower ? np * np : np;
  };
  const long double top = std::max({term(0), term(1), term(2)});
  if (rule == Weights::kMaximum) return term(i) == top ? 1 : 0;
  if (rule == Weights::kCutoff) {
    const auto kept = [&](int k) { return term(k) >= 0.1L * top ? term(k) : 0; };
    return kept(i) / (kept(0) + kept(1) + kept(2));
  }
  return term(i) / (term(0) + term(1) + term(2));
}

struct Problem {
  Fractions<3> fractions, p;
  TechniqueMask used;
  int samples;
};

// Any techniques, some without samples; densities of any size, some zero.
Problem randomProblem(Random& random, double lo, double hi) {
  Problem r{};
  r.used = static_cast<TechniqueMask>(random.integer(1, 7));
  r.samples = random.integer(1, 300);
  float sum = 0;
  for (size_t i = 0; i < 3; ++i) {
    r.fractions[i] = random.uniform() < 0.2 ? 0 : static_cast<float>(random.logUniform(1e-3, 1));
    r.p[i] = random.uniform() < 0.1 ? 0 : static_cast<float>(random.logUniform(lo, hi));
    sum += r.fractions[i];
  }
  for (float& a : r.fractions) a = sum > 0 ? a / sum : 1.0f / 3;
  return r;
}

void check(double lo, double hi) {
  Random random(1);
  for (int k = 0; k < 20000; ++k) {
    const Problem r = randomProblem(random, lo, hi);
    for (Weights rule : kRules) {
      const Mixture<3> mixture(r.fractions, r.samples, rule);
      long double sum = 0;
      bool any = false;
      for (int i = 0; i < 3; ++i) {
        const auto s = static_cast<size_t>(i);
        if (!in(r.used, i) || !(r.p[s] > 0) || !(mixture.n[s] > 0)) continue;  // no sample of i can lie here
        any = true;
        const float scale = mixture.scale(i, r.p, r.used);
        ASSERT_TRUE(std::isfinite(scale) && scale >= 0);
        const long double np = static_cast<long double>(mixture.n[s]) * static_cast<long double>(r.p[s]);
        const long double w = weight(rule, i, mixture.n, r.p, r.used);
        // the literal w_i/(n_i p_i); what is lost below float's range is a weight of no account
        ASSERT_NEAR(double(scale * np), double(w), 2e-6 * double(w) + 1e-12)
            << "technique " << i << " mask " << int(r.used);
        sum += static_cast<long double>(scale) * np;
      }
      if (any) {
        ASSERT_NEAR(double(sum), 1, 3e-6) << "mask " << int(r.used);
      }
    }
  }
}
TEST(Weights, AreTheFormulasAndSumToOne) { check(1e-3, 1e3); }
TEST(Weights, OfExtremeDensities) { check(1e-30, 1e30); }

// Where every density has underflowed, so has f.
TEST(Weights, NoDensityNoValue) {
  for (Weights rule : kRules) EXPECT_EQ(Mixture<3>({0.5f, 0.5f, 0}, 4, rule).scale(1, {0, 0, 0}, 3), 0);
}

// A technique that takes no samples takes no part of the weights either.
TEST(Weights, WithoutSamplesWithoutWeight) {
  for (Weights rule : kRules) {
    const Mixture<3> mixture({0, 1, 0}, 4, rule);
    EXPECT_FLOAT_EQ(mixture.scale(1, {1e10f, 0.5f, 1e10f}, Techniques<3>::kAll), 1 / (4 * 0.5f));
  }
}

// Def. 7: at equal counts balance and Eq. 14 are one.
TEST(Weights, EqualCountsMakeBalanceAndNonbalanceEqual) {
  Random random(2);
  for (int k = 0; k < 1000; ++k) {
    const Fractions<3> p{static_cast<float>(random.logUniform(1e-3, 1e3)),
                         static_cast<float>(random.logUniform(1e-3, 1e3)), 0};
    const Mixture<3> a({0.5f, 0.5f, 0}, 6, Weights::kBalance), b({0.5f, 0.5f, 0}, 6, Weights::kNonbalance);
    EXPECT_NEAR(a.scale(0, p, 3), b.scale(0, p, 3), 1e-6 * double(a.scale(0, p, 3)));
  }
}

TEST(Weights, OfThePaper) {
  EXPECT_EQ(paperWeights(Allocation::kEqual), Weights::kBalance);
  EXPECT_EQ(paperWeights(Allocation::kVariance), Weights::kNonbalance);
  EXPECT_EQ(paperWeights(Allocation::kSecondMoment), Weights::kBalance);
}

}  // namespace
}  // namespace wardmis
