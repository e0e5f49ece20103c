// SPDX-License-Identifier: GPL-3.0-or-later
// The closed set of lobes that surfaces are made of: a lobe as plain data, and what can be asked of it, over any number
// type. Local frame of the lobe, z its normal; wo above it. Densities per solid angle of wi.
//   evaluate(lobe, wi, wo)   f cos(theta_i) with the lobe's weight and colour, and the density of sample()
//   sample(lobe, wo, u, v)   a direction; where evaluate() is zero there, its contribution is zero, and it counts.
//                            v: of glass alone, chooses between what a facet reflects and what it lets pass
// In Cycles samples of a lobe do not always bring what its samples of lights find, nor have the density that it takes
// them to have. That is part of what it shows:
//   sampleDensities(lobe, wi, wo, pdf)   of its samples but strays, and what it counts; pdf: of evaluate()
//   strays(lobe, wi, wo)     what they bring besides, of facets by which evaluate() has nothing
//   unseen(lobe, wi, wo)     what samples of lights alone bring besides
//   logPdf(lobe, wi, wo)     ln of the density, also where that underflows
//   weight(lobe, wi, wo)     what a sample brings of the lobe itself, f cos / pdf as it counts it, without cancellation
//   isDelta(kind)            one direction alone: evaluate() is zero, weight() is f cos / pdf as ever
//   reflects(kind), transmits(kind)   wi lies above the surface, below it; of glass both
#pragma once

#include <string_view>

#include "bsdf/ashikhmin.h"
#include "bsdf/dielectric.h"
#include "bsdf/oren_nayar.h"
#include "bsdf/phong.h"
#include "bsdf/sheen.h"
#include "bsdf/ward.h"

