// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/error_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace wardmis {
namespace {

TEST(ErrorEstimate, LooksAtPowersOfTwoAndBetween) {
  std::vector<uint32_t> found;
  for (uint32_t n = 0; n < 100;) found.push_back(n = ErrorEstimate::next(n));
  EXPECT_EQ(found, (std::vector<uint32_t>{4, 8, 12, 16, 24, 32, 48, 64, 96, 128}));
  EXPECT_EQ(ErrorEstimate::next(5), 8u);  // from any number on
  EXPECT_EQ(ErrorEstimate::next(65), 96u);
}

// A film of so many pixels of mean `mean` whose independent samples scatter by `sigma`; told(film, n) at each look.
template <class Told>
void lookAt(size_t pixels, double mean, double sigma, uint32_t last, unsigned seed, Told&& told) {
  FilmBuffer film(static_cast<int>(pixels), 1);
  ErrorEstimate estimate;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(mean, sigma);
  while (film.samples < last) {
    const uint32_t n = ErrorEstimate::next(film.samples);
    for (Pixel& p : film.pixels)
      for (uint32_t s = film.samples; s < n; ++s) {
        const auto v = static_cast<float>(normal(random));
        p.add({v, v, v});
      }
    film.samples = n;
    if (const auto error = estimate.look(film)) told(film, *error);
  }
}

// Of independent samples the mean estimate is the variance of the mean, whatever their number. Of 4000 pixels, one or
// two degrees of freedom each: 5 standard errors are 11 %; the quotient's own bias is below 1 %.
TEST(ErrorEstimate, IsTheVarianceOfIndependentSamples) {
  uint32_t least = ~0u;
  lookAt(4000, 1, 0.3, 192, 1, [&](const FilmBuffer& film, const EstimatedError& e) {
    least = std::min(least, film.samples);
    const double expected = 0.09 / film.samples / 1.01;
    EXPECT_NEAR(e.relMse / expected, 1, 0.12) << film.samples;
    EXPECT_GT(e.upper, e.relMse);
    EXPECT_LT(e.upper, 1.1 * e.relMse);
  });
  EXPECT_EQ(least, 8u);
}

// In 400 trials the error is above the limit in 5 %; 40 and more have a probability of 5e-5.
TEST(ErrorEstimate, IsBelowItsLimitAsOftenAsItSays) {
  int above = 0, trials = 0;
  for (unsigned seed = 0; seed < 400; ++seed)
    lookAt(2000, 1, 0.3, 24, seed, [&](const FilmBuffer& film, const EstimatedError& e) {
      if (film.samples != 24) return;
      ++trials;
      above += e.upper < 0.09 / film.samples / 1.01 ? 1 : 0;
    });
  EXPECT_EQ(trials, 400);
  EXPECT_LT(above, 40);
  EXPECT_GT(above, 2);  // nor is it just large
}

TEST(ErrorEstimate, OfOnePixelIsNeverSure) {
  lookAt(1, 1, 0.3, 16, 1, [](const FilmBuffer&, const EstimatedError& e) { EXPECT_TRUE(std::isinf(e.upper)); });
}

}  // namespace
}  // namespace wardmis
