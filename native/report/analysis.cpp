// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/analysis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "report/gallery.h"
#include "report/measured.h"
#include "report/provenance.h"
#include "report/resample.h"
#include "report/verdict.h"
#include "report/way_pictures.h"

namespace wardmis {
namespace {

using nlohmann::json;

constexpr double kFloorFactor = 10;      // errors under so many times the reference's own are marked
constexpr double kDiscoveryRate = 0.05;  // of the map of who wins
constexpr double kScatteredWall = 1.15;  // largest over median wall time of a configuration's runs
constexpr size_t kFewestTested = 5;      // seeds, for a test of bias that can be believed to find any
constexpr double kTargetFactor = 1.1;    // the target over what the last errors may be

json toJson(const Interval& i) { return {{"mean", i.value}, {"low", i.low}, {"high", i.high}}; }
json toJson(const std::optional<Interval>& i) { return i ? toJson(*i) : json(); }

// The reference's own share of an error; 0 where it is unknown or cannot be told.
double floorOf(const Reference& r, const MetricInfo& metric) {
  return metric.value == &Metrics::mse             ? r.mseFloor
         : metric.value == &Metrics::relMse        ? r.relMseFloor
         : metric.value == &Metrics::relMseTrimmed ? r.trimmedFloor
                                                   : 0;
}

const MetricInfo& metricOf(double Metrics::*value) {
  for (const MetricInfo& m : allMetrics())
    if (m.value == value) return m;
  throw std::logic_error("no such metric");
}

// Statistics of the curves of several seeds, as functions of the seeds drawn.
class Curves {
 public:
  Curves(const Measured& m, const MetricInfo& metric, double Clocks::*clock)
      : runs_(*m.runs), metric_(metric), clock_(clock), floor_(floorOf(*m.reference, metric)) {}

  // Mean time and error without the reference's share, from the checkpoint `from` on.
  Curve mean(std::span<const uint32_t> draw, size_t from = 0, bool bySamples = false) const {
    Curve c;
    for (size_t k = from; k < runs_[0].checkpoints.size(); ++k) {
      double time = 0, error = 0;
      for (const uint32_t i : draw) {
        const Checkpoint& at = runs_[i].checkpoints[k];
        time += bySamples ? double(at.spp) : at.time.*clock_;
        error += at.error.*metric_.value;
      }
      c.time.push_back(time / double(draw.size()));
      c.error.push_back(std::max(error / double(draw.size()) - floor_, 0.0));
    }
    return c;
  }
  // Of all seeds.
  Curve mean() const {
    std::vector<uint32_t> all(seeds());
    std::iota(all.begin(), all.end(), 0u);
    return mean(all);
  }
  size_t seeds() const { return runs_.size(); }
  size_t checkpoints() const { return runs_[0].checkpoints.size(); }
  uint32_t spp(size_t k) const { return runs_[0].checkpoints[k].spp; }

 private:
  const std::vector<Run>& runs_;
  const MetricInfo& metric_;
  double Clocks::*clock_;
  double floor_;
};

// Two significant digits, upwards.
double roundUp(double x) {
  const double unit = std::pow(10, std::floor(std::log10(x)) - 1);
  return std::ceil(x / unit - 1e-9) * unit;
}

// What times are taken to, and ratios are of.
struct Goal {
  const MetricInfo* metric = nullptr;
  double target = 0;
};

class Reporter {
 public:
  Reporter(const Experiment& e, const std::function<void(double)>& told) : e_(e), groups_(groupsOf(e)) {
    for (size_t k = 0; k < e.configurations.size(); ++k) {
      measured_.push_back(measure(e, k, groups_));
      if (told) told(0.7 * double(k + 1) / double(e.configurations.size()));
    }
    base_ = &measured_[e.baseline];
    commonSeeds_ = base_->runs->size();
    for (const Measured& m : measured_) commonSeeds_ = std::min(commonSeeds_, m.runs->size());
    choose();
    for (Measured& m : measured_)
      if (&m != base_ && !(m.configuration->external && !m.configuration->common)) m.wins = wins(m);
  }

  Analysis run() {
    Analysis a;
    json& r = a.report;
    r = {{"schema", "wardmis-report-1"},
         {"title", e_.title},
         {"version", WARDMIS_VERSION},
         {"created", timestamp()},
         {"complete", e_.complete},
         {"baseline", base_->configuration->name},
         {"metric", goal_.metric->name},
         {"clock", clock_ == &Clocks::cpu ? "cpu" : "wall"},
         {"effort_clock", base_->effort == &Clocks::cpu ? "cpu" : "wall"},
         {"wall_scattered", scattered_},
         {"seeds", json::array()},
         {"checkpoints", e_.checkpoints},
         {"width", e_.width},
         {"height", e_.height},
         {"metrics", metrics()},
         {"reference", reference(*base_->reference)},
         {"configurations", json::array()},
         {"provenance", provenance()}};
    for (const Run& run : *base_->runs) r["seeds"].push_back(run.seed);
    for (const Reference& each : e_.references) r["references"].push_back(reference(each));
    for (const Measured& m : measured_) r["configurations"].push_back(configuration(m));
    if (json t = techniques(); !t.empty()) r["techniques"] = std::move(t);
    if (json m = models(); !m.empty()) r["models"] = std::move(m);
    r["verdict"] = verdict(r);
    r["finding"] = finding(r);
    a.pictures = gallery(e_, measured_, r["configurations"]);
    a.images = imageFiles(e_, measured_);
    r["images"] = json::array();
    for (const Picture& p : a.pictures) r["images"].push_back(p.description);
    return a;
  }

