// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/light_tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "math/clones.h"
#include "math/number.h"

namespace wardmis {
namespace {

float sine(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)); }
// cos(max(0, a - b)), of angles in [0, pi].
float cosLess(float cosA, float sinA, float cosB, float sinB) { return cosA > cosB ? 1 : cosA * cosB + sinA * sinB; }
float sinLess(float cosA, float sinA, float cosB, float sinB) { return cosA > cosB ? 0 : sinA * cosB - cosA * sinB; }

constexpr double kBelow1 = 0x1.fffffffffffffp-1;

// Whether one can divide by a sum of importances.
bool isUsable(float sum) { return sum > 0 && sum < std::numeric_limits<float>::max(); }

float component(Vec3f v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// What a group costs to have: its light times how far it is spread over places and directions.
double spread(const LightBounds& b) {
  const Vec3f d = b.upper - b.lower;
  const double area = 2 * (double(d.x) * d.y + double(d.y) * d.z + double(d.z) * d.x);
  const double o = std::acos(std::clamp(double(b.cosO), -1.0, 1.0)),
               e = std::acos(std::clamp(double(b.cosE), -1.0, 1.0));
  const double w = std::min(o + e, kPi<double>);
  const double directions =
      2 * kPi<double> * (1 - std::cos(o)) +
      kPi<double> / 2 * (2 * w * std::sin(o) - std::cos(o - 2 * w) - 2 * o * std::sin(o) + std::cos(o));
  // lights in one place or plane are apart, too, where they look elsewhere
  return double(b.intensity) * (directions + 1e-3) * (area + 1e-6 * double(dot(d, d)) + 1e-30);
}

}  // namespace

namespace {

// LightBounds::importance() without a branch. center, half: of the box; twoSided, distant: 0 or 1; faces: whether n
// is a direction.
[[gnu::always_inline]] inline float importanceOf(Vec3f center, Vec3f half, Vec3f axis, float cosO, float sinO,
                                                 float cosE, float intensity, float twoSided, float distant, Vec3f p,
                                                 Vec3f n, bool faces) {
  // what a surface finds below its horizon by bent normals, and what rounding puts there
  constexpr float kBelow = 0.02f, kLeast = 1e-30f;
  const bool far = distant > 0;
  const Vec3f to = center - p;
  const float r2 = dot(half, half), d2 = dot(to, to), far2 = std::max(std::max(d2, r2), kLeast);
  const float scale = 1 / std::sqrt(std::max(d2, kLeast));
  const Vec3f w{far ? axis.x : to.x * scale, far ? axis.y : to.y * scale, far ? axis.z : to.z * scale};
  // within the box: the whole hemisphere, and beyond
  const bool inside = !(d2 > r2);
  const float sinR = std::sqrt(std::min(1.0f, r2 / far2));
  const float cosR = inside ? -1.0f : sine(sinR), cosB = far ? cosO : cosR, sinB = far ? sinO : sinR;
  // Of what a point is within or beside, the lights nearest to it matter: what of them is far is near on the average.
  // Both factors are the best of those tried (tests/native/world/light_tree_test.cpp).
  const float x = std::max(std::abs(to.x) - half.x, 0.0f), y = std::max(std::abs(to.y) - half.y, 0.0f),
              z = std::max(std::abs(to.z) - half.z, 0.0f);
  const float outside2 = x * x + y * y + z * z;
  const float near = 1 / std::max(std::min(far2, 2 * outside2 + 0.1f * r2), kLeast);
  const float c = -dot(axis, w), cosW = twoSided > 0 ? std::abs(c) : c, sinW = sine(cosW);
  const float cosX = cosLess(cosW, sinW, cosO, sinO), sinX = sinLess(cosW, sinW, cosO, sinO);
  const float cosY = cosLess(cosX, sinX, cosR, sinR);
  const float towards = cosY >= cosE ? std::max(cosY, 1e-3f) : 0.0f, emitted = far || inside ? 1.0f : towards;
  const float cosI = std::min(std::max(dot(n, w), -1.0f), 1.0f);
  const float received = faces ? std::max(cosLess(cosI, sine(cosI), cosB, sinB), kBelow) : 1.0f;
  return intensity * emitted * received * (far ? 1.0f : near);
}

// Of each lane, in the widest vectors of this processor.
WARDMIS_CLONES void importances(const LightLanes& l, Vec3f p, Vec3f n, bool faces, float* __restrict to) {
  for (size_t i = 0; i < l.kLanes; ++i)
    to[i] = importanceOf({l.centerX[i], l.centerY[i], l.centerZ[i]}, {l.halfX[i], l.halfY[i], l.halfZ[i]},
                         {l.axisX[i], l.axisY[i], l.axisZ[i]}, l.cosO[i], l.sinO[i], l.cosE[i], l.intensity[i],
                         l.twoSided[i], l.distant[i], p, n, faces);
}

}  // namespace

