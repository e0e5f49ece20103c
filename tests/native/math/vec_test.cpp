// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/vec.h"

#include <gtest/gtest.h>

#include "statistics.h"

namespace wardmis {
namespace {

using test::Random;

Vec3f toFloat(Vec3<double> d) { return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)}; }

void expectOrthonormal(const Framef& f, double tolerance) {
  EXPECT_NEAR(dot(f.x, f.x), 1, tolerance);
  EXPECT_NEAR(dot(f.y, f.y), 1, tolerance);
  EXPECT_NEAR(dot(f.z, f.z), 1, tolerance);
  EXPECT_NEAR(dot(f.x, f.y), 0, tolerance);
  EXPECT_NEAR(dot(f.y, f.z), 0, tolerance);
  EXPECT_NEAR(dot(f.z, f.x), 0, tolerance);
  EXPECT_NEAR(dot(cross(f.x, f.y), f.z), 1, tolerance);  // right-handed
}

TEST(Frame, AroundANormalIsOrthonormal) {
  Random random(1);
  std::vector<Vec3f> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, -0.0f}, {0, -1, 0.0f}};
  for (int i = 0; i < 10000; ++i) normals.push_back(toFloat(random.direction()));
  for (int i = 0; i < 1000; ++i) {  // close to the poles, where 1 + z cancels
    const float e = static_cast<float>(random.logUniform(1e-30, 1e-2));
    normals.push_back(normalize(Vec3f{e, -e, i % 2 == 0 ? 1.0f : -1.0f}));
  }
  for (const Vec3f& n : normals) {
    const Framef f = Framef::around(n);
    EXPECT_EQ(f.z, n);
    expectOrthonormal(f, 1e-6);
  }
}

TEST(Frame, FollowsTheTangent) {
  Random random(2);
  for (int i = 0; i < 10000; ++i) {
    const Vec3f n = toFloat(random.direction());
    const float scale = static_cast<float>(random.logUniform(1e-12, 1e12));  // dp/du has any length
    const Vec3f t = toFloat(random.direction()) * scale;
    const Framef f = Framef::around(n, t);
    const double sine = std::sqrt(std::max(0.0, 1 - std::pow(double(dot(n, t / length(t))), 2)));
    expectOrthonormal(f, 1e-6 / std::max(sine, 1e-3) + 1e-6);
    if (sine > 1e-2) {
      EXPECT_GT(dot(f.x, t / length(t)), 0.999 * sine);
    }
  }
}

// A tangent along the normal says nothing: the rounding of t - n (n.t) must not be taken for a direction.
TEST(Frame, TangentAlongTheNormal) {
  Random random(3);
  for (int i = 0; i < 10000; ++i) {
    const Vec3f n = toFloat(random.direction());
    const float noise = i % 2 == 0 ? 0 : static_cast<float>(random.logUniform(1e-12, 1e-3));
    expectOrthonormal(Framef::around(n, (n + toFloat(random.direction()) * noise) * 3.0f), 1e-3);
  }
  expectOrthonormal(Framef::around({0, 0, 1}, {0, 0, 0}), 1e-6);
}

TEST(Frame, LocalAndWorldAreInverse) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Framef f = Framef::around(toFloat(random.direction()));
    const Vec3f v = toFloat(random.direction()), w = f.toWorld(f.toLocal(v));
    EXPECT_LT(length(v - w), 1e-6);
    EXPECT_NEAR(f.toLocal(f.z).z, 1, 1e-6);
  }
}

Affine randomAffine(Random& random) {
  const auto v = [&] { return toFloat(random.direction() * random.uniform(0.5, 2)); };
  for (;;) {
    const Affine a{v(), v(), v(), v()};
    if (std::abs(a.determinant()) > 0.1f) return a;
  }
}

TEST(Affine, InverseAndProduct) {
  Random random(5);
  for (int i = 0; i < 1000; ++i) {
    const Affine a = randomAffine(random), b = randomAffine(random);
    const Vec3f v = toFloat(random.direction());
    EXPECT_LT(length(a.inverseVector(a.vector(v)) - v), 2e-5);
    EXPECT_LT(length((a * b).point(v) - a.point(b.point(v))), 1e-5);
    EXPECT_NEAR((a * b).determinant(), a.determinant() * b.determinant(), 1e-4);
    EXPECT_LT(length(a.point(v) - a.vector(v) - a.t), 1e-5);
  }
  EXPECT_EQ(Affine{}.point({1, 2, 3}), (Vec3f{1, 2, 3}));
}

// A transformed normal stays orthogonal to the transformed surface, and on the side that the determinant's sign says.
TEST(Affine, NormalsStayNormal) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Affine a = randomAffine(random);
    const Framef f = Framef::around(toFloat(random.direction()));
    const Vec3f n = a.normal(f.z);
    EXPECT_NEAR(dot(n, a.vector(f.x)), 0, 1e-4);
    EXPECT_NEAR(dot(n, a.vector(f.y)), 0, 1e-4);
    EXPECT_NEAR(dot(n, a.vector(f.z)), a.determinant(), 1e-4);
  }
}

TEST(Vec3, ComponentsAndLuminance) {
  EXPECT_EQ(maxComponent(Vec3f{1, 3, 2}), 3);
  EXPECT_EQ(cross(Vec3f{1, 0, 0}, Vec3f{0, 1, 0}), (Vec3f{0, 0, 1}));
  EXPECT_FLOAT_EQ(luminance({1, 1, 1}), 1);
  EXPECT_FALSE(isFinite(Vec3f{0, INFINITY, 0}));
  EXPECT_FALSE(isFinite(Vec3f{0, 0, NAN}));
  EXPECT_TRUE(isFinite(Vec3f{3e38f, -3e38f, 0}));
}

}  // namespace
}  // namespace wardmis