 private:
  // The metric and the clock that times and ratios refer to, and a time that all have.
  void choose() {
    // under a heavy tail a few pixels of a few seeds decide the mean: the rest is asked without them, and with them too
    const bool heavy =
        std::any_of(measured_.begin(), measured_.end(), [](const Measured& m) { return m.seeds.tail.heavy(); });
    // a machine that others use as well: the clock of the processor then says more
    const bool cpuKnown = std::all_of(measured_.begin(), measured_.end(),
                                      [](const Measured& m) { return m.runs->front().checkpoints.back().cpuKnown; });
    scattered_ = std::any_of(measured_.begin(), measured_.end(),
                             [](const Measured& m) { return wallSpread(m) > kScatteredWall; });
    clock_ = scattered_ && cpuKnown ? &Clocks::cpu : &Clocks::wall;
    for (Measured& m : measured_) m.effort = cpuKnown ? &Clocks::cpu : &Clocks::wall;
    time_ = 1e300;
    for (const Measured& m : measured_) {
      if (isShort(m)) continue;
      for (const Run& run : *m.runs)
        time_ = std::min(time_, run.checkpoints.back().time.*clock_);  // within every curve
    }
    goal_ = goalOf(heavy ? &Metrics::relMseTrimmed : &Metrics::relMse);
    if (heavy) allPixels_ = goalOf(&Metrics::relMse);
  }

  // Another renderer, whose half of a budget ended earlier, decides on nothing.
  bool isShort(const Measured& m) const {
    return m.configuration->external &&
           m.runs->front().checkpoints.back().spp < base_->runs->front().checkpoints.back().spp;
  }

  // An error that all surely reach, late on their curves, when the pilot is long over, and clear of the reference's
  // noise.
  Goal goalOf(double Metrics::*value) const {
    const MetricInfo& metric = metricOf(value);
    double target = 0, half = std::numeric_limits<double>::infinity();
    for (const Measured& m : measured_) {
      if (isShort(m) || (m.seeds.biased() && &m != base_)) continue;  // it may have a limit of its own
      const Curves curves(m, metric, clock_);
      const auto last = Bootstrap(curves.seeds()).interval([&](std::span<const uint32_t> draw) {
        return std::optional(curves.mean(draw, curves.checkpoints() - 1).error.back());
      });
      // few seeds, or a firefly in one, may not be sure of anything: an error on everybody's curve is asked for then
      half = std::min(half, curves.mean().error[(curves.checkpoints() - 1) / 2]);
      target = std::max({target, last ? kTargetFactor * last->high : 0, kFloorFactor * floorOf(*m.reference, metric)});
    }
    if (half > 0) target = std::min(target, half);
    return {&metric, e_.target.value_or(target > 0 ? roundUp(target) : 1e-3)};
  }

  Curves curvesOf(const Measured& m, const Goal& goal) const { return {m, *goal.metric, clock_}; }

  json metrics() const {
    json all = json::array();
    for (const MetricInfo& m : allMetrics())
      all.push_back({{"name", m.name},
                     {"label", m.label},
                     {"formula", m.formula},
                     {"epsilon", m.epsilon > 0 ? json(m.epsilon) : json()},
                     {"floor_subtracted", m.floorSubtracted}});
    if (std::any_of(measured_.begin(), measured_.end(),
                    [](const Measured& m) { return m.runs->front().flip.has_value(); }))
      all.push_back({{"name", "flip"},
                     {"label", "HDR-FLIP"},
                     {"formula",
                      "mean over pixels of the perceived difference (Andersson et al. 2021), by its authors' program; "
                      "of the last image alone"},
                     {"epsilon", nullptr},
                     {"floor_subtracted", false}});
    return all;
  }

  json reference(const Reference& r) const {
    return {{"estimates", r.estimates},
            {"source", r.made ? "made" : "given"},
            {"path", r.made ? r.path.filename().string() : r.path.string()},
            {"spp", r.spp > 0 ? json(r.spp) : json()},
            {"seconds", r.seconds > 0 ? json(r.seconds) : json()},
            {"chunks", r.chunks > 0 ? json(r.chunks) : json()},
            {"floor",
             {{"mse", r.mseFloor > 0 ? json(r.mseFloor) : json()},
              {"relmse", r.relMseFloor > 0 ? json(r.relMseFloor) : json()},
              {"relmse_trimmed", r.trimmedFloor > 0 ? json(r.trimmedFloor) : json()}}}};
  }

