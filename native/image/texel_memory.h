// SPDX-License-Identifier: GPL-3.0-or-later
// Where texels lie: in memory up to a limit, beyond it in files without a name that are mapped, whose pages the system
// reads when they are looked at and may drop at any time. What is looked up is the same.
#pragma once

#include <string>

#include "math/table.h"

namespace wardmis {

// Zeroed. Throws Error(kMemory) where neither the disk nor the memory has room.
void* takeTexels(size_t bytes);
void giveTexelsBack(void* memory, size_t bytes);

template <class T>
using Texels = std::vector<T, LargeMemory<T, takeTexels, giveTexelsBack>>;

// Bytes of texels that the process keeps in memory at most, those of the files' pages that are there included. Of what
// is taken from now on; 0 for the default: WARDMIS_TEXTURE_MEMORY of the environment, in MB, or else 1 GB.
void setTexelLimit(size_t bytes);

// What all images larger than a huge page take.
struct TexelUse {
  size_t memory = 0, files = 0;
  std::string folder;  // of the files
};
TexelUse texelUse();
// "1.2 GB, 3.8 GB of it in files in /var/tmp", say; empty where there are none.
std::string describe(const TexelUse& use);

}  // namespace wardmis
