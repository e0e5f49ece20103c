// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/film.h"

#include <gtest/gtest.h>

#include <limits>

#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

TEST(FilmBuffer, MeanAndVarianceOfTheMean) {
  Random random(1);
  FilmBuffer film(3, 2);
  Estimate exact[3];
  for (int i = 0; i < 1000; ++i) {
    const Rgb v{static_cast<float>(random.uniform()), static_cast<float>(random.logUniform(1e-6, 1e6)), 2.5f};
    film.at(1, 1).add(v);
    exact[0].add(double(v.x)), exact[1].add(double(v.y)), exact[2].add(double(v.z));
  }
  film.samples = 1000;
  const Rgb mean = film.mean(film.at(1, 1)), variance = film.variance(film.at(1, 1));
  EXPECT_NEAR(mean.x, exact[0].mean(), 1e-6 * exact[0].mean());
  EXPECT_NEAR(mean.y, exact[1].mean(), 1e-6 * exact[1].mean());
  EXPECT_EQ(mean.z, 2.5f);
  EXPECT_NEAR(variance.x, exact[0].variance() / 1000, 1e-6 * exact[0].variance() / 1000);
  EXPECT_NEAR(variance.y, exact[1].variance() / 1000, 1e-6 * exact[1].variance() / 1000);
  EXPECT_NEAR(variance.z, 0, 1e-15);
  EXPECT_EQ(film.mean(film.at(0, 1)), (Rgb{0, 0, 0}));
}

TEST(FilmBuffer, VarianceIsUnbiased) {
  Random random(2);
  Estimate variance;
  for (int k = 0; k < 20000; ++k) {
    FilmBuffer film(1, 1);
    film.samples = 4;
    for (int i = 0; i < 4; ++i) film.at(0, 0).add({static_cast<float>(random.uniform()), 0, 0});
    variance.add(double(film.variance(film.at(0, 0)).x));
  }
  EXPECT_NEAR(variance.mean(), 1.0 / 12 / 4, 5 * variance.error());
}

TEST(FilmBuffer, FewSamples) {
  FilmBuffer film(1, 1);
  EXPECT_EQ(film.mean(film.at(0, 0)), (Rgb{0, 0, 0}));
  EXPECT_EQ(film.variance(film.at(0, 0)), (Rgb{0, 0, 0}));
  film.at(0, 0).add({1, 2, 3});
  film.samples = 1;
  EXPECT_EQ(film.mean(film.at(0, 0)), (Rgb{1, 2, 3}));
  EXPECT_EQ(film.variance(film.at(0, 0)), (Rgb{0, 0, 0}));
}

// The largest sample that is admitted does not make sums or squares infinite.
TEST(FilmBuffer, LargestSamples) {
  FilmBuffer film(1, 1);
  film.samples = 1000;
  for (int i = 0; i < 1000; ++i) film.at(0, 0).add({1e38f, 3e38f, 0});
  EXPECT_FLOAT_EQ(film.mean(film.at(0, 0)).y, 3e38f);
  EXPECT_TRUE(std::isfinite(film.at(0, 0).squares[1]));
}

TEST(FilmBuffer, PixelsAreDistinct) {
  FilmBuffer film(4, 3);
  EXPECT_EQ(film.pixels.size(), 12u);
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) film.at(x, y).alpha.add({double(10 * y + x)});
  EXPECT_EQ(film.at(3, 2).alpha[0], 23);
  EXPECT_EQ(film.pixels[4].alpha[0], 10);  // rows one after the other, the bottom one first
}

// The squares of light that a float just holds are no floats; a pass is to be finite.
TEST(FilmBuffer, VarianceIsFinite) {
  FilmBuffer film(1, 1);
  film.samples = 2;
  film.at(0, 0).add({1e38f, 0, 1});
  film.at(0, 0).add({-1e38f, 0, 1});
  EXPECT_EQ(film.variance(film.at(0, 0)), (Rgb{std::numeric_limits<float>::max(), 0, 0}));
}

}  // namespace
}  // namespace wardmis
