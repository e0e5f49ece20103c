// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/part.h"

#include <gtest/gtest.h>

#include "statistics.h"

namespace wardmis {
namespace {

using namespace test;

FilmBuffer emptyFilm(bool everything) {
  FilmBuffer film(5, 3, 4);
  if (!everything) return film;
  film.data.resize(film.pixels.size()), film.light.resize(film.pixels.size());
  film.catchers.resize(film.pixels.size());
  return film;
}

// With `count` samples in each place, from the `first` on.
FilmBuffer filled(bool everything, int first, int count) {
  FilmBuffer film = emptyFilm(everything);
  film.first = static_cast<uint32_t>(first), film.samples = static_cast<uint32_t>(count);
  for (size_t i = 0; i < film.pixels.size(); ++i)
    for (int s = first; s < first + count; ++s) {
      Random random(100 * i + static_cast<uint64_t>(s));
      const auto value = [&] {
        const auto one = [&] {
          return std::ldexp(static_cast<float>(random.integer(1, 1 << 24)), random.integer(-54, 6));
        };
        const float x = one(), y = one();
        return Rgb{x, y, one()};
      };
      Pixel& p = film.pixels[i];
      p.add(value());
      p.alpha.add({random.uniform()}), p.normal.add({random.uniform(), -random.uniform(), 0}),
          addTo(p.albedo, {1, 0, 0.3f});
      if (s == 0) p.depth = static_cast<float>(random.uniform());
      for (size_t t = 0; t < film.techniques; ++t) film.sampleCounts[i * film.techniques + t] += 2;
      if (!everything) continue;
      DataPixel& d = film.data[i];
      if (s == 0) d.position = value(), d.objectIndex = 3, d.materialIndex = 4;
      addTo(d.uv, value()), addTo(d.emission, value()), addTo(d.environment, value());
      LightPixel& l = film.light[i];
      for (LightPixel::Sums* sums : {&l.direct, &l.indirect, &l.color})
        for (RgbSum& sum : *sums) addTo(sum, value());
      CatcherPixel& c = film.catchers[i];
      addTo(c.light, value()), addTo(c.alone, value()), addTo(c.sky, value()), c.covered.add({random.uniform()});
      c.caught += 1;
    }
  return film;
}

bool same(const FilmBuffer& a, const FilmBuffer& b) {
  const auto x = wordsOf(a), y = wordsOf(b);
  if (x.size() != y.size()) return false;
  for (size_t k = 0; k < x.size(); ++k)
    if (x[k].name != y[k].name || x[k].values != y[k].values) return false;
  return true;
}

TEST(Part, ComesBackToTheBit) {
  for (bool everything : {false, true}) {
    const FilmBuffer film = filled(everything, 0, 7);
    FilmBuffer back = emptyFilm(everything);
    ASSERT_TRUE(setWords(back, wordsOf(film)));
    EXPECT_TRUE(same(back, film));
    EXPECT_FALSE(same(back, filled(everything, 0, 6)));
    EXPECT_FALSE(setWords(back, wordsOf(emptyFilm(!everything))));  // which keep other things
    EXPECT_FALSE(setWords(back, wordsOf(FilmBuffer(3, 5, 4))) && everything);
  }
}

TEST(Part, PartsAreTheWholeToTheBit) {
  for (bool everything : {false, true}) {
    const FilmBuffer whole = filled(everything, 0, 9);
    for (int cut : {1, 4, 8}) {
      FilmBuffer film = filled(everything, 0, cut);
      append(film, filled(everything, cut, 9 - cut));
      EXPECT_TRUE(same(film, whole)) << cut;
      EXPECT_EQ(film.samples, 9u);
    }
  }
}

}  // namespace
}  // namespace wardmis