  json curve(const Measured& m) const {
    json all = json::array();
    const size_t n = m.runs->size();
    const Bootstrap bootstrap(n);
    const Reference& r = *m.reference;
    std::vector<double> values(n);
    const auto mean = [&](auto&& get) {
      for (size_t i = 0; i < n; ++i) values[i] = get((*m.runs)[i]);
      return bootstrap.mean(values);
    };
    for (size_t k = 0; k < m.runs->front().checkpoints.size(); ++k) {
      const Checkpoint& at = m.runs->front().checkpoints[k];
      json j{{"spp", at.spp},
             {"wall", toJson(mean([&](const Run& run) { return run.checkpoints[k].time.wall; }))},
             {"cpu", at.cpuKnown ? toJson(mean([&](const Run& run) { return run.checkpoints[k].time.cpu; })) : json()},
             {"rays",
              at.rays > 0 ? json(mean([&](const Run& run) { return double(run.checkpoints[k].rays); }).value) : json()},
             {"samples", at.cameraRays > 0 ? json(at.cameraRays) : json()}};
      bool near = false;
      for (const MetricInfo& metric : allMetrics()) {
        const double floor = floorOf(r, metric);
        const Interval i = mean([&](const Run& run) { return run.checkpoints[k].error.*metric.value - floor; });
        j[metric.name] = toJson(i);
        near = near || (floor > 0 && i.value < kFloorFactor * floor);
      }
      if (k + 1 == m.runs->front().checkpoints.size() && m.runs->front().flip)
        j["flip"] = toJson(mean([](const Run& run) { return run.flip.value_or(0); }));
      j["near_floor"] = near;
      all.push_back(std::move(j));
    }
    return all;
  }

  json slopeOf(const Measured& m) const {
    const Curves curves = curvesOf(m, goal_);
    const size_t n = curves.checkpoints();
    if (n < 3) return {};
    // once the pilot's samples are few among all; at least three points
    const uint32_t from = std::max(4u, 4 * (m.configuration->external ? 0 : m.configuration->settings.pilotSpp));
    size_t first = 0;
    while (first + 3 < n && curves.spp(first) < from) ++first;
    const Bootstrap bootstrap(curves.seeds());
    const auto against = [&](bool bySamples) {
      return bootstrap.interval(
          [&](std::span<const uint32_t> draw) { return slope(curves.mean(draw, first, bySamples)); });
    };
    const std::optional<Interval> bySeconds = against(false), bySamples = against(true);
    if (!bySeconds) return {};
    SlopeFacts facts{.biased = m.seeds.biased(), .heavy = m.seeds.tail.heavy(), .unclear = m.seeds.unclear()};
    const RenderSettings& settings = m.configuration->settings;
    facts.independent = !m.configuration->external && settings.sampler == SamplerType::kIndependent;
    facts.pilot = !m.configuration->external && needsMoments(settings.allocation);
    facts.pilotApart = facts.pilot && pilotApart(settings) > 0;
    const SlopeVerdict v = judgeSlope(*bySeconds, bySamples, facts);
    return {{"value", bySeconds->value},
            {"low", bySeconds->low},
            {"high", bySeconds->high},
            {"by_samples", toJson(bySamples)},
            {"from_spp", curves.spp(first)},
            {"flag", v.flag},
            {"cause", v.cause},
            {"text", "Slope " + v.text + "."}};
  }

  json biasOf(const Measured& m) const {
    const BiasTest& b = m.seeds.bias;
    const bool known = m.reference->known();
    std::string text = fmt::format(
        "{} of {} blocks of {} × {} pixels differ from the reference (p < {:.2g}); the whole image: z = {:.2f}",
        b.failed, b.blocks, kBlock, kBlock, b.threshold, b.imageZ);
    const auto unmet = [&](const std::string& what) {
      text += fmt::format(
          "; {} no darker than so few samples of the reference could be: rare light that these seeds may not have met "
          "(more of them would tell)",
          what);
    };
    if (b.unmet > 0)
      unmet(b.unmet < b.failed ? fmt::format("{} of them {}", b.unmet, b.unmet == 1 ? "is" : "are")
            : b.failed == 1    ? "that block is"
                               : "those blocks are");
    if (b.imageUnmet) unmet("the whole image is");
    if (m.seeds.imageAlone() && b.failed > 0) text += "; the tail is heavy, so that the whole image alone counts";
    if (m.runs->size() < kFewestTested) text += "; too few seeds for a test that would find much";
    if (!known) text += "; the reference's own noise is not known and counts as bias";
    return {{"tested", true},
            {"blocks", b.blocks},
            {"block", kBlock},
            {"failed_blocks", b.failed},
            {"unmet_blocks", b.unmet},
            {"smallest_p", b.smallestP},
            {"threshold", b.threshold},
            {"image_z", b.imageZ},
            {"verdict", m.seeds.biased()                 ? "biased"
                        : m.runs->size() < kFewestTested ? "not testable"
                        : m.seeds.unclear()              ? "unclear"
                                                         : "none found"},
            {"text", text + "."}};
  }

