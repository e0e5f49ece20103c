// SPDX-License-Identifier: GPL-3.0-or-later
#include "math/table.h"

#include <sys/mman.h>

namespace wardmis {
namespace {

constexpr size_t kSmallPage = 4096;
size_t wholePages(size_t size) { return (size + kSmallPage - 1) / kSmallPage * kSmallPage; }

}  // namespace

void* takePages(size_t size) {
  void* const memory = mmap(nullptr, size + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  // what lies before the first border of pages, and after the last page, goes back
  char* const begin = static_cast<char*>(memory);
  char* const aligned = begin + (kHugePage - reinterpret_cast<uintptr_t>(begin) % kHugePage) % kHugePage;
  if (aligned > begin) munmap(begin, static_cast<size_t>(aligned - begin));
  char* const end = aligned + wholePages(size);
  if (begin + size + kHugePage > end) munmap(end, static_cast<size_t>(begin + size + kHugePage - end));
  madvise(aligned, size, MADV_HUGEPAGE);  // no more than a wish
  return aligned;
}

void givePagesBack(void* memory, size_t size) { munmap(memory, wholePages(size)); }

}  // namespace wardmis
