// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/trials.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "math/error.h"
#include "mis/adaptive.h"
#include "mis/candidates.h"

namespace wardmis {

namespace {

using Clock = std::chrono::steady_clock;
using Counts = std::array<int, kMaxTechniques>;
size_t at(int i) { return static_cast<size_t>(i); }

constexpr int kPasses = 4;             // of progressive strategies
constexpr double kPilotShare = 0.125;  // of the samples of pilot strategies
constexpr double kLeastLearnt = 0.02;  // fraction of any technique, where fractions follow samples

// The samples of one trial.
struct Trial {
  std::vector<SampleBlock> blocks;  // by technique
  int techniques = 0;

  double f(int i, int j) const { return blocks[at(i)].f[at(j)]; }
  Densities p(int i, int j) const {
    Densities p{};
    for (int k = 0; k < techniques; ++k) p[at(k)] = blocks[at(i)].p[at(k)][at(j)];
    return p;
  }
};

// sum of f/sum_k c_k p_k over samples [first, last) of every technique: balance and nonbalance weights, vectorised.
double sumOverMixture(const Trial& t, const Densities& c, const Densities& scale, const Counts& first,
                      const Counts& count) {
  double total = 0;
  for (int i = 0; i < t.techniques; ++i) {
    const SampleBlock& b = t.blocks[at(i)];
    const double* f = b.f.data();
    double sum = 0;
    const int from = first[at(i)], to = from + count[at(i)];
    if (t.techniques == 2) {
      const double *p0 = b.p[0].data(), *p1 = b.p[1].data(), c0 = c[0], c1 = c[1];
      for (int j = from; j < to; ++j) {
        const double q = c0 * p0[j] + c1 * p1[j];
        sum += f[j] / (q > 0 ? q : 1.0);
      }
    } else {
      for (int j = from; j < to; ++j) {
        double q = 0;
        for (int k = 0; k < t.techniques; ++k) q += c[at(k)] * b.p[at(k)][at(j)];
        sum += f[j] / (q > 0 ? q : 1.0);
      }
    }
    total += sum * scale[at(i)];
  }
  return total;
}

int total(const Counts& n) {
  int sum = 0;
  for (int c : n) sum += c;
  return sum;
}

constexpr Densities kOnes{1, 1, 1, 1, 1, 1, 1, 1};

double balance(const Trial& t, const Counts& first, const Counts& count) {
  Densities n{};
  for (int k = 0; k < t.techniques; ++k) n[at(k)] = count[at(k)];
  return sumOverMixture(t, n, kOnes, first, count);
}

// The estimate with weights that are known beforehand.
double estimate(Weights weights, const Trial& t, const Counts& count, const Densities& v, const Densities& tau) {
  const int n = t.techniques, all = total(count);
  if (weights == Weights::kBalance) return balance(t, {}, count);
  if (weights == Weights::kNonbalance) {
    Densities scale{};
    for (int k = 0; k < n; ++k) scale[at(k)] = 1.0 / count[at(k)];
    return sumOverMixture(t, kOnes, scale, {}, count);
  }
  Densities a{};
  for (int k = 0; k < n; ++k) a[at(k)] = double(count[at(k)]) / all;
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    if (weights == Weights::kOptimal) sum += tau[at(i)];
    for (int j = 0; j < count[at(i)]; ++j) {
      const Densities p = t.p(i, j);
      if (weights == Weights::kOptimal) {
        double q = 0, control = 0;
        for (int k = 0; k < n; ++k) q += a[at(k)] * p[at(k)], control += tau[at(k)] * p[at(k)];
        // below the horizon only the lobe's density is left, of which the ratio is known
        sum += (q > 0 ? (t.f(i, j) - control) / q : -tau[at(i)] / a[at(i)]) / all;
      } else if (t.f(i, j) > 0) {
        sum += weightedValue(weights, i, n, t.f(i, j), p, a, v) / count[at(i)];
      }
    }
  }
  return sum;
}

// The samples so far of every technique, as points.
Points pooled(const Trial& t, const Counts& count) {
  Points points;
  points.techniques = t.techniques;
  Densities n{}, below{};
  for (int k = 0; k < t.techniques; ++k) n[at(k)] = count[at(k)];
  for (int i = 0; i < t.techniques; ++i)
    for (int j = 0; j < count[at(i)]; ++j) {
      const Point x = pooledPoint(t.f(i, j), t.p(i, j), n, t.techniques);
      if (x.w > 0)
        points.list.push_back(x);
      else
        below[at(i)] += 1;
    }
  for (int i = 0; i < t.techniques; ++i)
    if (count[at(i)] > 0) points.setOutside(at(i), std::log(below[at(i)] / count[at(i)]));
  return points;
}

// Passes of equal size; each with what the ones before taught, all with the weight of their samples.
double progressive(const Strategy& s, const Trial& t, int samples, Counts& last) {
  const int n = t.techniques;
  Counts done{};
  double sum = 0;
  Densities a{}, tau{};
  std::fill_n(a.begin(), n, 1.0 / n);
  const int passes = std::min(kPasses, samples / n);  // each technique gets a sample in each
  for (int pass = 0; pass < passes; ++pass) {
    const int size = static_cast<int>(int64_t(samples) * (pass + 1) / passes - int64_t(samples) * pass / passes);
    const Counts count = wholeCounts(a, n, size);
    if (s.weights == Weights::kOptimal) {
      double part = 0;
      for (int k = 0; k < n; ++k) part += tau[at(k)];
      for (int i = 0; i < n; ++i)
        for (int j = done[at(i)]; j < done[at(i)] + count[at(i)]; ++j) {
          const Densities p = t.p(i, j);
          double q = 0, control = 0;
          for (int k = 0; k < n; ++k) q += p[at(k)] * count[at(k)], control += tau[at(k)] * p[at(k)];
          part += q > 0 ? (t.f(i, j) - control) / q : -tau[at(i)] / count[at(i)];
        }
      sum += part * size;
    } else {
      sum += balance(t, done, count) * size;
    }
    for (int k = 0; k < n; ++k) done[at(k)] += count[at(k)];
    last = count;
    if (pass + 1 == passes) break;
    const Points known = pooled(t, done);
    if (s.weights == Weights::kOptimal)
      tau = optimalTau(known, a);
    else
      a = clampFractions(equaliseSecondMoments(known, a), n, kLeastLearnt);
  }
  return sum / total(done);
}

// The choice of a render's `auto`, from pairs of each technique's samples as it has them at a hit.
Densities chosen(const Trial& t, int pairs, int rest, const Densities* cost) {
  constexpr size_t K = kStudyTechniques;
  const CandidateLists<K> lists(rest);
  const auto mask = static_cast<TechniqueMask>((1u << t.techniques) - 1);
  const CandidateList<K>& list = lists.of(mask);
  Fractions<K> n{};
  SampleCost<K> price;
  for (int i = 0; i < t.techniques; ++i) {
    n[at(i)] = kSets;
    if (cost != nullptr) price.technique[at(i)] = static_cast<float>((*cost)[at(i)]);
  }
  CandidateSums<K> sums;
  for (int pair = 0; pair < pairs; ++pair) {
    CandidateHit<K> hit(list);
    for (int i = 0; i < t.techniques; ++i)
      for (int set = 0; set < kSets; ++set) {
        const int j = kSets * pair + set;
        const Densities p = t.p(i, j);
        hit.add(static_cast<float>(t.f(i, j)), {float(p[0]), float(p[1]), float(p[2])}, n, mask, set);
      }
    hit.addTo(sums, price);
  }
  SurfaceScatter<K> all;
  const Fractions<K> a = chooseCandidate<K>(sums, all += sums, list, price);
  return {double(a[0]), double(a[1]), double(a[2])};
}

// Fewer samples than make a pilot of kLeastHits hits the smaller half are equal counts.
double fromPilot(const Trial& t, int samples, const Densities* cost, Counts& last) {
  const int n = t.techniques;
  const int pairs = std::max(kLeastHits, static_cast<int>(samples * kPilotShare / (kSets * n)));
  const int each = kSets * pairs, rest = samples - n * each;
  if (rest < n * each) return balance(t, {}, last = wholeCounts(equalFractions(n), n, samples));
  Counts pilot{};
  std::fill_n(pilot.begin(), n, each);
  last = wholeCounts(chosen(t, pairs, rest, cost), n, rest);
  return (balance(t, {}, pilot) * (n * each) + balance(t, pilot, last) * rest) / samples;
}

// About 1/kurtosis of the mean over the trials, of independent samples with these fractions.
double eventsOf(const Contributions& c, const Densities& a, int techniques, int samples, int trials) {
  double variance = 0, fourth = 0;
  for (int i = 0; i < techniques; ++i) {  // y_i of nonbalance weights and others alike: w_i f/p_i, averaged over N_i
    const double count = a[at(i)] * samples;
    variance += c.variance[at(i)] / count, fourth += c.fourth[at(i)] / std::pow(count, 3);
  }
  return fourth > 0 ? trials * variance * variance / fourth : std::numeric_limits<double>::infinity();
}

// Of a strategy whose counts follow its samples, and lie anywhere between equal ones and those of its goal; nor more
// than how often, in all trials with equal counts, the technique that does so most rarely meets the light.
double eventsOfLearning(const Strategy& s, const Densities& goal, const Exact& exact, int samples, int trials) {
  const int n = exact.points.techniques;
  double least = std::numeric_limits<double>::infinity();
  for (const Densities& a : {equalFractions(n), clampFractions(goal, n, kLeastLearnt)})
    least = std::min(least, eventsOf(contributions(s.weights, a, exact.points, exact.moments), a, n, samples, trials));
  for (int i = 0; i < n; ++i) {
    const double mean2 = exact.moments.mean[at(i)] * exact.moments.mean[at(i)];
    least = std::min(least, double(trials) * samples / n * mean2 / (mean2 + exact.moments.variance[at(i)]));
  }
  return least;
}

// Whether a run's events and trials are enough to tell a bias from bad luck.
bool judgeable(const StrategyRun& run, int trials) {
  if (run.predictedVariance) return run.events >= kEventsGiven;
  return run.events >= kEventsOwn && trials >= kTrialsOwn &&
         run.estimate.varianceError() < 0.15 * run.estimate.variance();
}

}  // namespace

