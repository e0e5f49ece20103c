// SPDX-License-Identifier: GPL-3.0-or-later
#include "pattern/voronoi.h"

#include <algorithm>

#include "pattern/cells.h"

namespace wardmis::pattern {
namespace {

using Feature = VoronoiFeature;
using Metric = VoronoiMetric;

// The node's inputs within their ranges, and what follows from them.
struct Parameters {
  Version version;
  Feature feature;
  Metric metric;
  bool normalize;
  float detail, roughness, lacunarity, smoothness, exponent, randomness;

  // No distance is larger: what a search begins with.
  float farthest() const { return version == Version::kBlender3 ? 8 : std::numeric_limits<float>::max(); }
  // That of the cell's farthest corner, where points are on average as far as they can be.
  float reach() const { return 0.5f + 0.5f * randomness; }
};

// The metric's norm of a.
template <int D>
float norm(const Parameters& s, const Point<D>& a) {
  if constexpr (D == 1) return std::abs(a[0]);
  float r = 0;
  switch (s.metric) {
    case Metric::kEuclidean:
      return std::sqrt(dot(a, a));
    case Metric::kManhattan:
      for (float x : a.v) r += std::abs(x);
      return r;
    case Metric::kChebychev:
      for (float x : a.v) r = std::max(r, std::abs(x));
      return r;
    case Metric::kMinkowski:
      for (float x : a.v) r += std::pow(std::abs(x), s.exponent);
      return std::pow(r, 1 / s.exponent);
  }
  return r;
}

template <size_t D, size_t Count>
using Points = std::array<std::array<float, Count>, D>;

// f(way from `from` to the point) of each point.
template <int D, size_t Count, class F>
std::array<float, Count> ofEach(const Points<D, Count>& points, const Point<D>& from, F f) {
  std::array<float, Count> r;
  for (size_t n = 0; n < Count; n++) r[n] = f(nth<D>(points, static_cast<int>(n)) - from);
  return r;
}
template <int D, size_t Count>
std::array<float, Count> squares(const Points<D, Count>& points, const Point<D>& from) {
  return ofEach<D>(points, from, [](const Point<D>& way) { return dot(way, way); });
}
template <int D, size_t Count>
std::array<float, Count> distances(const Parameters& s, const Points<D, Count>& points, const Point<D>& from) {
  if (s.metric != Metric::kEuclidean) return ofEach<D>(points, from, [&](const Point<D>& way) { return norm(s, way); });
  return ofEach<D>(points, from,
                   [](const Point<D>& way) { return D == 1 ? std::abs(way[0]) : std::sqrt(dot(way, way)); });
}
// The first of the least numbers below `bound`; -1 for none.
template <size_t Count>
int least(const std::array<float, Count>& numbers, float bound) {
  int best = -1;
  for (size_t n = 0; n < Count; n++) {
    if (numbers[n] < bound) {
      bound = numbers[n];
      best = static_cast<int>(n);
    }
  }
  return best;
}

// A point, and all that is said of it: what an octave gives.
template <int D>
struct Octave {
  float distance = 0;
  Rgb color;
  Point<D> position;
};

// Where no distance is below the farthest (powers leave the floats, p is not a number), the point is the cell's corner.
template <int D>
Octave<D> f1(const Parameters& s, const Point<D>& p) {
  const Cells<D> cells(s.version, s.randomness, p);
  const auto points = cells.template points<1>();
  // From Blender 5 on what is compared is Minkowski's sum, without its root.
  const bool later = D > 1 && s.version == Version::kBlender5;
  const auto d = later && s.metric == Metric::kMinkowski ? ofEach<D>(points, cells.local(),
                                                                     [&s](const Point<D>& way) {
                                                                       float sum = 0;
                                                                       for (float x : way.v)
                                                                         sum += std::pow(std::abs(x), s.exponent);
                                                                       return sum;
                                                                     })
                                                         : distances<D>(s, points, cells.local());
  const int n = least(d, s.farthest());
  const Point<D> point = n < 0 ? Point<D>{} : nth<D>(points, n);
  const float distance = later ? norm(s, point - cells.local()) : n < 0 ? s.farthest() : d[n];
  return {distance, cells.color(n < 0 ? Offset<D>{} : Neighbours<D, 1>::offset(n)), point + cells.corner()};
}

template <int D>
Octave<D> f2(const Parameters& s, const Point<D>& p) {
  const Cells<D> cells(s.version, s.randomness, p);
  const auto points = cells.template points<1>();
  const auto d = distances<D>(s, points, cells.local());
  int first = -1, second = -1;
  float firstDistance = s.farthest(), secondDistance = firstDistance;
  for (int n = 0; n < static_cast<int>(d.size()); n++) {
    if (d[n] < firstDistance) {
      secondDistance = firstDistance;
      second = first;
      firstDistance = d[n];
      first = n;
    } else if (d[n] < secondDistance) {
      secondDistance = d[n];
      second = n;
    }
  }
  const Offset<D> offset = second < 0 ? Offset<D>{} : Neighbours<D, 1>::offset(second);
  const Point<D> point = second < 0 ? Point<D>{} : nth<D>(points, second);
  return {secondDistance, cells.color(offset), point + cells.corner()};
}

// Distance, colour and place of the nearest point by a smooth minimum, cell after cell.
template <int D>
Octave<D> smoothF1(const Parameters& s, const Point<D>& p) {
  const Cells<D> cells(s.version, s.randomness, p);
  const auto points = cells.template points<2>();
  const auto d = distances<D>(s, points, cells.local());
  Octave<D> r;
  const bool start = s.version == Version::kBlender3;
  if (start) r.distance = s.farthest();
  for (int n = 0; n < static_cast<int>(d.size()); n++) {
    const float h = n == 0 && !start ? 1 : smoothstep(0.5f + 0.5f * (r.distance - d[n]) / s.smoothness);
    if (h == 0) continue;
    const float sag = s.smoothness * h * (1 - h), other = sag / (1 + 3 * s.smoothness);
    r.distance = lerp(r.distance, d[n], h) - sag;
    r.color = lerp(r.color, cells.color(Neighbours<D, 2>::offset(n)), h) - Rgb{other, other, other};
    r.position = lerp(r.position, nth<D>(points, n), h) + -other;
  }
  r.position = r.position + cells.corner();
  return r;
}

template <int D>
Octave<D> octaveOf(const Parameters& s, const Point<D>& p) {
  if (s.feature == Feature::kF2) return f2(s, p);
  const bool smooth = s.feature == Feature::kSmoothF1 && (s.smoothness != 0 || s.version == Version::kBlender3);
  return smooth ? smoothF1(s, p) : f1(s, p);
}

float distanceToEdge(const Parameters& s, const Point<1>& p) {
  const Cells<1> cells(s.version, s.randomness, p);
  const std::array<float, 3> x = cells.points<1>()[0];
  const auto to = [&](int n) { return std::abs((x[1] + x[n]) / 2 - cells.local()[0]); };
  return std::min(to(0), to(2));
}
// To the nearest plane between the nearest point and another (Quilez, "Voronoi edges", 2012).
template <int D>
float distanceToEdge(const Parameters& s, const Point<D>& p) {
  const Cells<D> cells(s.version, s.randomness, p);
  const auto points = cells.template points<1>();
  const int n = least(squares<D>(points, cells.local()), s.farthest());
  const Point<D> nearest = n < 0 ? Point<D>{} : nth<D>(points, n) - cells.local();
  const auto toPlane = ofEach<D>(points, cells.local(), [&](const Point<D>& way) {
    const Point<D> across = way - nearest;
    const float d2 = dot(across, across), plane = dot((nearest + way) / 2, across / std::sqrt(d2));
    return d2 > 0.0001f ? plane : std::numeric_limits<float>::max();
  });
  float r = s.farthest();
  for (float d : toPlane) r = std::min(r, d);
  return r;
}

// Half the way from the nearest point to the one nearest to that.
template <int D>
float nSphereRadius(const Parameters& s, const Point<D>& p) {
  const Cells<D> cells(s.version, s.randomness, p);
  const auto points = cells.template points<1>();
  const int n = least(squares<D>(points, cells.local()), s.farthest());
  const Point<D> center = n < 0 ? Point<D>{} : nth<D>(points, n);
  const auto around = cells.template points<1>(n < 0 ? Offset<D>{} : Neighbours<D, 1>::offset(n));
  auto d2 = squares<D>(around, center);
  d2[d2.size() / 2] = std::numeric_limits<float>::max();  // the point itself
  const int m = least(d2, s.farthest());
  const Point<D> way = (m < 0 ? Point<D>{} : nth<D>(around, m)) - center;
  return std::sqrt(dot(way, way)) / 2;
}

// f(scale, amplitude, weight) for each octave: amplitude 1 and weight 1 for the first, the last octave's weight is what
// is left of `detail`. Without detail it is called once.
template <class F>
void forEachOctave(const Parameters& s, F f) {
  const bool single = s.detail == 0 || s.roughness == 0;
  const int whole = toInt(s.detail);
  const float rest = s.detail - std::floor(s.detail);
  float scale = 1, amplitude = 1;
  for (int i = 0; i <= (single ? 0 : whole); i++) {
    f(scale, amplitude, 1.0f);
    scale *= s.lacunarity;
    amplitude *= s.roughness;
  }
  if (!single && rest != 0) f(scale, amplitude, rest);
}

template <int D>
Octave<D> fractalPoint(const Parameters& s, const Point<D>& p) {
  Octave<D> sum;
  float total = 0;
  forEachOctave(s, [&](float scale, float amplitude, float weight) {
    const Octave<D> o = octaveOf(s, p * scale);
    total += amplitude * weight;
    sum.distance += o.distance * amplitude * weight;
    sum.color += o.color * (amplitude * weight);
    sum.position = lerp(sum.position, lerp(sum.position, o.position / scale, amplitude), weight);
  });
  if (s.normalize) {
    const float largest = norm(s, Point<D>{} + s.reach()) * (s.feature == Feature::kF2 ? 2 : 1);
    sum.distance /= total * largest;
    sum.color *= 1 / total;
  }
  return sum;
}

template <int D>
float fractalDistanceToEdge(const Parameters& s, const Point<D>& p) {
  float least = 8, largest = s.reach();
  forEachOctave(s, [&](float scale, float amplitude, float weight) {
    const float d = distanceToEdge(s, p * scale);
    // A single octave is taken as it is; the others by way of minima with those before.
    if (s.detail == 0 || s.roughness == 0) {
      least = d;
      return;
    }
    const float mixed = lerp(least, std::min(least, d / scale), amplitude);
    least = weight == 1 ? mixed : lerp(least, std::min(least, mixed), weight);
    largest = lerp(largest, lerp(largest, s.reach() / scale, amplitude), weight);
  });
  return s.normalize ? least / largest : least;
}

// What is not a dimension of the node is 0.
template <int D>
void setPosition(VoronoiValue& r, const Point<D>& p) {
  if constexpr (D == 1) {
    r.w = p[0];
  } else {
    r.position.x = p[0];
    r.position.y = p[1];
    if constexpr (D > 2) r.position.z = p[2];
    if constexpr (D > 3) r.w = p[3];
  }
}

}  // namespace

VoronoiValue voronoi(const VoronoiSettings& settings, const VoronoiInputs& in, Vec3f p, float w) {
  const bool plain = settings.version == Version::kBlender3;
  const Parameters s{.version = settings.version,
                     .feature = settings.feature,
                     .metric = settings.metric,
                     .normalize = settings.normalize && !plain,
                     .detail = plain ? 0 : limit(in.detail, 0, 15),
                     .roughness = limit(in.roughness, 0, 1),
                     .lacunarity = in.lacunarity,
                     .smoothness = limit(in.smoothness / 2, 0, 0.5f),
                     .exponent = in.exponent,
                     .randomness = limit(in.randomness, 0, 1)};
  return atDimensions(settings.dimensions, p * in.scale, w * in.scale, [&]<int D>(const Point<D>& at) {
    VoronoiValue r;
    if (s.feature == Feature::kDistanceToEdge) {
      r.distance = fractalDistanceToEdge(s, at);
    } else if (s.feature == Feature::kNSphereRadius) {
      r.radius = nSphereRadius(s, at);
    } else {
      const Octave<D> o = fractalPoint(s, at);
      r.distance = o.distance;
      r.color = o.color;
      setPosition(r, in.scale != 0 ? o.position / in.scale : Point<D>{});
    }
    return r;
  });
}

}  // namespace wardmis::pattern
