// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "integrate/tile.h"

namespace wardmis {

TileKernel tileKernel(uint32_t needs) {
  static constexpr auto table = []<uint32_t... N>(std::integer_sequence<uint32_t, N...>) {
    return std::array<TileKernel, sizeof...(N)>{&renderTile<N>...};
  }(std::make_integer_sequence<uint32_t, kKernelNeeds + 1>{});
  return table[needs & kKernelNeeds];
}

}  // namespace wardmis
