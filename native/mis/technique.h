// SPDX-License-Identifier: GPL-3.0-or-later
// The sampling techniques of a render, by number: first the lobes of a surface, then cos/pi for what is diffuse, last
// the emitters. K techniques leave room for K - 2 lobes; a render takes the smallest of the compiled K in which its
// surfaces fit. A hit has those of a mask.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace wardmis {

inline constexpr int kMaxTechniques = 8;

// The K that are compiled: X(K) for each.
#define WARDMIS_TECHNIQUE_COUNTS(X) X(3) X(5) X(8)

using TechniqueMask = uint16_t;  // bit i: technique i
constexpr TechniqueMask maskOf(size_t technique) { return static_cast<TechniqueMask>(1u << technique); }
constexpr bool has(TechniqueMask mask, size_t technique) { return (mask >> technique & 1u) != 0; }

template <size_t K>
struct Techniques {
  static constexpr size_t kLobes = K - 2;  // numbers below are lobes
  static constexpr size_t kCosine = K - 2, kLight = K - 1;
  static constexpr size_t kSurface = K - 1;  // numbers below are the surface's own: lobes and cosine
  static constexpr TechniqueMask kAll = (1u << K) - 1;
};

// One number a technique.
template <size_t K>
using Fractions = std::array<float, K>;

// f(std::integral_constant<size_t, K>) with the smallest compiled K that holds so many lobes.
template <class F>
decltype(auto) withTechniques(size_t lobes, F&& f) {
#define WARDMIS_TRY(K) \
  if (lobes + 2 <= (K) || (K) == kMaxTechniques) return f(std::integral_constant<size_t, K>{});
  WARDMIS_TECHNIQUE_COUNTS(WARDMIS_TRY)
#undef WARDMIS_TRY
}

}  // namespace wardmis
