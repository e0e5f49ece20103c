// SPDX-License-Identifier: GPL-3.0-or-later
#include "integrate/light_path.h"
#include "integrate/tile.h"

namespace wardmis {

namespace {

constexpr uint32_t kConnecting = kKernelNeeds | kNeedsConnections;

}  // namespace

template <size_t K>
TileKernel<K> connectingKernel() {
  return &renderTile<kConnecting, K>;
}

template <size_t K>
void traceLightPaths(const KernelInput<K>& in, uint32_t first, uint32_t last, LightList& to, Counts& counts) {
  for (uint32_t i = first; i != last; ++i) traceLightPath<kConnecting, K>(in, i, to, counts);
}

#define WARDMIS_INSTANTIATE(K)                  \
  template TileKernel<K> connectingKernel<K>(); \
  template void traceLightPaths<K>(const KernelInput<K>&, uint32_t, uint32_t, LightList&, Counts&);
WARDMIS_TECHNIQUE_COUNTS(WARDMIS_INSTANTIATE)

}  // namespace wardmis