  // A statistic of m over the same of another one, seeds paired.
  template <class Statistic>
  std::optional<Interval> ratioTo(const Measured& other, const Measured& m, const Statistic& statistic) const {
    return Bootstrap(commonSeeds_).interval([&](std::span<const uint32_t> draw) -> std::optional<double> {
      const std::optional<double> own = statistic(m, draw), theirs = statistic(other, draw);
      return own && theirs && *theirs > 0 ? std::optional(*own / *theirs) : std::nullopt;
    });
  }
  template <class Statistic>
  std::optional<Interval> ratioToBase(const Measured& m, const Statistic& statistic) const {
    if (&m == base_) return {};
    return ratioTo(*base_, m, statistic);
  }

  // Time of m to the target over that of another one; what another renderer's shorter curve does not reach is asked for
  // where that curve ends. Where there is no time, m's error at equal time over the other's.
  json advantage(const Measured& other, const Measured& m) const {
    const auto said = [](const std::optional<Interval>& ratio, const char* what) {
      json j = toJson(ratio);
      if (ratio) j["of"] = what;
      return j;
    };
    const auto times = [&](double target) {
      return ratioTo(other, m, [&](const Measured& x, std::span<const uint32_t> draw) {
        return timeTo(curvesOf(x, goal_).mean(draw), target);
      });
    };
    std::optional<Interval> ratio = times(goal_.target);
    if (!ratio && other.configuration->external) {
      const Curves curves = curvesOf(other, goal_);
      const auto last = Bootstrap(curves.seeds()).interval([&](std::span<const uint32_t> draw) {
        return std::optional(curves.mean(draw, curves.checkpoints() - 1).error.back());
      });
      if (last && last->high > 0) ratio = times(roundUp(kTargetFactor * last->high));
      if (ratio) return said(ratio, "time to its end");
    }
    if (ratio) return said(ratio, "time");
    return said(ratioTo(other, m,
                        [&](const Measured& x, std::span<const uint32_t> draw) {
                          return errorAt(curvesOf(x, goal_).mean(draw), time_);
                        }),
                "error");
  }

  json verdict(const json& report) const {
    const std::string use = recommended(report);
    json ratios = json::object();
    const auto chosen = std::find_if(measured_.begin(), measured_.end(),
                                     [&](const Measured& m) { return m.configuration->name == use; });
    for (const Measured& m : measured_)
      if (m.configuration->name != use)
        ratios[m.configuration->name] = chosen != measured_.end() ? advantage(m, *chosen) : json();
    return {{"use", use.empty() ? json() : json(use)},
            {"text", verdictText(report, use, ratios)},
            {"ratios", ratios},
            {"why", contradictions(report)}};
  }

  json timeToTarget(const Measured& m, const Goal& goal) const {
    const auto time = [&](const Measured& x, std::span<const uint32_t> draw) {
      return timeTo(curvesOf(x, goal).mean(draw), goal.target);
    };
    const std::optional<Interval> seconds =
        Bootstrap(m.runs->size()).interval([&](std::span<const uint32_t> draw) { return time(m, draw); });
    const std::optional<Interval> ratio = ratioToBase(m, time);
    const char* none = curvesOf(m, goal).mean().error.front() < goal.target ? "under from the start" : "not reached";
    return {{"target", goal.target},
            {"seconds", toJson(seconds)},
            {"ratio", toJson(ratio)},
            {"verdict", !seconds                   ? none
                        : &m == base_              ? "baseline"
                        : !ratio                   ? "not compared"
                        : ratio->high < 1 - kAlike ? "faster"
                        : ratio->low > 1 + kAlike  ? "slower"
                                                   : "tie"}};
  }

  json equalTime(const Measured& m, const Goal& goal) const {
    const auto error = [&](const Measured& x, std::span<const uint32_t> draw) {
      return errorAt(curvesOf(x, goal).mean(draw), time_);
    };
    const auto own = Bootstrap(m.runs->size()).interval([&](std::span<const uint32_t> draw) { return error(m, draw); });
    if (!own) return {};
    return {{"seconds", time_}, {"error", toJson(own)}, {"ratio", toJson(ratioToBase(m, error))}};
  }

  json equalSamples(const Measured& m, const Goal& goal) const {
    const auto error = [&](const Measured& x, std::span<const uint32_t> draw) {
      const double e = curvesOf(x, goal).mean(draw).error.back();
      return e > 0 ? std::optional(e) : std::nullopt;
    };
    const auto own = Bootstrap(m.runs->size()).interval([&](std::span<const uint32_t> draw) { return error(m, draw); });
    if (!own || m.runs->front().checkpoints.back().spp != base_->runs->front().checkpoints.back().spp) return {};
    return {{"spp", m.runs->front().checkpoints.back().spp},
            {"error", toJson(own)},
            {"ratio", toJson(ratioToBase(m, error))}};
  }