namespace wardmis {

enum class LobeKind : uint8_t {
  kLambert,
  kOrenNayar,  // a, b, and in f0 the multiple of its light that is reflected more than once
  kBurley,     // a: roughness
  kTranslucent,
  kRoughTranslucent,  // Oren-Nayar, mirrored to below
  kWard,              // ax, ay
  kWardDur,
  kWardGmd,
  kPhong,  // a: exponent m
  kGgx,    // ax, ay, masking; facets by fresnel
  kBeckmann,
  kAshikhminShirley,  // ax, ay
  kClearcoat,         // ax
  kVelvet,            // a: sigma
  kSchlickSheen,
  kFibres,         // a, b: scale and skew
  kGgxRefraction,  // as kGgx; facets let pass what fresnel does not reflect
  kBeckmannRefraction,
  kThinTransmission,  // kGgx, mirrored to below
  kGgxGlass,          // both: facets reflect by fresnel and let pass the rest, tinted by `through` in place of weight
  kBeckmannGlass,
  kMirror,  // facets by fresnel
  kSharpRefraction,
  kTransparent,
};
inline constexpr int kLobeKinds = 24;

// Reflectance of a facet at a cosine.
enum class Fresnel : uint8_t {
  kNone,        // 1; and of refraction nothing, except in total internal reflection
  kDielectric,  // eta's own
  kBlended,     // f0 at normal incidence, white at grazing, in between as eta's own goes, but never less than f0
  kTinted,      // eta's own, times f0 at normal incidence and white at grazing
  kF82,         // f0, edge (dielectric.h)
};

// The reflectance that passes of colours show of facets that blend to white or have an edge's colour.
enum class PassColor : uint8_t {
  kMean,           // the mean over the facets that a view sees, by table; the rest passes (5.2)
  kMeanReflected,  // the same, but by a facet along the normal what passes (4.3)
  kPale,           // reflects all, or of glass transmits all (3.4)
};

struct Lobe {
  LobeKind kind = LobeKind::kLambert;
  Fresnel fresnel = Fresnel::kNone;
  Masking masking = Masking::kCorrelated;
  uint8_t frame = 0;          // which normal and tangent, for whoever has several
  bool unseenFacets = false;  // has what unseen() tells
  bool refractsUp = false;    // samples go where facets refract to above the mean surface, too: strays()
  bool byFirstAxis = false;   // facets are drawn as if both axes had the first one's roughness
  bool defended = false;      // glass: neither side is drawn less often than once in nine times
  PassColor passColor = PassColor::kMean;
  Rgb weight{1, 1, 1}, through{1, 1, 1};
  Rgb compensation{1, 1, 1};  // what both hold for light reflected more than once, and colours of passes do not
  float closure = -1;         // mean weight of the closure in Cycles that it is of, for passes; below 0: its own
  float ax = 1, ay = 1;
  float eta = 1;  // of the side below over that above
  Rgb f0{1, 1, 1}, edge{0, 0, 0};
  float a = 0, b = 0;
};

constexpr LobeKind wardKind(WardVariant v) {
  return static_cast<LobeKind>(static_cast<int>(LobeKind::kWard) + static_cast<int>(v));
}
constexpr WardVariant wardVariant(LobeKind k) {
  return static_cast<WardVariant>(static_cast<int>(k) - static_cast<int>(LobeKind::kWard));
}

template <class T>
struct LobeValue {
  Vec3<T> fCos;  // sr^-1, of the three channels
  T pdf;         // sr^-1
};

constexpr bool isDelta(LobeKind kind) { return kind >= LobeKind::kMirror; }
constexpr bool isOfGgx(LobeKind kind) { return kind == LobeKind::kGgxRefraction || kind == LobeKind::kGgxGlass; }
constexpr bool isOfBeckmann(LobeKind kind) {
  return kind == LobeKind::kBeckmann || kind == LobeKind::kBeckmannRefraction || kind == LobeKind::kBeckmannGlass;
}
constexpr bool isGlass(LobeKind kind) { return kind == LobeKind::kGgxGlass || kind == LobeKind::kBeckmannGlass; }
constexpr bool transmits(LobeKind kind) {
  return kind == LobeKind::kTranslucent || kind == LobeKind::kRoughTranslucent ||
         (kind >= LobeKind::kGgxRefraction && kind != LobeKind::kMirror);
}
constexpr bool reflects(LobeKind kind) { return !transmits(kind) || isGlass(kind); }
// Whether any light leaves above the mean surface, or below.
constexpr bool leaves(const Lobe& l, bool above) {
  return above ? reflects(l.kind) || l.refractsUp : transmits(l.kind);
}
// Whether its rays are diffuse ones to Cycles; others are glossy.
constexpr bool isMatte(LobeKind k) {
  return k <= LobeKind::kRoughTranslucent || (k >= LobeKind::kVelvet && k <= LobeKind::kFibres);
}

// Whether the rounding of float directions would show, so that the renderer draws and evaluates it in double.
inline bool needsDouble(const Lobe& l, float cosThetaO) {
  const LobeKind k = l.kind;
  const bool smooth = k <= LobeKind::kRoughTranslucent || k == LobeKind::kVelvet || k == LobeKind::kSchlickSheen;
  if (isDelta(k) || smooth || k == LobeKind::kPhong || k == LobeKind::kFibres) return false;
  const float narrow = std::min(l.ax, l.ay), wide = std::max(l.ax, l.ay);
  return narrow * std::min(narrow, cosThetaO) < 4e-6f * (1 + wide * wide);
}

// What techniques are called by.
enum class LobeClass : uint8_t { kGlossy, kGlass, kRefraction, kTranslucent, kSheen, kDiffuse };
inline constexpr size_t kLobeClasses = 6;
constexpr std::string_view name(LobeClass c) {
  constexpr std::string_view names[] = {"glossy", "glass", "refraction", "translucent", "sheen", "diffuse"};
  return names[static_cast<size_t>(c)];
}
constexpr LobeClass classOf(LobeKind k) {
  if (isGlass(k)) return LobeClass::kGlass;
  if (transmits(k)) return isMatte(k) ? LobeClass::kTranslucent : LobeClass::kRefraction;
  if (k == LobeKind::kFibres) return LobeClass::kSheen;
  return isMatte(k) ? LobeClass::kDiffuse : LobeClass::kGlossy;
}

template <class T>
constexpr Vec3<T> rgb(Rgb c) {
  return {T(c.x), T(c.y), T(c.z)};
}
template <class T>
constexpr Vec3<T> flipped(Vec3<T> w) {
  return {w.x, w.y, -w.z};
}

// Reflectance of a facet, c = wo.m.
template <class T>
inline Vec3<T> reflectance(const Lobe& l, T c) {
  switch (l.fresnel) {
    case Fresnel::kDielectric: {
      const T f = fresnelDielectric(c, T(l.eta));
      return {f, f, f};
    }
    case Fresnel::kBlended:
    case Fresnel::kTinted: {
      const T s = fresnelBlend(c, T(l.eta)),
              own = l.fresnel == Fresnel::kTinted ? fresnelDielectric(c, T(l.eta)) : T(1);
      return (rgb<T>(l.f0) * (T(1) - s) + Vec3<T>{s, s, s}) * own;
    }
    case Fresnel::kF82:
      return {fresnelF82(c, T(l.f0.x), T(l.edge.x)), fresnelF82(c, T(l.f0.y), T(l.edge.y)),
              fresnelF82(c, T(l.f0.z), T(l.edge.z))};
    case Fresnel::kNone:
      break;
  }
  return {T(1), T(1), T(1)};
}
template <class T>
inline Vec3<T> transmittance(const Lobe& l, T c) {
  if (!(etaSquaredMinus1(T(l.eta)) + c * c > T(0))) return {};
  const Vec3<T> all{T(1), T(1), T(1)};
  if (l.fresnel == Fresnel::kTinted) return all * (T(1) - fresnelDielectric(c, T(l.eta)));
  return l.fresnel == Fresnel::kNone ? all : all - reflectance(l, c);
}

namespace detail {

template <class T>
inline Vec3<T> reflectedColor(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  if (l.fresnel == Fresnel::kNone) return rgb<T>(l.weight);
  return rgb<T>(l.weight) * reflectance(l, std::min(T(0.5) * length(wi + wo), T(1)));  // wo.h = |wi + wo|/2
}
// wo.h of what is refracted.
template <class T>
inline T refractedCosine(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  const Vec3<T> h = scaled(refractionHalf(wi, wo, T(l.eta)));
  return std::min(dot(wo, h) / length(h), T(1));
}
template <class T>
inline Vec3<T> refractedColor(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  return rgb<T>(l.weight) * transmittance(l, refractedCosine(l, wi, wo));
}
// What glass does to light at a facet: c = wo.m, reflect: the probability that sample() takes its reflection.
template <class T>
struct GlassFacet {
  Vec3<T> reflected, passed;
  T reflect;

