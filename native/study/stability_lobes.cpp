// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/stability_lobes.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "math/random.h"

namespace wardmis {

namespace {

constexpr int kLobesOfAKind = 20000;

int integer(Stream& random, int count) { return std::min(count - 1, static_cast<int>(random.uniform() * count)); }
double logUniform(Stream& random, double from, double to) { return from * std::pow(to / from, random.uniform()); }

// A third within ten degrees of the horizon, to 0.0001 degrees.
Vec3<double> direction(Stream& random) {
  const double degrees = random.uniform() < 0.3 ? 90 - logUniform(random, 1e-4, 10) : 90 * random.uniform();
  const double theta = degrees * kPi<double> / 180, phi = 2 * kPi<double> * random.uniform();
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}
// Not inlined: with -fno-trapping-math GCC 12 leaves out the rounding of a double to float where it is widened again.
[[gnu::noinline]] Vec3f inFloat(Vec3<double> v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
Vec3<double> inDouble(Vec3f v) { return {v.x, v.y, v.z}; }
template <class T, class U>
Vec3<T> as(Vec3<U> v) {
  return {T(v.x), T(v.y), T(v.z)};
}

Lobe extremeLobe(LobeKind kind, Stream& random) {
  const auto alpha = [&] { return float(random.uniform() < 0.2 ? 1 : logUniform(random, 1e-6, 1)); };
  const auto unit = [&] { return float(random.uniform()); };
  Lobe l;
  l.kind = kind;
  l.ax = alpha(), l.ay = random.uniform() < 0.5 ? l.ax : alpha();
  if (kind == LobeKind::kAshikhminShirley) l.ax = std::max(l.ax, 1e-4f), l.ay = std::max(l.ay, 1e-4f);
  constexpr float kEtas[] = {0.3f, 0.9f, 0.9999f, 1.0001f, 1.5f, 3.0f, 20.0f};
  l.eta = kEtas[integer(random, 7)];
  l.fresnel = static_cast<Fresnel>(integer(random, 5)), l.masking = static_cast<Masking>(integer(random, 3));
  l.f0 = {unit(), unit(), unit()};
  l.edge = {f82Edge(l.f0.x, 0), f82Edge(l.f0.y, unit()), 0};
  l.a = 0.01f + 0.99f * unit(), l.b = -0.2f * unit();
  if (kind == LobeKind::kPhong) l.a = float(logUniform(random, 1, 1e6));
  if (kind == LobeKind::kOrenNayar || kind == LobeKind::kRoughTranslucent) {
    const auto model = OrenNayar<float>::of(unit());
    l.a = model.a, l.b = model.b;
  }
  return l;
}

std::string described(const Lobe& l, Vec3f wi, Vec3f wo) {
  return fmt::format("alpha {:.3g}:{:.3g} eta {:g} a {:.3g}, wo {:.3g} {:.3g} {:.3g}, wi {:.3g} {:.3g} {:.3g}", l.ax,
                     l.ay, l.eta, l.a, wo.x, wo.y, wo.z, wi.x, wi.y, wi.z);
}

bool isNumber(double x) { return x >= 0; }  // which may be infinite
template <class T>
bool areNumbers(Vec3<T> v) {
  return isNumber(double(v.x)) && isNumber(double(v.y)) && isNumber(double(v.z));
}

class Sweep {
 public:
  Sweep(LobeKind kind, const EvaluateInFloat& single) : single_(single) { out_.kind = kind; }

  LobeStability run(int count, uint64_t seed) {
    Stream random(seed, static_cast<uint64_t>(out_.kind));
    for (int i = 0; i < count; ++i) {
      const Lobe l = extremeLobe(out_.kind, random);
      const Vec3f wo = inFloat(direction(random));
      // ends of the unit interval, too
      constexpr double kEnds[] = {0, 0x1p-24, 0.5, 1 - 0x1p-24};
      Vec2<double> u = random.square();
      if (i % 7 == 0) u = {kEnds[integer(random, 4)], kEnds[integer(random, 4)]};
      const double side = isGlass(l.kind) ? 0.999 * random.uniform() : 0;
      ++out_.lobes;
      if (needsDouble(l, wo.z)) {
        ++out_.inDouble;
        drawAndJudge(l, inDouble(wo), u, side, random);
      } else {
        compare(l, drawAndJudge(l, wo, {static_cast<float>(u.x), static_cast<float>(u.y)}, float(side), random), wo);
      }
    }
    return out_;
  }

 private:
  template <class T>
  Vec3<T> drawAndJudge(const Lobe& l, Vec3<T> wo, Vec2<T> u, T side, Stream& random) {
    const Vec3<T> drawn = sample(l, wo, u, side);
    if (!isFinite(drawn) || std::abs(double(length(drawn)) - 1) > 1e-4) note(l, drawn, wo);
    const Vec3<T> brings = weight(l, drawn, wo);
    if (!isFinite(brings) || !areNumbers(brings)) note(l, drawn, wo);
    out_.weight = std::max(out_.weight, double(std::max({brings.x, brings.y, brings.z})));
    const Vec3f above = inFloat(direction(random)), below = -inFloat(direction(random));
    for (const Vec3<T> wi : {drawn, as<T>(above), as<T>(below)}) {
      const LobeValue<T> v = valueOf(l, wi, wo);
      const bool good = areNumbers(v.fCos) && isNumber(double(v.pdf));
      if (!good || std::isnan(logPdf(l, wi, wo))) note(l, wi, wo);
      out_.overflow += good && (std::isinf(v.pdf) || !isFinite(v.fCos));
    }
    return drawn;
  }
  template <class T>
  void note(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
    if (out_.bad++ == 0) out_.worst = described(l, as<float>(wi), as<float>(wo));
  }
  LobeValue<float> valueOf(const Lobe& l, Vec3f wi, Vec3f wo) const { return single_(l, wi, wo); }
  LobeValue<double> valueOf(const Lobe& l, Vec3<double> wi, Vec3<double> wo) const { return evaluate(l, wi, wo); }
  void compare(const Lobe& l, Vec3f wi, Vec3f wo) {
    if (isDelta(l.kind) || !leaves(l, wi.z > 0)) return;
    // strays are told by how directions differ that are nearly opposite
    if (l.kind == LobeKind::kAshikhminShirley && dot(wi, wo) < -0.86f) return;
    const LobeValue<float> f = single_(l, wi, wo);
    const LobeValue<double> d = evaluate(l, inDouble(wi), inDouble(wo));
    if (!(d.pdf > 1e-30) || !(d.pdf < 1e30) || !(d.fCos.z > 1e-30)) return;
    ++out_.compared;
    const double exponent = 1 + std::abs(logPdf(l, inDouble(wi), inDouble(wo)));
    const bool refracts = isOfGgx(l.kind) || l.kind == LobeKind::kBeckmannRefraction || isGlass(l.kind);
    double rounded = l.kind == LobeKind::kPhong ? threshold::kPhong * double(l.a) : 0;
    double roundedValue = rounded;
    if (refracts) {
      // what facets refract at their edge, next to nothing of it, and an index next to 1, float does not tell from none
      if (std::abs(l.eta - 1) < 1e-3f) return;
      const Vec3<double> i = as<double>(wi), o = as<double>(wo);
      const Vec3<double> h = wi.z > 0 ? i + o : refractionHalf(i, o, double(l.eta));
      const double edge = std::min({std::abs(dot(h, i)), std::abs(dot(h, o)), std::abs(h.z)}) / length(h);
      const double passes = wi.z > 0 ? 1 : transmittance(l, detail::refractedCosine(l, i, o)).z;
      const double total = etaSquaredMinus1(double(l.eta)) + square(dot(h, o)) / dot(h, h);  // reflection, below 0
      if (!(edge > 1e-3 && passes > 1e-3 && std::abs(total) > 1e-4)) return;
      rounded = threshold::kRefraction / std::min({double(l.ax), double(l.ay), edge});
      roundedValue = rounded + threshold::kRefraction / passes;
    }
    const double pdf = std::abs(double(f.pdf) / d.pdf - 1) / exponent / (threshold::kLobePdf + rounded);
    const double value = std::abs(double(f.fCos.z) / d.fCos.z - 1) / exponent / (threshold::kLobeValue + roundedValue);
    if (out_.bad == 0 && !(std::max(pdf, value) <= std::max(out_.pdf, out_.value))) out_.worst = described(l, wi, wo);
    out_.pdf = std::max(out_.pdf, pdf), out_.value = std::max(out_.value, value);
  }

  const EvaluateInFloat& single_;
  LobeStability out_;
};

}  // namespace

std::vector<LobeStability> runLobeStability(const LobeStabilitySettings& settings, const EvaluateInFloat& single) {
  std::vector<LobeStability> all(kLobeKinds);
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  arena.execute([&] {
    tbb::parallel_for(0, kLobeKinds, [&](int k) {
      const int count = kLobesOfAKind * (settings.thorough ? 10 : 1);
      all[static_cast<size_t>(k)] = Sweep(static_cast<LobeKind>(k), single).run(count, settings.seed);
    });
  });
  return all;
}

std::string_view name(LobeKind kind) {
  constexpr std::string_view kNames[kLobeKinds] = {
      "lambert",           "oren-nayar", "burley",         "translucent", "rough-translucent", "ward",
      "ward-dur",          "ward-gmd",   "phong",          "ggx",         "beckmann",          "ashikhmin-shirley",
      "clearcoat",         "velvet",     "schlick-sheen",  "fibres",      "ggx-refraction",    "beckmann-refraction",
      "thin-transmission", "ggx-glass",  "beckmann-glass", "mirror",      "sharp-refraction",  "transparent"};
  return kNames[static_cast<int>(kind)];
}

std::string lobeStabilityTable(const std::vector<LobeStability>& all) {
  constexpr const char* kLine = "{:<21}{:>8}{:>11}{:>5}{:>10}{:>10}{:>9}{:>9}{:>16}  {:<6}{}\n";
  std::string out = "all lobes, at random extremes\n" + fmt::format(fmt::runtime(kLine), "lobe", "lobes", "in double",
                                                                    "bad", "overflow", "compared", "pdf", "f cos",
                                                                    "largest weight", "", "the worst");
  for (const LobeStability& l : all) {
    const auto share = [&](double x) { return l.compared > 0 ? fmt::format("{:.2g}", x) : std::string("-"); };
    out +=
        fmt::format(fmt::runtime(kLine), name(l.kind), l.lobes, l.inDouble, l.bad, l.overflow, l.compared, share(l.pdf),
                    share(l.value), fmt::format("{:.3g}", l.weight), l.pass() ? "pass" : "FAIL", l.worst);
  }
  const auto failed = std::ranges::count_if(all, [](const LobeStability& l) { return !l.pass(); });
  return out + fmt::format("{}: {} of {} lobes pass; errors of float are shares of their limits\n",
                           failed == 0 ? "PASS" : "FAIL", static_cast<int64_t>(all.size()) - failed, all.size());
}

nlohmann::json lobeStabilityJson(const std::vector<LobeStability>& all) {
  const auto number = [](double x) { return std::isfinite(x) ? nlohmann::json(x) : nlohmann::json(); };
  nlohmann::json list = nlohmann::json::array();
  for (const LobeStability& l : all)
    list.push_back({{"lobe", name(l.kind)},
                    {"pass", l.pass()},
                    {"lobes", l.lobes},
                    {"bad", l.bad},
                    {"overflow", l.overflow},
                    {"in_double", l.inDouble},
                    {"compared", l.compared},
                    {"pdf_error_over_limit", number(l.pdf)},
                    {"value_error_over_limit", number(l.value)},
                    {"largest_weight", number(l.weight)},
                    {"worst", l.worst}});
  return list;
}

}  // namespace wardmis