float LightBounds::importance(Vec3f p, Vec3f n) const {
  return importanceOf((lower + upper) * 0.5f, (upper - lower) * 0.5f, axis, cosO, sine(cosO), cosE, intensity,
                      twoSided ? 1 : 0, distant ? 1 : 0, p, n, dot(n, n) > 0);
}

void LightLanes::set(size_t i, const LightBounds& b) {
  const Vec3f center = (b.lower + b.upper) * 0.5f, half = (b.upper - b.lower) * 0.5f;
  centerX[i] = center.x, centerY[i] = center.y, centerZ[i] = center.z;
  halfX[i] = half.x, halfY[i] = half.y, halfZ[i] = half.z;
  axisX[i] = b.axis.x, axisY[i] = b.axis.y, axisZ[i] = b.axis.z;
  cosO[i] = b.cosO, sinO[i] = sine(b.cosO), cosE[i] = b.cosE, intensity[i] = b.intensity;
  twoSided[i] = b.twoSided ? 1 : 0, distant[i] = b.distant ? 1 : 0;
}

LightBounds LightBounds::join(const LightBounds& a, const LightBounds& b) {
  if (!(a.intensity > 0)) return b;
  if (!(b.intensity > 0)) return a;
  LightBounds all;
  all.distant = a.distant;
  all.lower = least(a.lower, b.lower), all.upper = most(a.upper, b.upper);
  all.intensity = a.intensity + b.intensity;
  all.twoSided = a.twoSided || b.twoSided;
  all.cosE = std::min(a.cosE, b.cosE);
  // the cone about both cones of normals; of two-sided ones the axis may be turned over
  if (a.cosO <= -1 || b.cosO <= -1) {
    all.cosO = -1;
    return all;
  }
  if (a.axis == b.axis) {  // as in a flat mesh: without the functions of angles
    all.axis = a.axis, all.cosO = std::min(a.cosO, b.cosO);
    return all;
  }
  const double o1 = std::acos(std::clamp(double(a.cosO), -1.0, 1.0)),
               o2 = std::acos(std::clamp(double(b.cosO), -1.0, 1.0));
  const Vec3f other = a.twoSided && b.twoSided && dot(a.axis, b.axis) < 0 ? -b.axis : b.axis;
  const LightBounds& wide = o1 >= o2 ? a : b;
  const Vec3f wideAxis = o1 >= o2 ? a.axis : other, narrowAxis = o1 >= o2 ? other : a.axis;
  const double big = std::max(o1, o2), small = std::min(o1, o2);
  const double apart = std::acos(std::clamp(double(dot(wideAxis, narrowAxis)), -1.0, 1.0));
  all.axis = wideAxis;
  all.cosO = wide.cosO;
  if (std::min(apart + small, kPi<double>) <= big) return all;
  const double o = (big + apart + small) / 2;
  const Vec3f turnAbout = cross(wideAxis, narrowAxis);
  if (!(o < kPi<double>) || !(dot(turnAbout, turnAbout) > 0)) {
    all.cosO = -1;
    return all;
  }
  const auto turn = static_cast<float>(o - big);
  const Vec3f k = normalize(turnAbout);
  all.axis = normalize(wideAxis * std::cos(turn) + cross(k, wideAxis) * std::sin(turn));
  all.cosO = static_cast<float>(std::cos(std::min(o + 1e-4, kPi<double>)));
  return all;
}

class LightTree::Builder {
 public:
  Builder(LightTree& tree, const std::vector<LightBounds>& lights) : tree_(tree), lights_(lights) {
    tree_.place_.assign(lights.size(), kNone);
    std::vector<uint32_t> distant;
    for (uint32_t i = 0; i < lights.size(); ++i)
      if (lights[i].intensity > 0) (lights[i].distant ? distant : order_).push_back(i);
    const auto finite = static_cast<uint32_t>(order_.size()), all = finite + static_cast<uint32_t>(distant.size());
    if (all == 0) return;
    // the strongest distant ones are entries of their own, the rest are one together
    std::stable_sort(distant.begin(), distant.end(),
                     [&](uint32_t a, uint32_t b) { return lights[a].intensity > lights[b].intensity; });
    order_.insert(order_.end(), distant.begin(), distant.end());
    std::vector<Part> entries;
    if (finite > 0) entries = split(part(0, finite), kMostEntries - std::min(distant.size(), kMostDistant + 1));
    for (uint32_t i = finite; i < all;) {
      const uint32_t end = i - finite < kMostDistant ? i + 1 : all;
      entries.push_back(part(i, end));
      i = end;
    }
    const double power = powerOf({0, all, {}});
    for (const Part& entry : entries) {
      const uint32_t i = tree_.entries_++;
      tree_.lanes_[i / kGroup].set(i % kGroup, entry.bounds);
      tree_.power_[i] = static_cast<float>(power > 0 ? powerOf(entry) / power : 1 / double(entries.size()));
      tree_.entry_[i] = child(entry, i);
    }
  }

