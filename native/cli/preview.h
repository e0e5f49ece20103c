// SPDX-License-Identifier: GPL-3.0-or-later
// The image so far, in a file that is written anew as it grows.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "integrate/passes.h"

namespace wardmis {

class Preview {
 public:
  // interval: seconds between images; finer ones than the last do not wait. width, height: of the image.
  Preview(std::string path, double interval, int width, int height)
      : path_(std::move(path)), interval_(interval), width_(width), height_(height) {}

  // A film whose pixels are squares of `side`. Where it has no samples yet, the last one is seen that had. Whether the
  // file was written. Throws Error(kFile).
  bool show(const FilmBuffer& film, int side, const std::vector<PassInfo>& passes,
            const std::vector<std::string>& techniqueNames, const std::string& layer, bool zUp);

 private:
  std::string path_;
  double interval_;
  int width_, height_;
  std::chrono::steady_clock::time_point last_;
  int lastSide_ = 0;  // none yet
  ExrImage before_;   // what is seen where samples lack
};

}  // namespace wardmis
