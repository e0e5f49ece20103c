// SPDX-License-Identifier: GPL-3.0-or-later
#include "world/motion.h"

#include <cmath>

namespace wardmis {
namespace {

using Vec3d = Vec3<double>;
Vec3d toDouble(Vec3f v) { return {v.x, v.y, v.z}; }

// Of the rotation whose columns are x, y, z; the largest component first, which keeps every digit.
void toQuaternion(Vec3d x, Vec3d y, Vec3d z, float (&q)[4]) {
  const double c[4][4] = {{1 + x.x - y.y - z.z, x.y + y.x, x.z + z.x, y.z - z.y},
                          {x.y + y.x, 1 - x.x + y.y - z.z, y.z + z.y, z.x - x.z},
                          {x.z + z.x, y.z + z.y, 1 - x.x - y.y + z.z, x.y - y.x},
                          {y.z - z.y, z.x - x.z, x.y - y.x, 1 + x.x + y.y + z.z}};
  int best = 0;
  for (int i = 1; i < 4; ++i)
    if (c[i][i] > c[best][best]) best = i;
  double n = 0;
  for (const double v : c[best]) n += v * v;
  for (int i = 0; i < 4; ++i) q[i] = static_cast<float>(c[best][i] / std::sqrt(n));
}

// By Gram and Schmidt: columns are turned onto orthogonal ones, what is left is an upper triangle.
Decomposed decompose(const Affine& m) {
  Vec3d x = toDouble(m.x), y = toDouble(m.y), z = toDouble(m.z);
  const double sign = dot(x, cross(y, z)) < 0 ? -1 : 1;
  x = x * sign, y = y * sign, z = z * sign;
  const double xx = length(x);
  const Vec3d ex = x / xx;
  const double xy = dot(ex, y);
  const Vec3d restY = y - ex * xy;
  const double yy = length(restY);
  const Vec3d ey = restY / yy, ez = cross(ex, ey);
  Decomposed d;
  toQuaternion(ex, ey, ez, d.quaternion);
  const auto f = [sign](double v) { return static_cast<float>(sign * v); };
  d.xx = f(xx), d.xy = f(xy), d.xz = f(dot(ex, z));
  d.yy = f(yy), d.yz = f(dot(ey, z)), d.zz = f(dot(ez, z));
  d.translation = m.t;
  return d;
}

void slerp(const float (&a)[4], const float (&b)[4], float t, float (&out)[4]) {
  const float c = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];  // not negative, see MovingFrame
  float wa = 1 - t, wb = t;
  if (c < 0.9995f) {
    const float angle = std::acos(std::min(c, 1.0f)), s = 1 / std::sin(angle);
    wa = std::sin((1 - t) * angle) * s, wb = std::sin(t * angle) * s;
  }
  float n = 0;
  for (int i = 0; i < 4; ++i) out[i] = wa * a[i] + wb * b[i], n += out[i] * out[i];
  for (float& v : out) v /= std::sqrt(n);
}

}  // namespace

MovingFrame::MovingFrame(std::span<const Affine> steps) {
  for (const Affine& m : steps) {
    Decomposed d = decompose(m);
    if (!steps_.empty()) {  // the same rotation, on the near side of the last one
      const float(&q)[4] = steps_.back().quaternion;
      float c = 0;
      for (int i = 0; i < 4; ++i) c += q[i] * d.quaternion[i];
      if (c < 0)
        for (float& v : d.quaternion) v = -v;
    }
    steps_.push_back(d);
  }
}

Affine MovingFrame::at(float time) const {
  const auto [first, t] = stepAt(steps_.size(), time);
  const Decomposed &a = steps_[first], &b = steps_[first + 1];
  float q[4];
  slerp(a.quaternion, b.quaternion, t, q);
  const auto mix = [t = t](auto v, auto w) { return v * (1 - t) + w * t; };
  const float x = q[0], y = q[1], z = q[2], w = q[3];
  const Vec3f ex{1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
  const Vec3f ey{2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
  const Vec3f ez{2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
  return {ex * mix(a.xx, b.xx), ex * mix(a.xy, b.xy) + ey * mix(a.yy, b.yy),
          ex * mix(a.xz, b.xz) + ey * mix(a.yz, b.yz) + ez * mix(a.zz, b.zz), mix(a.translation, b.translation)};
}

Shutter::Shutter(std::span<const float> curve, float rolling) : rolling_(rolling) {
  if (curve.size() < 2) return;
  constexpr int kSteps = 1024;
  const auto open = [&](double t) {
    const double s = t * double(curve.size() - 1);
    const size_t i = std::min(static_cast<size_t>(s), curve.size() - 2);
    const double way = s - double(i);
    return std::max(0.0, double(curve[i]) * (1 - way) + double(curve[i + 1]) * way);
  };
  std::vector<double> sum(kSteps + 1, 0);
  for (int i = 0; i < kSteps; ++i)
    sum[static_cast<size_t>(i) + 1] = sum[static_cast<size_t>(i)] + open((i + 0.5) / kSteps);
  if (!(sum.back() > 0)) return;
  size_t at = 0;
  for (int i = 0; i <= kSteps; ++i) {
    const double wanted = sum.back() * i / kSteps;
    while (at + 1 < kSteps && (sum[at + 1] < wanted || !(sum[at + 1] > 0))) ++at;
    const double step = sum[at + 1] - sum[at];
    inverse_.push_back(static_cast<float>((double(at) + (step > 0 ? (wanted - sum[at]) / step : 0)) / kSteps));
  }
}

float Shutter::at(float u, float line) const {
  float time = u;
  if (!inverse_.empty()) {
    const StepAt s = stepAt(inverse_.size(), u);
    time = inverse_[s.first] * (1 - s.way) + inverse_[s.first + 1] * s.way;
  }
  if (rolling_ >= 0) time = (time - 0.5f) * rolling_ + (0.5f - line) * (1 - rolling_) + 0.5f;
  return std::clamp(time, 0.0f, 1.0f);
}

}  // namespace wardmis