 private:
  Part part(uint32_t begin, uint32_t end) const {
    LightBounds all;
    for (uint32_t i = begin; i < end; ++i) all = LightBounds::join(all, lights_[order_[i]]);
    return {begin, end, all};
  }
  double powerOf(const Part& part) const {
    double sum = 0;
    for (uint32_t i = part.begin; i < part.end; ++i) sum += double(lights_[order_[i]].power);
    return sum;
  }
  // A part in at most so many.
  std::vector<Part> split(const Part& whole, size_t most) {
    std::vector<Part> parts{whole};
    if (whole.end - whole.begin <= most) {
      parts.clear();
      for (uint32_t i = whole.begin; i < whole.end; ++i) parts.push_back(part(i, i + 1));
    }
    const auto worth = [](const Part& p) {
      return p.end - p.begin < 2 ? -1.0 : double(p.bounds.intensity) * double(length(p.bounds.upper - p.bounds.lower));
    };
    while (parts.size() < most) {
      const auto at = std::max_element(parts.begin(), parts.end(),
                                       [&](const Part& a, const Part& b) { return worth(a) < worth(b); });
      if (worth(*at) < 0) break;
      const uint32_t begin = at->begin, end = at->end, middle = split(begin, end);
      *at = part(begin, middle);
      parts.push_back(part(middle, end));
    }
    return parts;
  }
  // What a group has for a part, and all that is below it.
  uint32_t child(const Part& part, uint32_t place) {
    if (part.end - part.begin == 1) {
      tree_.place_[order_[part.begin]] = place;
      return order_[part.begin];
    }
    const auto index = static_cast<uint32_t>(tree_.groups_.size());
    tree_.groups_.emplace_back();
    const std::vector<Part> parts = split(part, kGroup);
    Group group{};
    group.count = static_cast<uint32_t>(parts.size()), group.place = place;
    for (uint32_t i = 0; i < group.count; ++i) {
      group.lanes.set(i, parts[i].bounds);
      group.child[i] = child(parts[i], 16 * (1 + index) + i);
    }
    tree_.groups_[index] = group;
    return kGroupFlag | index;
  }

  // Orders lights so that the first of two groups ends at the returned place, where the two are spread least.
  uint32_t split(uint32_t begin, uint32_t end) {
    constexpr int kBuckets = 12;
    const auto center = [&](uint32_t light, int axis) {
      return component(lights_[light].lower + lights_[light].upper, axis) * 0.5f;
    };
    double best = std::numeric_limits<double>::infinity();
    int bestAxis = -1, bestBucket = 0;
    float bestFrom = 0, bestSize = 0;
    const auto bucketOf = [&](uint32_t light, int axis, float from, float size) {
      return std::clamp(static_cast<int>((center(light, axis) - from) / size * kBuckets), 0, kBuckets - 1);
    };
    constexpr uint32_t kMany = 4096;  // of so many the longest axis will do
    int longest = 0;
    if (end - begin > kMany) {
      Vec3f lower = lights_[order_[begin]].lower, upper = lower;
      for (uint32_t i = begin; i < end; ++i)
        lower = least(lower, lights_[order_[i]].lower), upper = most(upper, lights_[order_[i]].lower);
      const Vec3f d = upper - lower;
      longest = d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
    }
    for (int axis = 0; axis < 3; ++axis) {
      if (end - begin > kMany && axis != longest) continue;
      float from = std::numeric_limits<float>::max(), to = -from;
      for (uint32_t i = begin; i < end; ++i)
        from = std::min(from, center(order_[i], axis)), to = std::max(to, center(order_[i], axis));
      const float size = to - from;
      if (!(size > 0) || !std::isfinite(size)) continue;
      std::array<LightBounds, kBuckets> bucket;
      for (uint32_t i = begin; i < end; ++i) {
        LightBounds& b = bucket[static_cast<size_t>(bucketOf(order_[i], axis, from, size))];
        b = LightBounds::join(b, lights_[order_[i]]);
      }
      std::array<double, kBuckets> below{};
      LightBounds sum;
      for (size_t k = 0; k < kBuckets; ++k) sum = LightBounds::join(sum, bucket[k]), below[k] = spread(sum);
      sum = {};
      for (size_t k = kBuckets - 1; k > 0; --k) {
        sum = LightBounds::join(sum, bucket[k]);
        const double cost = below[k - 1] + spread(sum);
        if (cost < best)
          best = cost, bestAxis = axis, bestBucket = static_cast<int>(k), bestFrom = from, bestSize = size;
      }
    }
    const uint32_t half = begin + (end - begin) / 2;
    if (bestAxis < 0) return half;  // all in one place
    const auto middle = std::partition(order_.begin() + begin, order_.begin() + end, [&](uint32_t light) {
      return bucketOf(light, bestAxis, bestFrom, bestSize) < bestBucket;
    });
    const auto at = static_cast<uint32_t>(middle - order_.begin());
    return at == begin || at == end ? half : at;
  }