Densities measureCost(const Problem& problem) {
  constexpr size_t kBatch = 4096;
  Densities cost{};
  SampleBlock block;
  block.resize(kBatch, problem.techniques());
  for (int i = 0; i < problem.techniques(); ++i) {
    std::vector<double> times;
    Stream random(1, static_cast<uint64_t>(i));
    for (int repeat = 0; repeat < 9; ++repeat) {
      const auto start = Clock::now();
      problem.sample(i, random, block, 0, kBatch);
      times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count() / kBatch);
    }
    std::nth_element(times.begin(), times.begin() + 4, times.end());
    cost[at(i)] = times[4];
  }
  return cost;
}

std::vector<StrategyRun> runTrials(const Problem& problem, const Exact& exact,
                                   const std::vector<const Strategy*>& strategies, const TrialSettings& settings,
                                   const std::vector<Prediction>* predictions) {
  const int n = problem.techniques(), samples = settings.samples;
  if (samples < n)
    throw Error(ExitCode::kUsage, fmt::format("{} samples for {} techniques", samples, n),
                "give at least one for each technique");
  const Densities* cost = settings.cost ? &*settings.cost : nullptr;
  const Densities v = varianceAwareFactors(exact.moments);
  std::vector<StrategyRun> runs;
  std::vector<Densities> taus;
  Counts needed{};
  const std::vector<Prediction> own =
      predictions == nullptr ? predictAll(strategies, exact, cost) : std::vector<Prediction>();
  const std::vector<Prediction>& predicted = predictions == nullptr ? own : *predictions;
  for (const Strategy* s : strategies) {
    StrategyRun run;
    run.strategy = s;
    run.exact = predicted[runs.size()];
    run.counts = wholeCounts(run.exact.fractions, n, samples);
    Densities actual{};
    for (int k = 0; k < n; ++k) actual[at(k)] = double(run.counts[at(k)]) / samples;
    if (s->knowledge == Knowledge::kGiven) {
      const Contributions c = contributions(s->weights, actual, exact.points, exact.moments);
      run.predictedVariance = std::exp(logVariance(s->weights, actual, exact.moments, c)) / samples;
      run.events = eventsOf(c, actual, n, samples, settings.trials);
    } else if (settings.trials > 0) {
      run.events = eventsOfLearning(*s, run.exact.fractions, exact, samples, settings.trials);
    }
    taus.push_back(s->weights == Weights::kOptimal && s->knowledge == Knowledge::kGiven
                       ? optimalTau(exact.points, actual)
                       : Densities{});
    const bool learns = s->knowledge == Knowledge::kProgressive || s->knowledge == Knowledge::kPilot;
    for (int k = 0; k < n; ++k) needed[at(k)] = std::max(needed[at(k)], learns ? samples : run.counts[at(k)]);
    runs.push_back(run);
  }

  // values[trial][strategy], so that what is summed does not depend on threads
  const size_t trials = at(settings.trials), count = runs.size();
  std::vector<double> values(trials * count), seconds(trials * count);
  std::vector<Counts> last(count);
  tbb::enumerable_thread_specific<Trial> scratch([&] {
    Trial t;
    t.techniques = n;
    t.blocks.resize(at(n));
    for (int i = 0; i < n; ++i) t.blocks[at(i)].resize(at(needed[at(i)]), n);
    return t;
  });
  const auto since = [](Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, trials, 1), [&](const auto& range) {
      Trial& t = scratch.local();
      for (size_t trial = range.begin(); trial != range.end(); ++trial) {
        for (int i = 0; i < n; ++i) {
          Stream random(settings.seed, trial * kMaxTechniques + static_cast<uint64_t>(i));
          problem.sample(i, random, t.blocks[at(i)], 0, at(needed[at(i)]));
        }
        for (size_t s = 0; s < count; ++s) {
          const Strategy& strategy = *runs[s].strategy;
          const auto begin = Clock::now();
          Counts counts = runs[s].counts;
          double& value = values[trial * count + s];
          switch (strategy.knowledge) {
            case Knowledge::kGiven:
              value = estimate(strategy.weights, t, counts, v, taus[s]);
              break;
            case Knowledge::kProgressive:
              value = progressive(strategy, t, samples, counts);
              break;
            case Knowledge::kDirect: {
              Densities a{};
              for (int k = 0; k < n; ++k) a[at(k)] = double(counts[at(k)]) / samples;
              const Densities tau = optimalTau(pooled(t, counts), a);
              value = 0;
              for (int k = 0; k < n; ++k) value += tau[at(k)];
              break;
            }
            case Knowledge::kPilot:
              value = fromPilot(t, samples, cost, counts);
              break;
          }
          seconds[trial * count + s] = since(begin);
          if (trial + 1 == trials) last[s] = counts;
        }
      }
    });
  });
  for (size_t s = 0; s < count; ++s) {
    for (size_t trial = 0; trial < trials; ++trial) runs[s].estimate.add(values[trial * count + s]);
    if (trials == 0) continue;
    runs[s].judgeable = judgeable(runs[s], settings.trials);
    if (runs[s].strategy->knowledge != Knowledge::kGiven) runs[s].counts = last[s];
    // the median: a trial that another program interrupts must not count
    std::vector<double> combining(trials);
    for (size_t trial = 0; trial < trials; ++trial) combining[trial] = seconds[trial * count + s];
    std::nth_element(combining.begin(), combining.begin() + static_cast<ptrdiff_t>(trials / 2), combining.end());
    runs[s].seconds = combining[trials / 2];
    for (int k = 0; k < n; ++k)
      runs[s].seconds += 1e-9 * settings.nanoseconds[at(k)] * samples * runs[s].counts[at(k)] / total(runs[s].counts);
  }
  return runs;
}

}  // namespace wardmis