  // A seed's share of the relative variance; of the error, where the metric leaves pixels out.
  static double spreadOf(const Measured& m, size_t run, const MetricInfo& metric) {
    return metric.value == &Metrics::relMse
               ? m.seeds.spread[run]
               : (*m.runs)[run].checkpoints.back().error.*metric.value - floorOf(*m.reference, metric);
  }

  json efficiency(const Measured& m, const Goal& goal) const {
    const auto product = [&](const Measured& x, std::span<const uint32_t> draw) -> std::optional<double> {
      double variance = 0, time = 0;
      for (const uint32_t i : draw) variance += spreadOf(x, i, *goal.metric), time += x.seconds(i);
      const double n = double(draw.size());
      return variance >= 0 ? std::optional(variance / n * (time / n)) : std::nullopt;  // less the floor nothing is left
    };
    const Bootstrap bootstrap(m.runs->size());
    const auto own = bootstrap.interval([&](std::span<const uint32_t> draw) { return product(m, draw); });
    const auto byRays = bootstrap.interval([&](std::span<const uint32_t> draw) -> std::optional<double> {
      double variance = 0, rays = 0;
      for (const uint32_t i : draw)
        variance += spreadOf(m, i, *goal.metric), rays += double((*m.runs)[i].checkpoints.back().rays);
      const double n = double(draw.size());
      return rays > 0 && variance >= 0 ? std::optional(variance / n * (rays / n)) : std::nullopt;
    });
    return {{"variance_x_seconds", toJson(own)},
            {"variance_x_rays", toJson(byRays)},
            {"ratio", toJson(ratioToBase(m, product))}};
  }

  json costOf(const Measured& m) const {
    if (m.configuration->external) return {};
    Counts sum;
    double cpu = 0;
    for (size_t i = 0; i < m.runs->size(); ++i)
      sum += (*m.runs)[i].counts, cpu += (*m.runs)[i].checkpoints.back().time.cpu;
    const double samples = double(Counts::sum(sum.samples)), rays = double(sum.allRays());
    const double n = double(m.runs->size());
    json bySamples = json::object(), byRays{{"camera", double(sum.cameraRays) / n}};
    const std::vector<std::string>& names = e_.survey.techniqueNames;
    for (size_t t = 0; t < names.size(); ++t) {
      bySamples[names[t]] = double(sum.samples[t]) / n;
      byRays[t + 1 == names.size() ? "shadow" : names[t]] = double(sum.rays[t]) / n;
    }
    if (sum.lightRays > 0)
      byRays["light"] = double(sum.lightRays) / n, byRays["connections"] = double(sum.connections) / n;
    return {{"ns_per_sample", samples > 0 ? json(1e9 * cpu / samples) : json()},
            {"ns_per_path", 1e9 * cpu / double(sum.cameraRays)},
            {"rays_per_path", rays / double(sum.cameraRays)},
            {"evaluations", samples / n},
            {"samples", std::move(bySamples)},
            {"rays", std::move(byRays)}};
  }

  // The runs' own estimate of their variance over what the seeds show.
  json prediction(const Measured& m) const {
    if (m.predicted.empty()) return {};
    constexpr int kBins = 40;  // what lies beyond is in the outermost
    constexpr double kLow = -4, kWidth = 0.25;
    std::vector<size_t> counts(kBins);
    std::vector<double> ratios;
    double predicted = 0, values = 0;
    for (size_t i = 0; i < m.predicted.size(); ++i) {
      double measured = 0, relative = 0;
      for (size_t c = 0; c < 3; ++c) {
        measured += double(m.seeds.variance[3 * i + c]) / 3;
        const double r = double(m.reference->image.rgb[3 * i + c]);
        relative += 1 / (r * r + kRelMseEpsilon) / 3;
      }
      predicted += double(m.predicted[i]) * relative, values += 1;
      if (!(measured > 0) || !(m.predicted[i] > 0)) continue;
      const double ratio = double(m.predicted[i]) / measured;
      ratios.push_back(ratio);
      ++counts[static_cast<size_t>(std::clamp((std::log2(ratio) - kLow) / kWidth, 0.0, kBins - 1.0))];
    }
    if (ratios.empty()) return {};
    std::nth_element(ratios.begin(), ratios.begin() + static_cast<std::ptrdiff_t>(ratios.size() / 2), ratios.end());
    const double mean = predicted / values;
    const auto pooled =
        Bootstrap(m.runs->size()).interval([&](std::span<const uint32_t> draw) -> std::optional<double> {
          double measured = 0;
          for (const uint32_t i : draw) measured += m.seeds.spread[i] / double(draw.size());
          return measured > 0 ? std::optional(mean / measured) : std::nullopt;
        });
    json edges = json::array();
    for (int b = 0; b <= kBins; ++b) edges.push_back(kLow + kWidth * b);
    const bool independent = m.configuration->settings.sampler == SamplerType::kIndependent;
    return {{"edges", edges},
            {"counts", counts},
            {"median", ratios[ratios.size() / 2]},
            {"pooled", toJson(pooled)},
            {"low", pooled ? json(pooled->low) : json()},
            {"high", pooled ? json(pooled->high) : json()},
            {"text",
             independent
                 ? "1 is expected: the samples are independent. More where counts are not whole at each hit: they are "
                   "spread evenly over the pixel's samples, which its own estimate does not see."
                 : "More than 1 is expected: the runs estimate as if their samples were independent, and the "
                   "sampler's evenly spread points do better."}};
  }

