// SPDX-License-Identifier: GPL-3.0-or-later
// What a coarse pilot has found for an image: one value for each square of its pixels.
#pragma once

#include <cstddef>
#include <vector>

namespace wardmis {

template <class T>
struct SquareMap {
  int side = 1, width = 0;  // of a square, in pixels; of the image, in squares
  std::vector<T> squares;

  const T& at(int x, int y) const {
    return squares[static_cast<size_t>(y / side) * static_cast<size_t>(width) + static_cast<size_t>(x / side)];
  }
};

}  // namespace wardmis
