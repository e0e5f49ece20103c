// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/eval.h"

#include <charconv>
#include <span>

#include "bsdf/phong.h"
#include "bsdf/ward.h"
#include "math/error.h"
#include "study/line_filter.h"

namespace wardmis {

namespace {

template <class T>
struct Values {
  T f, pdf, logPdf, weight;
};

// The specular lobe, rho_s = 1, of directions that are both above.
template <class T>
Values<T> lobe(const StudyInput& s, Vec3<T> wi, Vec3<T> wo) {
  if (!s.ward()) {
    const T m = T(s.m), cosGamma = phongCosGamma(wi, wo);
    const PhongValue<T> v = phongEvaluate(cosGamma, m);
    return {v.f, v.pdf, phongLogPdf(cosGamma, m), phongWeight(cosGamma, wi.z, m)};
  }
  const WardVariant variant = s.brdf == StudyBrdf::kWard      ? WardVariant::kWard
                              : s.brdf == StudyBrdf::kWardDur ? WardVariant::kWardDur
                                                              : WardVariant::kWardGmd;
  const T invAx = T(1) / T(s.alphaX), invAy = T(1) / T(s.alphaY);
  const T pdf = wardEvaluate(variant, wi, wo, invAx, invAy).pdf;
  return {wardF(variant, wi, wo, invAx, invAy), pdf, wardLogPdf(wi, wo, invAx, invAy), wardWeight(variant, wi, wo)};
}

template <class T>
Values<T> evaluate(const StudyInput& s, Vec3<T> wi, Vec3<T> wo) {
  if (!(wi.z > T(0)) || !(wo.z > T(0))) return {T(0), T(0), -std::numeric_limits<T>::infinity(), T(0)};
  Values<T> v = lobe(s, wi, wo);
  v.f *= T(s.rhoS), v.weight *= T(s.rhoS);
  if (s.rhoD > 0) {
    const T diffuse = T(s.rhoD) / kPi<T>;
    v.f += diffuse;
    v.weight += diffuse * wi.z * std::exp(-v.logPdf);
  }
  return v;
}

template <class T>
Vec3<T> sample(const StudyInput& s, Vec3<T> wo, Vec2<T> u) {
  return s.ward() ? wardSample(wo, T(s.alphaX), T(s.alphaY), u) : phongSample(wo, T(s.m), u);
}

// For a message: short, and of characters that every terminal knows.
std::string shown(std::string_view word) {
  std::string s(word.substr(0, 40));
  for (char& c : s)
    if (c < ' ' || c > '~') c = '?';
  return s;
}

// The numbers of a line into `numbers`, by their names; false if there are none. '#' begins a comment.
bool parse(std::string_view line, uint64_t number, std::string_view names, std::span<double> numbers) {
  const auto refuse = [&](const std::string& what) {
    throw Error(ExitCode::kUsage, fmt::format("line {}: {}", number, what), fmt::format("a line is '{}'", names));
  };
  constexpr std::string_view kBlank = " \t\r\v\f";
  line = line.substr(0, line.find('#'));
  size_t found = 0;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
    if (line.empty()) break;
    const std::string_view word = line.substr(0, line.find_first_of(kBlank));
    line.remove_prefix(word.size());
    double value = 0;
    const bool plus = word.size() > 1 && word[0] == '+' && word[1] != '-';  // which from_chars does not know
    const auto [end, error] = std::from_chars(word.data() + (plus ? 1 : 0), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      refuse(fmt::format("'{}' is no finite number that a double can hold", shown(word)));
    if (found < numbers.size()) numbers[found] = value;
    ++found;
  }
  if (found != 0 && found != numbers.size()) refuse(fmt::format("{} numbers, not {}", found, numbers.size()));
  return found != 0;
}

// A float is printed as the double that it is, so that 17 digits tell it from its neighbours.
template <class T>
using Printed = std::conditional_t<std::is_same_v<T, float>, double, T>;

template <class T>
void print(fmt::memory_buffer& out, T value) {
  fmt::format_to(std::back_inserter(out), "{:.17g}", Printed<T>(value));
}
template <class T>
void printJson(fmt::memory_buffer& out, std::string_view before, T value) {
  out.append(before);
  if (std::isfinite(value))
    print(out, value);
  else
    out.append(std::string_view("null"));
}

template <class T>
void write(fmt::memory_buffer& out, const EvalSettings& settings, Vec3<T> wi, const Values<T>& v) {
  if (settings.json) {
    if (settings.sample) {
      printJson(out, "{\"wi\":[", wi.x), printJson(out, ",", wi.y), printJson(out, ",", wi.z);
      printJson(out, "],\"f\":", v.f);
    } else {
      printJson(out, "{\"f\":", v.f);
    }
    printJson(out, ",\"pdf\":", v.pdf), printJson(out, ",\"log_pdf\":", v.logPdf);
    printJson(out, ",\"weight\":", v.weight);
    out.append(std::string_view("}\n"));
    return;
  }
  const auto next = [&](T value, char after) { print(out, value), out.push_back(after); };
  if (settings.sample) next(wi.x, ' '), next(wi.y, ' '), next(wi.z, ' ');
  next(v.f, ' '), next(v.pdf, ' '), next(v.logPdf, ' '), next(v.weight, '\n');
}

template <class T>
void evalLinesIn(const EvalSettings& settings, int in, int out) {
  const StudyInput& s = settings.surface;
  const std::string_view names = settings.sample ? "u1 u2 wo.x wo.y wo.z" : "wi.x wi.y wi.z wo.x wo.y wo.z";
  const size_t given = settings.sample ? 2 : 3;  // before wo
  double numbers[6];
  filterLines(in, out, [&](std::string_view line, uint64_t number, fmt::memory_buffer& output) {
    if (!parse(line, number, names, {numbers, given + 3})) return;
    const auto refuse = [&](std::string_view what, std::string_view hint) {
      throw Error(ExitCode::kUsage, fmt::format("line {}: {}", number, what), std::string(hint));
    };
    const auto vector = [&](const double* d) { return Vec3<T>{T(d[0]), T(d[1]), T(d[2])}; };
    const Vec3<T> wo = vector(numbers + given);
    Vec3<T> wi;
    if (settings.sample) {
      for (int i = 0; i < 2; ++i)
        if (!(numbers[i] >= 0 && numbers[i] < 1))
          refuse(fmt::format("u{} is {}", i + 1, numbers[i]), "give a number from 0 to 1, 1 itself left out");
      const T below1 = 1 - std::numeric_limits<T>::epsilon() / 2;  // where rounding gives 1
      wi = sample(s, wo, {std::min(T(numbers[0]), below1), std::min(T(numbers[1]), below1)});
    } else {
      wi = vector(numbers);
    }
    if (!isFinite(wi) || !isFinite(wo)) refuse("a direction beyond the range of the precision", "give unit vectors");
    const Values<T> values = evaluate(s, wi, wo);
    if (std::isnan(values.f) || std::isnan(values.pdf) || std::isnan(values.logPdf) || std::isnan(values.weight))
      refuse("directions so long that the arithmetic overflows", "give unit vectors");
    write(output, settings, wi, values);
  });
}

}  // namespace

void evalLines(const EvalSettings& settings, int in, int out) {
  switch (settings.precision) {
    case Precision::kFloat:
      return evalLinesIn<float>(settings, in, out);
    case Precision::kDouble:
      return evalLinesIn<double>(settings, in, out);
    case Precision::kLongDouble:
      return evalLinesIn<long double>(settings, in, out);
  }
}

}  // namespace wardmis