  json allocationOf(const Measured& m) const {
    if (m.configuration->external) return {};
    json j = json::object();
    const RenderSettings& s = m.configuration->settings;
    const size_t pixels = m.predicted.size();
    std::vector<int> present(pixels);
    const size_t techniques = m.fractions.size();
    for (size_t t = 0; t < techniques; ++t)
      for (size_t i = 0; i < m.fractions[t].size(); ++i) present[i] += has(e_.survey.pixels[i].techniques, t);
    size_t sampled = 0, clamped = 0, starved = 0;
    std::vector<double> mean(techniques);
    const double spp = double(e_.checkpoints.back());
    const double pilot = pilotApart(s) > 0 ? 0 : std::min(double(s.pilotSpp), spp / 2);
    for (size_t i = 0; i < pixels; ++i) {
      double sum = 0;
      for (size_t t = 0; t < techniques; ++t) sum += m.fractions[t].empty() ? 0 : double(m.fractions[t][i]);
      if (!(sum > 0)) continue;
      ++sampled;
      bool least = false, none = false;
      // at the least share after the pilot, whose counts are equal
      const double limit = (pilot / std::max(1, present[i]) + (spp - pilot) * double(s.minFraction)) / spp * 1.02;
      for (size_t t = 0; t < techniques; ++t) {
        if (m.fractions[t].empty()) continue;
        const double a = double(m.fractions[t][i]);
        mean[t] += a;
        if (!has(e_.survey.pixels[i].techniques, t)) continue;
        none = none || a <= 0;
        least = least || (a > 0 && a <= limit);
      }
      clamped += present[i] > 1 && least ? 1 : 0;
      starved += none ? 1 : 0;
    }
    if (sampled == 0) return {};
    for (size_t t = 0; t < techniques; ++t)
      if (!m.fractions[t].empty()) j[e_.survey.techniqueNames[t]] = mean[t] / double(sampled);
    const bool hasLeast = needsMoments(s.allocation) && s.allocation != Allocation::kAuto;
    j["clamped"] = hasLeast ? json(double(clamped) / double(pixels)) : json();
    j["starved"] = double(starved) / double(pixels);
    return j;
  }

  // Error x time against the baseline's: paired t over the seeds of each block of pixels, Benjamini-Hochberg over
  // the blocks. Per pixel: 0 better, 1 worse, 2 undecided.
  std::vector<uint8_t> wins(const Measured& m) const {
    const size_t n = commonSeeds_, width = static_cast<size_t>(e_.width), height = static_cast<size_t>(e_.height);
    const size_t across = (width + kWinBlock - 1) / kWinBlock, blocks = across * ((height + kWinBlock - 1) / kWinBlock);
    const auto blockOf = [&](size_t i) { return i / width / kWinBlock * across + i % width / kWinBlock; };
    std::vector<double> sum(blocks), squares(blocks);
    for (size_t s = 0; s < n; ++s) {
      std::vector<double> difference(blocks);
      for (size_t i = 0; i < width * height; ++i)
        difference[blockOf(i)] +=
            double(m.seeds.errors[s][i]) * m.seconds(s) - double(base_->seeds.errors[s][i]) * base_->seconds(s);
      for (size_t b = 0; b < blocks; ++b) sum[b] += difference[b], squares[b] += difference[b] * difference[b];
    }
    std::vector<double> p(blocks);
    for (size_t b = 0; b < blocks; ++b) p[b] = pOfStudent(tOfDifferences(sum[b], squares[b], n), double(n) - 1);
    const double threshold = benjaminiHochberg(p, kDiscoveryRate);
    std::vector<uint8_t> result(width * height);
    for (size_t i = 0; i < result.size(); ++i) {
      const size_t b = blockOf(i);
      result[i] = p[b] <= threshold ? (sum[b] < 0 ? 0 : 1) : 2;
    }
    return result;
  }