  // What goes to one side, over the probability of that.
  Vec3<T> over(bool above) const {
    const T chosen = above ? reflect : T(1) - reflect;
    return chosen > T(0) ? (above ? reflected : passed) * (T(1) / chosen) : Vec3<T>{};
  }
};
template <class T>
inline GlassFacet<T> glassFacet(const Lobe& l, T c) {
  const auto strength = [](Vec3<T> v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
  GlassFacet<T> f{rgb<T>(l.weight) * reflectance(l, c), rgb<T>(l.through) * transmittance(l, c), T(1)};
  T r = strength(f.reflected), t = strength(f.passed);
  if (l.defended && t > T(0)) {
    const T least = T(0.125) * (r + t);
    r = std::max(r, least), t = std::max(t, least);
  }
  if (t > T(0)) f.reflect = r / (r + t);
  return f;
}
template <class T>
inline GlassFacet<T> glassFacet(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  return glassFacet(l, wi.z > T(0) ? std::min(T(0.5) * length(wi + wo), T(1)) : refractedCosine(l, wi, wo));
}
// What facets let pass, of v, which is for a transmittance of 1.
template <class T>
inline LobeValue<T> passed(const Lobe& l, Vec3<T> wi, Vec3<T> wo, MicrofacetValue<T> v) {
  if (!(v.pdf > T(0))) return {};
  if (!isGlass(l.kind)) return {refractedColor(l, wi, wo) * v.fCos, v.pdf};
  const GlassFacet<T> f = glassFacet(l, refractedCosine(l, wi, wo));
  return {f.passed * v.fCos, v.pdf * (T(1) - f.reflect)};
}
// Of what is let pass; above the mean surface, too, where those are strays.
template <Distribution K, class T>
inline LobeValue<T> passedEvaluate(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  if (!(wi.z < T(0) || (wi.z > T(0) && l.refractsUp))) return {};
  return passed(l, wi, wo, refractionEvaluate<K>(l.masking, wi, wo, T(l.ax), T(l.ay), T(l.eta)));
}
template <class T>
inline LobeValue<T> withoutStrays(LobeValue<T> passed, Vec3<T> wi) {
  return {wi.z < T(0) ? passed.fCos : Vec3<T>{}, passed.pdf};
}
template <Distribution K, class T>
inline LobeValue<T> glassEvaluate(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  LobeValue<T> sum = withoutStrays(passedEvaluate<K>(l, wi, wo), wi);
  if (!(wi.z > T(0))) return sum;
  const MicrofacetValue<T> v = microfacetEvaluate<K>(l.masking, wi, wo, T(l.ax), T(l.ay));
  if (!(v.pdf > T(0))) return sum;
  const GlassFacet<T> f = glassFacet(l, wi, wo);
  sum.fCos += f.reflected * v.fCos, sum.pdf += v.pdf * f.reflect;
  return sum;
}
template <Distribution K, class T>
inline Vec3<T> glassWeight(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  const T ax = T(l.ax), ay = T(l.ay);
  const bool above = wi.z > T(0);
  return glassFacet(l, wi, wo).over(above) *
         (above ? microfacetWeight<K>(l.masking, wi, wo, ax, ay) : refractionWeight<K>(l.masking, wi, wo, ax, ay));
}
// What leaves on the wrong side of the mean surface goes along the horizon, where the lobe is zero.
template <class T>
inline Vec3<T> glassSample(const Lobe& l, Vec3<T> wo, Vec3<T> m, T v) {
  const Vec3<T> lost{T(1), T(0), T(0)};
  const Vec3<T> n = scaled(m);
  const T c = std::min(dot(wo, n) / length(n), T(1));
  Vec3<T> wi = lost;
  if (v < glassFacet(l, c).reflect) {
    wi = mirrored(wo, m);
    return wi.z > T(0) ? wi : lost;
  }
  return refracted(wo, m, T(l.eta), wi) && (wi.z < T(0) || l.refractsUp) ? wi : lost;
}
template <class T>
inline LobeValue<T> colored(Vec3<T> color, MicrofacetValue<T> v) {
  return {color * v.fCos, v.pdf};
}
// f of the diffuse lobes, sampled by the cosine; both directions above.
template <class T>
inline Vec3<T> diffuseF(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  const T lambert = T(1) / kPi<T>;
  switch (l.kind) {
    case LobeKind::kOrenNayar:
    case LobeKind::kRoughTranslucent: {
      const OrenNayar<T> model{T(l.a), T(l.b)};
      const T once = orenNayarF(wi, wo, model.a, model.b), rest = T(1) - model.albedo(wi.z);
      return rgb<T>(l.weight) * (Vec3<T>{once, once, once} + rgb<T>(l.f0) * rest);
    }
    case LobeKind::kBurley:
      return rgb<T>(l.weight) * burleyF(wi, wo, T(l.a));
    case LobeKind::kVelvet:
      return rgb<T>(l.weight) * (velvetFCos(wi, wo, T(l.a)) / wi.z);
    case LobeKind::kSchlickSheen:
      return rgb<T>(l.weight) * (schlickSheenFCos(wi, wo) / wi.z);
    default:
      return rgb<T>(l.weight) * lambert;
  }
}
constexpr bool isDiffuse(LobeKind k) {
  return k <= LobeKind::kRoughTranslucent || k == LobeKind::kVelvet || k == LobeKind::kSchlickSheen;
}
// Of which Cycles does not ask on which side of the normal the view is.
constexpr bool seenFromBelow(LobeKind k) { return k <= LobeKind::kRoughTranslucent || k == LobeKind::kFibres; }
// Lobes that are mirrored to below are asked with wi turned over.
constexpr bool isMirrored(LobeKind k) {
  return k == LobeKind::kTranslucent || k == LobeKind::kRoughTranslucent || k == LobeKind::kThinTransmission;
}

}  // namespace detail

template <class T>
LobeValue<T> evaluate(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  using namespace detail;
  const T ax = T(l.ax), ay = T(l.ay);
  if (isMirrored(l.kind)) wi = flipped(wi);
  if (isDiffuse(l.kind)) {
    if (!(wi.z > T(0)) || (!seenFromBelow(l.kind) && !(wo.z > T(0)))) return {};
    return {diffuseF(l, wi, wo) * wi.z, wi.z * (T(1) / kPi<T>)};
  }
  switch (l.kind) {
    case LobeKind::kWard:
    case LobeKind::kWardDur:
    case LobeKind::kWardGmd: {
      const WardValue<T> v = wardEvaluate(wardVariant(l.kind), wi, wo, T(1) / ax, T(1) / ay);
      return {rgb<T>(l.weight) * v.fCos, v.pdf};
    }
    case LobeKind::kPhong: {
      if (!(wo.z > T(0))) return {};
      const PhongValue<T> v = phongEvaluate(phongCosGamma(wi, wo), T(l.a));
      return {rgb<T>(l.weight) * (v.f * std::max(wi.z, T(0))), v.pdf};
    }
    case LobeKind::kGgx:
      return colored(reflectedColor(l, wi, wo), microfacetEvaluate<Distribution::kGgx>(l.masking, wi, wo, ax, ay));
    case LobeKind::kBeckmann: {
      MicrofacetValue<T> v = microfacetEvaluate<Distribution::kBeckmann>(l.masking, wi, wo, ax, ay);
      if (l.byFirstAxis) v.pdf = microfacetEvaluate<Distribution::kBeckmann>(l.masking, wi, wo, ax, ax).pdf;
      return colored(reflectedColor(l, wi, wo), v);
    }
    case LobeKind::kThinTransmission:
      return colored(rgb<T>(l.weight), microfacetEvaluate<Distribution::kGgx>(l.masking, wi, wo, ax, ay));
    case LobeKind::kGgxRefraction:
      return withoutStrays(passedEvaluate<Distribution::kGgx>(l, wi, wo), wi);
    case LobeKind::kBeckmannRefraction:
      return withoutStrays(passedEvaluate<Distribution::kBeckmann>(l, wi, wo), wi);
    case LobeKind::kGgxGlass:
      return glassEvaluate<Distribution::kGgx>(l, wi, wo);
    case LobeKind::kBeckmannGlass:
      return glassEvaluate<Distribution::kBeckmann>(l, wi, wo);
    case LobeKind::kAshikhminShirley: {
      const T pdf = ashikhminPdf(wi, wo, ax, ay);
      return {rgb<T>(l.weight) * (pdf * ashikhminWeight(wi, wo)), ashikhminSampledPdf(wi, wo, ax, ay)};
    }
    case LobeKind::kClearcoat:
      return {reflectedColor(l, wi, wo) * clearcoatEvaluate(wi, wo, ax).fCos,
              microfacetEvaluate<Distribution::kGgx>(l.masking, wi, wo, ax, ax).pdf};
    case LobeKind::kFibres: {
      const T pdf = fibrePdf(wi, wo, T(l.a), T(l.b));
      return {rgb<T>(l.weight) * pdf, pdf};
    }
    default:
      return {};
  }
}

template <class T>
struct SampleDensities {
  T pdf, counted;
};
template <class T>
SampleDensities<T> sampleDensities(const Lobe& l, Vec3<T> wi, Vec3<T> wo, T pdf) {
  using namespace detail;
  constexpr Distribution kBeckmann = Distribution::kBeckmann;
  const T ax = T(l.ax), ay = T(l.ay);
  if (l.kind == LobeKind::kClearcoat) return {pdf, clearcoatEvaluate(wi, wo, ax).pdf};
  if (l.kind == LobeKind::kAshikhminShirley) return {ashikhminPdf(wi, wo, ax, ay), ashikhminPdf(wi, wo, ax, ay)};
  if (l.refractsUp && wi.z > T(0)) {
    if (!isGlass(l.kind)) return {T(0), T(0)};
    pdf = (isOfGgx(l.kind) ? microfacetEvaluate<Distribution::kGgx>(l.masking, wi, wo, ax, ay)
                           : microfacetEvaluate<kBeckmann>(l.masking, wi, wo, ax, ay))
              .pdf *
          glassFacet(l, wi, wo).reflect;
  }
  if (!isOfBeckmann(l.kind)) return {pdf, pdf};
  const T alike = l.byFirstAxis ? microfacetEvaluate<kBeckmann>(l.masking, wi, wo, ax, ay).pdf : pdf;
  return {pdf, alike / (T(1) + microfacetSurplus<kBeckmann>(wo, ax, ay))};
}

// Whether all of that is as of any lobe: samples of it and of lights bring evaluate(), and count its density.
constexpr bool isPlain(const Lobe& l) {
  return l.kind != LobeKind::kClearcoat && l.kind != LobeKind::kAshikhminShirley && !isOfBeckmann(l.kind) &&
         !l.unseenFacets && !l.refractsUp;
}

// alone: Cycles does not ask the lobe itself what else it has along such a sample.
template <class T>
struct Stray {
  Vec3<T> fCos;
  T pdf, counted;
  bool alone;
};
template <class T, class Add>
void strays(const Lobe& l, Vec3<T> wi, Vec3<T> wo, Add&& add) {
  using namespace detail;
  if (l.kind == LobeKind::kAshikhminShirley) {
    ashikhminStrays(wi, wo, T(l.ax), T(l.ay), [&](T fCos, T pdf, T counted) {
      add(Stray<T>{rgb<T>(l.weight) * fCos, pdf, counted, true});
    });
  } else if (l.refractsUp && wi.z > T(0)) {
    const LobeValue<T> v = isOfGgx(l.kind) ? passedEvaluate<Distribution::kGgx>(l, wi, wo)
                                           : passedEvaluate<Distribution::kBeckmann>(l, wi, wo);
    if (v.pdf > T(0)) add(Stray<T>{v.fCos, v.pdf, v.pdf, false});
  }
}

// What Cycles adds to a lobe that refracts where no facet does: f cos, which its light samples alone find, and the
// density that it counts for it. Lamps that graze rough glass are brighter for it.
template <class T>
LobeValue<T> unseen(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  using namespace detail;
  if (!l.unseenFacets) return {};
  const T ax = T(l.ax), ay = T(l.ay), eta = T(l.eta);
  const MicrofacetValue<T> v = isOfGgx(l.kind)
                                   ? unseenRefraction<Distribution::kGgx>(l.masking, wi, wo, ax, ay, eta)
                                   : unseenRefraction<Distribution::kBeckmann>(l.masking, wi, wo, ax, ay, eta);
  return v.fCos > T(0) ? passed(l, wi, wo, v) : LobeValue<T>{};
}

template <class T>
Vec3<T> sample(const Lobe& l, Vec3<T> wo, Vec2<T> u, T v) {
  const T ax = T(l.ax), ay = T(l.ay);
  switch (l.kind) {
    case LobeKind::kWard:
    case LobeKind::kWardDur:
    case LobeKind::kWardGmd:
      return wardSample(wo, ax, ay, u);
    case LobeKind::kPhong:
      return phongSample(wo, T(l.a), u);
    case LobeKind::kGgx:
      return microfacetSample<Distribution::kGgx>(wo, ax, ay, u);
    case LobeKind::kBeckmann:
      return microfacetSample<Distribution::kBeckmann>(wo, ax, l.byFirstAxis ? ax : ay, u);
    case LobeKind::kThinTransmission:
      return flipped(microfacetSample<Distribution::kGgx>(wo, ax, ay, u));
    case LobeKind::kGgxRefraction:
      return refractionSample<Distribution::kGgx>(wo, ax, ay, T(l.eta), u);
    case LobeKind::kBeckmannRefraction:
      return refractionSample<Distribution::kBeckmann>(wo, ax, ay, T(l.eta), u);
    case LobeKind::kGgxGlass:
      return detail::glassSample(l, wo, sampleNormal<Distribution::kGgx>(wo, ax, ay, u), v);
    case LobeKind::kBeckmannGlass:
      return detail::glassSample(l, wo, sampleNormal<Distribution::kBeckmann>(wo, ax, ay, u), v);
    case LobeKind::kAshikhminShirley:
      return ashikhminSample(wo, ax, ay, u);
    case LobeKind::kClearcoat:
      return microfacetSample<Distribution::kGgx>(wo, ax, ax, u);
    case LobeKind::kFibres:
      return fibreSample(wo, T(l.a), T(l.b), u);
    case LobeKind::kMirror:
      return {-wo.x, -wo.y, wo.z};
    case LobeKind::kSharpRefraction: {
      Vec3<T> wi{-wo.x, -wo.y, wo.z};
      refracted(wo, Vec3<T>{0, 0, 1}, T(l.eta), wi);
      return wi;
    }
    case LobeKind::kTransparent:
      return -wo;
    case LobeKind::kTranslucent:
    case LobeKind::kRoughTranslucent:
      return flipped(toCosineHemisphere(u));
    default:
      return toCosineHemisphere(u);
  }
}

template <class T>
T logPdf(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  const T ax = T(l.ax), ay = T(l.ay);
  switch (l.kind) {
    case LobeKind::kWard:
    case LobeKind::kWardDur:
    case LobeKind::kWardGmd:
      return wardLogPdf(wi, wo, T(1) / ax, T(1) / ay);
    case LobeKind::kPhong:
      return wo.z > T(0) ? phongLogPdf(phongCosGamma(wi, wo), T(l.a)) : -std::numeric_limits<T>::infinity();
    case LobeKind::kGgx:
      return microfacetLogPdf<Distribution::kGgx>(wi, wo, ax, ay);
    case LobeKind::kBeckmann:
      return microfacetLogPdf<Distribution::kBeckmann>(wi, wo, ax, l.byFirstAxis ? ax : ay);
    case LobeKind::kBeckmannRefraction:
      if (!leaves(l, wi.z > T(0))) return -std::numeric_limits<T>::infinity();
      return refractionLogPdf<Distribution::kBeckmann>(wi, wo, ax, ay, T(l.eta));
    case LobeKind::kAshikhminShirley: {
      const T pdf = ashikhminSampledPdf(wi, wo, ax, ay);
      return pdf > std::numeric_limits<T>::min() ? std::log(pdf) : ashikhminLogPdf(wi, wo, ax, ay);
    }
    default:
      return std::log(evaluate(l, wi, wo).pdf);
  }
}

template <class T>
Vec3<T> weight(const Lobe& l, Vec3<T> wi, Vec3<T> wo) {
  using namespace detail;
  const T ax = T(l.ax), ay = T(l.ay);
  const Vec3<T> white = rgb<T>(l.weight);
  if (!(wo.z > T(0)) || !leaves(l, !(wi.z < T(0)))) return {};
  if (l.byFirstAxis || (wi.z > T(0) && (l.kind == LobeKind::kAshikhminShirley || l.refractsUp))) {
    const LobeValue<T> v = evaluate(l, wi, wo);
    if (!(v.pdf > std::numeric_limits<T>::min())) return {};
    const SampleDensities<T> d = sampleDensities(l, wi, wo, v.pdf);
    Vec3<T> sum = d.counted > T(0) ? v.fCos * (d.pdf / d.counted) : Vec3<T>{};
    strays(l, wi, wo, [&](const Stray<T>& stray) { sum += stray.fCos; });
    return sum * (T(1) / v.pdf);
  }
  if (isMirrored(l.kind)) wi = flipped(wi);
  if (isDiffuse(l.kind)) return wi.z > T(0) ? diffuseF(l, wi, wo) * kPi<T> : Vec3<T>{};
  switch (l.kind) {
    case LobeKind::kWard:
    case LobeKind::kWardDur:
    case LobeKind::kWardGmd:
      return white * wardWeight(wardVariant(l.kind), wi, wo);
    case LobeKind::kPhong:
      return white * phongWeight(phongCosGamma(wi, wo), std::max(wi.z, T(0)), T(l.a));
    case LobeKind::kGgx:
      return reflectedColor(l, wi, wo) * microfacetWeight<Distribution::kGgx>(l.masking, wi, wo, ax, ay);
    case LobeKind::kBeckmann:
      return reflectedColor(l, wi, wo) * microfacetWeight<Distribution::kBeckmann>(l.masking, wi, wo, ax, ay);
    case LobeKind::kThinTransmission:
      return white * microfacetWeight<Distribution::kGgx>(l.masking, wi, wo, ax, ay);
    case LobeKind::kGgxRefraction:
      return refractedColor(l, wi, wo) * refractionWeight<Distribution::kGgx>(l.masking, wi, wo, ax, ay);
    case LobeKind::kBeckmannRefraction:
      return refractedColor(l, wi, wo) * refractionWeight<Distribution::kBeckmann>(l.masking, wi, wo, ax, ay);
    case LobeKind::kGgxGlass:
      return glassWeight<Distribution::kGgx>(l, wi, wo);
    case LobeKind::kBeckmannGlass:
      return glassWeight<Distribution::kBeckmann>(l, wi, wo);
    case LobeKind::kClearcoat:
      return reflectedColor(l, wi, wo) * clearcoatWeight(wi);
    case LobeKind::kMirror:
      return white * reflectance(l, wo.z);
    case LobeKind::kSharpRefraction:
      return white * transmittance(l, wo.z);
    default:
      return white;
  }
}

}  // namespace wardmis
