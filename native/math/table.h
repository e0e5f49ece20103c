// SPDX-License-Identifier: GPL-3.0-or-later
// Memory for large tables that are read here and there: in pages of 2 MB, where the system has them, since every other
// look at a table of many small ones waits for its page's address first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

namespace wardmis {

// Zeroed. Throws std::bad_alloc.
void* takePages(size_t bytes);
void givePagesBack(void* memory, size_t bytes);

constexpr size_t kHugePage = size_t{1} << 21;

// An allocator that calls `take` for what is larger than a huge page.
template <class T, void* (*take)(size_t), void (*giveBack)(void*, size_t)>
struct LargeMemory {
  using value_type = T;
  template <class U>
  struct rebind {  // NOLINT(readability-identifier-naming): as containers want it
    using other = LargeMemory<U, take, giveBack>;
  };
  LargeMemory() = default;
  template <class U>
  LargeMemory(const LargeMemory<U, take, giveBack>&) {}  // NOLINT(google-explicit-constructor)

  T* allocate(size_t n) {
    if (n > SIZE_MAX / 2 / sizeof(T)) throw std::bad_array_new_length();
    const size_t bytes = n * sizeof(T);
    return static_cast<T*>(bytes < kHugePage ? ::operator new(bytes) : take(bytes));
  }
  void deallocate(T* memory, size_t n) {
    const size_t bytes = n * sizeof(T);
    if (bytes < kHugePage)
      ::operator delete(memory);
    else
      giveBack(memory, bytes);
  }
  bool operator==(const LargeMemory&) const = default;
};

template <class T>
using Table = std::vector<T, LargeMemory<T, takePages, givePagesBack>>;

// Asks for memory that will be read soon.
inline void fetch(const void* memory) {
  __builtin_prefetch(memory);
  asm volatile("");  // GCC deletes calls of functions that do nothing but prefetch
}

}  // namespace wardmis
