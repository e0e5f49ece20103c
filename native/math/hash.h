// SPDX-License-Identifier: GPL-3.0-or-later
// FNV-1a, 64 bits (Fowler, Noll, Vo): tells whether data is what it was, not whether somebody forged it.
#pragma once

#include <cstdint>
#include <span>

namespace wardmis {

class Fnv1a {
 public:
  // A byte, or a larger number as one step: another value at one place is always another hash.
  void add(uint64_t value) { hash_ = (hash_ ^ value) * 0x100000001b3ULL; }
  template <class T>
  void add(std::span<const T> values) {
    for (const T value : values) add(uint64_t{value});
  }
  uint64_t value() const { return hash_; }

 private:
  uint64_t hash_ = 0xcbf29ce484222325ULL;
};

}  // namespace wardmis