  LightTree& tree_;
  const std::vector<LightBounds>& lights_;
  std::vector<uint32_t> order_;
};

LightTree::LightTree(const std::vector<LightBounds>& lights) { Builder(*this, lights); }

LightTree::View LightTree::from(Vec3f p, Vec3f n, float matte, const Factors* known) const {
  // Nothing else is known of what is hidden, nor of where gloss looks: a part, of gloss a larger one, is drawn by
  // power.
  constexpr float kHidden = 0.2f, kElsewhere = 0.5f;
  View v;
  v.p = p, v.n = n;
  if (entries_ <= 1) {
    v.probability = power_;
    return v;
  }
  std::array<float, kMostEntries> here;
  const size_t lanes = entries_ > kGroup ? kMostEntries : kGroup;
  for (size_t i = 0; i < lanes; i += kGroup) importances(lanes_[i / kGroup], p, n, dot(n, n) > 0, &here[i]);
  float sum = 0, power = 0;
  for (size_t i = 0; i < lanes; ++i) sum += here[i], power += here[i] > 0 ? power_[i] : 0;
  if (!isUsable(sum) || !(power > 0)) {
    v.probability = power_;
    return v;
  }
  const float sure = (1 - kHidden) * (1 - kElsewhere * (1 - std::clamp(matte, 0.0f, 1.0f))), byImportance = sure / sum,
              byPower = (1 - sure) / power;
  for (size_t i = 0; i < lanes; ++i) v.probability[i] = here[i] > 0 ? here[i] * byImportance + power_[i] * byPower : 0;
  if (known != nullptr) {
    float all = 0;
    for (size_t i = 0; i < lanes; ++i) all += v.probability[i] *= (*known)[i];
    for (size_t i = 0; i < lanes; ++i) v.probability[i] *= 1 / all;
  }
  return v;
}

bool LightTree::shares(const Group& group, const View& view, std::array<float, kGroup>& to) {
  importances(group.lanes, view.p, view.n, dot(view.n, view.n) > 0, to.data());
  float sum = 0;
  for (const float x : to) sum += x;
  if (!isUsable(sum)) return false;
  for (float& x : to) x /= sum;
  return true;
}

namespace {

// Draws one of several by u, of which what is left replaces it.
size_t draw(const float* probability, size_t count, double& u) {
  double before = 0;
  size_t last = 0;
  for (size_t i = 0; i < count; ++i) {
    if (!(probability[i] > 0)) continue;
    last = i;
    if (u < before + double(probability[i])) break;
    before += double(probability[i]);
  }
  if (u >= before + double(probability[last])) before = u - kBelow1 * double(probability[last]);  // rounding
  u = std::min(std::max((u - before) / double(probability[last]), 0.0), kBelow1);
  return last;
}

}  // namespace

LightTree::Choice LightTree::choose(const View& view, double& u) const {
  size_t at = draw(view.probability.data(), entries_, u);
  const auto entry = static_cast<uint32_t>(at);
  float probability = view.probability[at];
  uint32_t child = entry_[at];
  while ((child & kGroupFlag) != 0) {
    const Group& group = groups_[child & ~kGroupFlag];
    std::array<float, kGroup> share;
    if (!shares(group, view, share)) return {};
    at = draw(share.data(), group.count, u);
    probability *= share[at];
    child = group.child[at];
  }
  return {child, entry, probability};
}

float LightTree::probability(const View& view, uint32_t light) const {
  uint32_t place = place_[light];
  if (place == kNone) return 0;
  float probability = 1;
  for (; place >= 16; place = groups_[place / 16 - 1].place) {
    std::array<float, kGroup> share;
    if (!shares(groups_[place / 16 - 1], view, share)) return 0;
    probability *= share[place % 16];
  }
  return probability * view.probability[place];
}

}  // namespace wardmis