  json groups(const Measured& m) const {
    json all = json::array();
    for (size_t k = 0; k < groups_.size(); ++k) {
      const Group& g = groups_[k];
      // per seed, without the reference's share
      const Reference part = partOf(*m.reference, g);
      const auto errors = [&](const Measured& x, const Reference& reference, const MetricInfo& metric) {
        const double floor = floorOf(reference, metric);
        std::vector<double> perSeed;
        for (const Metrics& error : x.groups[k]) perSeed.push_back(error.*metric.value - floor);
        return perSeed;
      };
      const std::vector<double> own = errors(m, part, metricOf(&Metrics::relMse)),
                                base = errors(*base_, partOf(*base_->reference, g), metricOf(&Metrics::relMse));
      std::optional<Interval> ratio, errorRatio;
      if (&m != base_) {
        errorRatio = Bootstrap(commonSeeds_).interval([&](std::span<const uint32_t> draw) -> std::optional<double> {
          double a = 0, b = 0;
          for (const uint32_t i : draw) a += own[i], b += base[i];
          return b > 0 ? std::optional(std::max(a, 0.0) / b) : std::nullopt;
        });
        ratio = Bootstrap(commonSeeds_).interval([&](std::span<const uint32_t> draw) -> std::optional<double> {
          double a = 0, b = 0, s = 0, t = 0;
          for (const uint32_t i : draw) a += own[i], b += base[i], s += m.seconds(i), t += base_->seconds(i);
          return b > 0 ? std::optional(std::max(a, 0.0) * s / (b * t)) : std::nullopt;
        });
      }
      json found{{"kind", g.kind},
                 {"name", g.name},
                 {"pixels", g.pixels.size()},
                 {"error_ratio", toJson(errorRatio)},
                 {"ratio", toJson(ratio)}};
      for (const MetricInfo& metric : allMetrics()) {
        Interval mean = Bootstrap(m.runs->size()).mean(errors(m, part, metric));
        for (double* x : {&mean.value, &mean.low, &mean.high}) *x = std::max(*x, 0.0);
        found[metric.name] = toJson(mean);
      }
      all.push_back(std::move(found));
    }
    return all;
  }

  json waysOf(const Measured& m) const {
    const auto k = static_cast<size_t>(m.configuration - e_.configurations.data());
    return k < e_.ways.size() ? waysJson(e_.ways[k], m.configuration->settings.samplesPerHit) : json();
  }

  json configuration(const Measured& m) const {
    const Configuration& c = *m.configuration;
    RareCounts dropped;
    double pilot = 0;
    for (const Run& run : *m.runs) dropped += run.counts.rare, pilot += run.pilotSeconds / double(m.runs->size());
    std::string description;
    for (const auto& [key, value] : c.described.items())
      if (key == "allocation" || key == "weights" || key == "integrand" || key == "integrator" || key == "sampler")
        description += (description.empty() ? "" : ", ") + key + " " +
                       (value.is_string() ? value.get<std::string>() : value.dump());
    json wins;
    if (!m.wins.empty()) {
      const auto share = [&](uint8_t outcome) {
        return double(std::count(m.wins.begin(), m.wins.end(), outcome)) / double(m.wins.size());
      };
      wins = {{"better", share(0)}, {"worse", share(1)}, {"undecided", share(2)}};
    }
    json toTarget = timeToTarget(m, goal_);
    if (!wins.is_null()) wins["text"] = mapRemark(c.name, base_->configuration->name, wins, toTarget);
    return {{"name", c.name},
            {"image", folderName(c.name) + ".exr"},
            {"renderer", c.renderer},
            {"settings", c.described},
            {"description", description},
            {"kernel", c.kernel},
            {"left_out", c.leftOut},
            {"notes", c.notes},
            {"runs", m.runs->size()},
            {"estimates", c.external ? json() : json(estimates(c.settings))},
            {"reference", m.reference->estimates},
            {"curve", curve(m)},
            {"pilot_seconds", c.external ? json() : json(pilot)},
            {"pilot_apart", c.external || !(pilot > 0) ? 0 : pilotApart(c.settings)},
            {"slope", slopeOf(m)},
            {"bias", biasOf(m)},
            {"tail",
             {{"top_share", m.seeds.tail.topShare},
              {"seed_ratio", m.seeds.tail.seedRatio},
              {"kurtosis", m.seeds.tail.kurtosis},
              {"heavy", m.seeds.tail.heavy()}}},
            {"time_to_target", std::move(toTarget)},
            {"equal_time", equalTime(m, goal_)},
            {"equal_samples", equalSamples(m, goal_)},
            {"efficiency", efficiency(m, goal_)},
            {"all_pixels", allPixels_ ? json{{"time_to_target", timeToTarget(m, *allPixels_)},
                                             {"equal_time", equalTime(m, *allPixels_)},
                                             {"equal_samples", equalSamples(m, *allPixels_)},
                                             {"efficiency", efficiency(m, *allPixels_)}}
                                      : json()},
            {"cost", costOf(m)},
            {"prediction", prediction(m)},
            {"allocation", allocationOf(m)},
            {"ways", waysOf(m)},
            {"counts",
             c.external ? json()
                        : json{{"nan", dropped.nan}, {"infinite", dropped.infinite}, {"negative", dropped.negative}}},
            {"wins", wins},
            {"groups", groups(m)}};
  }

  json techniques() const {
    json all = json::array();
    for (size_t t = 0; t < e_.survey.techniqueNames.size(); ++t) {
      if (!has(e_.survey.techniques, t)) continue;
      all.push_back({{"name", e_.survey.techniqueNames[t]},
                     {"ns_per_sample", 1e9 * e_.sampleCost[t]},
                     {"second_moment", e_.survey.secondMoment[t]},
                     {"variance", e_.survey.variance[t]},
                     {"variance_x_cost", 1e9 * e_.sampleCost[t] * e_.survey.variance[t]}});
    }
    return all.size() > 1 ? all : json::array();
  }

