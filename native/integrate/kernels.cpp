// SPDX-License-Identifier: GPL-3.0-or-later
#include <utility>

#include "integrate/tile.h"

namespace wardmis {

namespace {

// A scene that reflects nothing takes the diffuse kernel: a superset, and never timed.
// So does one of more techniques than those of Ward's lobe, cosine and light, or of other lobes, that of everything.
template <size_t K>
constexpr uint32_t compiled(uint32_t needs) {
  if (Techniques<K>::kLobes > 1 || (needs & kNeedsLobes) != 0)
    return needs | kNeedsLobes | kNeedsDiffuse | kNeedsSpecular;
  return (needs & (kNeedsDiffuse | kNeedsSpecular)) != 0 ? needs : needs | kNeedsDiffuse;
}

}  // namespace

template <size_t K>
TileKernel<K> tileKernel(uint32_t needs) {
  if ((needs & kNeedsConnections) != 0) return connectingKernel<K>();
  static constexpr auto table = []<uint32_t... N>(std::integer_sequence<uint32_t, N...>) {
    return std::array<TileKernel<K>, sizeof...(N)>{&renderTile<compiled<K>(N), K>...};
  }
  (std::make_integer_sequence<uint32_t, kKernelNeeds + 1>{});
  return table[needs & kKernelNeeds];
}

#define WARDMIS_INSTANTIATE(K) template TileKernel<K> tileKernel<K>(uint32_t);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
