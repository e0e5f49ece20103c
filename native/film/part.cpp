// SPDX-License-Identifier: GPL-3.0-or-later
#include "film/part.h"

#include <fmt/format.h>

#include <bit>
#include <type_traits>

namespace wardmis {
namespace {

// Calls f with each thing that the film has of a pixel, all of them without gaps between their words.
template <class Film, class F>
void eachOf(Film& film, size_t pixel, F&& f) {
  auto& p = film.pixels[pixel];
  f(p.sum), f(p.squares), f(p.alpha), f(p.normal), f(p.albedo), f(p.depth);
  for (size_t t = 0; t < film.techniques; ++t) f(film.sampleCounts[pixel * film.techniques + t]);
  if (!film.data.empty()) {
    auto& d = film.data[pixel];
    f(d.position), f(d.objectIndex), f(d.materialIndex), f(d.uv), f(d.emission), f(d.environment);
  }
  if (!film.light.empty()) {
    auto& l = film.light[pixel];
    f(l.direct), f(l.indirect), f(l.color);
  }
  if (!film.catchers.empty()) {
    auto& c = film.catchers[pixel];
    f(c.light), f(c.alone), f(c.sky), f(c.covered), f(c.caught);
  }
}

template <class T>
constexpr size_t kWords = sizeof(T) / sizeof(uint32_t);

// One row of an image after the other, from the top; those of a film begin at the bottom.
size_t placeOf(const FilmBuffer& film, size_t pixel) {
  const auto width = static_cast<size_t>(film.width), height = static_cast<size_t>(film.height);
  return (height - 1 - pixel / width) * width + pixel % width;
}

size_t wordsOfPixel(const FilmBuffer& film) {
  size_t count = 0;
  eachOf(film, 0, [&](const auto& x) { count += kWords<std::decay_t<decltype(x)>>; });
  return count;
}

// Of whole numbers, and of sums: what it is to be with more samples.
void add(uint32_t& to, uint32_t more) { to += more; }
template <class Sum>
void add(Sum& to, const Sum& more) {
  to += more;
}
void add(LightPixel::Sums& to, const LightPixel::Sums& more) {
  for (size_t c = 0; c < to.size(); ++c) to[c] += more[c];
}

}  // namespace

std::vector<ExrWords> wordsOf(const FilmBuffer& film) {
  std::vector<ExrWords> words(wordsOfPixel(film));
  for (size_t k = 0; k < words.size(); ++k)  // numbered so that their order is that of the names
    words[k] = {fmt::format("{}{:04}", kPartChannel, k), std::vector<uint32_t>(film.pixels.size())};
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    size_t k = 0;
    const size_t place = placeOf(film, i);
    eachOf(film, i, [&](const auto& x) {
      using Words = std::array<uint32_t, kWords<std::decay_t<decltype(x)>>>;
      for (uint32_t word : std::bit_cast<Words>(x)) words[k++].values[place] = word;
    });
  }
  return words;
}

bool setWords(FilmBuffer& film, const std::vector<ExrWords>& words) {
  if (words.size() != wordsOfPixel(film)) return false;
  for (const ExrWords& w : words)
    if (w.values.size() != film.pixels.size()) return false;
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    size_t k = 0;
    const size_t place = placeOf(film, i);
    eachOf(film, i, [&](auto& x) {
      std::array<uint32_t, kWords<std::decay_t<decltype(x)>>> of;
      for (uint32_t& word : of) word = words[k++].values[place];
      x = std::bit_cast<std::decay_t<decltype(x)>>(of);
    });
  }
  return true;
}

void append(FilmBuffer& film, const FilmBuffer& more) {
  for (size_t i = 0; i < film.pixels.size(); ++i) {
    // what is of the image's first sample stays
    Pixel& p = film.pixels[i];
    const Pixel& q = more.pixels[i];
    add(p.sum, q.sum), add(p.squares, q.squares), add(p.alpha, q.alpha), add(p.normal, q.normal);
    add(p.albedo, q.albedo);
    for (size_t t = i * film.techniques; t < (i + 1) * film.techniques; ++t)
      add(film.sampleCounts[t], more.sampleCounts[t]);
    if (!film.data.empty()) {
      DataPixel& to = film.data[i];
      const DataPixel& from = more.data[i];
      add(to.uv, from.uv), add(to.emission, from.emission), add(to.environment, from.environment);
    }
    if (!film.light.empty()) {
      LightPixel& to = film.light[i];
      const LightPixel& from = more.light[i];
      add(to.direct, from.direct), add(to.indirect, from.indirect), add(to.color, from.color);
    }
    if (!film.catchers.empty()) {
      CatcherPixel& to = film.catchers[i];
      const CatcherPixel& from = more.catchers[i];
      add(to.light, from.light), add(to.alone, from.alone), add(to.sky, from.sky), add(to.covered, from.covered);
      add(to.caught, from.caught);
    }
  }
  film.samples += more.samples;
}

}  // namespace wardmis
