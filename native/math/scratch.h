// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>

namespace wardmis {

// A local array whose elements are made when they are first assigned: most hits use few of them.
template <class E, int Capacity>
class Scratch {
 public:
  E& operator[](int i) { return *std::launder(reinterpret_cast<E*>(at(i))); }
  const E& operator[](int i) const { return *std::launder(reinterpret_cast<const E*>(at(i))); }
  void set(int i, const E& e) {
    make(i, [&] { return e; });
  }
  // Where it is to stay, without a copy.
  template <class F>
  E& make(int i, F&& f) {
    return *new (at(i)) E(f());
  }

 private:
  std::byte* at(int i) { return storage_ + static_cast<size_t>(i) * sizeof(E); }
  const std::byte* at(int i) const { return storage_ + static_cast<size_t>(i) * sizeof(E); }

  alignas(E) std::byte storage_[sizeof(E) * static_cast<size_t>(Capacity)];
};

}  // namespace wardmis