  // Other renderers' converged images beside ours.
  json models() const {
    json all = json::array();
    for (const Measured& m : measured_) {
      if (!m.configuration->external) continue;
      const Reference &own = e_.references[0], &other = e_.references[m.configuration->reference];
      const ImageError d = compareImages(other.image, own.image);
      double mean[3] = {}, ours[3] = {};
      for (size_t i = 0; i < own.image.pixels(); ++i)
        for (size_t c = 0; c < 3; ++c)
          mean[c] += double(other.image.rgb[3 * i + c]), ours[c] += double(own.image.rgb[3 * i + c]);
      const double noise = own.relMseFloor + other.relMseFloor;
      const double beyond = std::max(0.0, d.relMse - noise);
      json j{{"name", m.configuration->name},
             {"against", "WardMIS"},
             {"difference",
              {{"relmse", beyond},
               {"relmse_trimmed", d.relMseTrimmed},
               {"noise", noise},
               {"mse", std::max(0.0, d.mse - own.mseFloor - other.mseFloor)},
               {"mean", {{"r", mean[0] / ours[0] - 1}, {"g", mean[1] / ours[1] - 1}, {"b", mean[2] / ours[2] - 1}}}}},
             {"common", m.configuration->common},
             {"agree", nullptr}};
      const std::string name = m.configuration->renderer;
      if (m.configuration->common && own.known() && other.known() && m.runs->size() >= kFewestTested) {
        const BiasTest test = compareConverged(other, own);
        const bool agree = !test.biased() && !m.seeds.biased() && !m.seeds.bias.biased();
        const bool unclear = agree && m.seeds.unclear();
        if (!unclear) j["agree"] = agree;
        const std::string tests = fmt::format(
            "of {} blocks of {} × {} pixels {} differ between the converged images (image z {:.1f}), and {} between "
            "its runs "
            "and the reference (image z {:.1f})",
            test.blocks, kBlock, kBlock, test.failed, test.imageZ, m.seeds.bias.failed, m.seeds.bias.imageZ);
        j["text"] =
            unclear ? fmt::format(
                          "{} and WardMIS have the same integrand here and share one reference; whether its runs "
                          "agree with it, more seeds would tell: {}.",
                          name, tests)
            : agree
                ? fmt::format(
                      "{} and WardMIS have the same integrand here, share one reference, and agree with it: {}.", name,
                      tests)
                : fmt::format("{} and WardMIS should have the same integrand here, and do NOT agree: {}.", name, tests);
      } else if (m.configuration->common) {
        j["text"] = fmt::format(
            "{} and WardMIS have the same integrand here and share one reference; whether they agree with it cannot be "
            "tested with {} seeds{}.",
            name, m.runs->size(), other.known() ? "" : " and one reference image");
      } else if (beyond < noise) {
        j["text"] = fmt::format(
            "The converged images of {} and WardMIS differ by no more than their own noise (relMSE {:.3g}).", name,
            noise);
      } else {
        j["text"] = fmt::format(
            "The converged images of {} and WardMIS differ by a relMSE of {:.3g} ({:.3g} without the largest 0.1 % of "
            "the "
            "pixels), beyond the {:.3g} of their own noise: a difference of the models of reflection, not an error; "
            "each is "
            "held against its own reference.",
            name, beyond, d.relMseTrimmed, noise);
      }
      all.push_back(std::move(j));
    }
    return all;
  }

  json provenance() const {
    json j = machineJson();
    json spread = json::object(), loads = json::array();
    double low = 1e300, high = 0;
    for (const Measured& m : measured_) {
      spread[m.configuration->name] = wallSpread(m);
      if (m.configuration->external) continue;
      for (const Run& run : *m.runs) {
        loads.push_back(run.load);
        low = std::min(low, run.calibration), high = std::max(high, run.calibration);
      }
    }
    j.update({{"threads", e_.threads},
              {"scene", e_.scene->path},
              {"scene_hash", e_.sceneHash},
              {"triangles", e_.built->geometry.triangles},
              {"load", loads},
              {"timing_spread", spread},
              {"calibration", {{"low", 1e9 * low}, {"high", 1e9 * high}}},
              {"started", e_.started},
              {"ended", e_.ended},
              {"command", e_.command}});
    return j;
  }

  const Experiment& e_;
  std::vector<Measured> measured_;
  const Measured* base_ = nullptr;
  Goal goal_;
  std::optional<Goal> allPixels_;  // where goal_ leaves some out
  double Clocks::*clock_ = &Clocks::wall;
  bool scattered_ = false;  // wall times of equal runs lie too far apart to be trusted
  size_t commonSeeds_ = 0;
  double time_ = 0;
  std::vector<Group> groups_;
};

}  // namespace

Analysis analyse(const Experiment& experiment, const std::function<void(double)>& told) {
  return Reporter(experiment, told).run();
}

}  // namespace wardmis
