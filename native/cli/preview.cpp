// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/preview.h"

namespace wardmis {

bool Preview::show(const FilmBuffer& film, int side, const std::vector<PassInfo>& passes,
                   const std::vector<std::string>& techniqueNames, const std::string& layer, bool zUp) {
  using Clock = std::chrono::steady_clock;
  const bool finer = lastSide_ == 0 || side < lastSide_;
  if (!finer && std::chrono::duration<double>(Clock::now() - last_).count() < interval_) return false;
  ExrImage image = toPasses(film, passes, techniqueNames, layer, zUp);
  if (side > 1) image = enlarged(image, side, width_, height_);
  const bool holes = film.samples == 0;
  if (holes && !before_.channels.empty())
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const int row = (height_ - 1 - y) / side;
        if (film.count(static_cast<size_t>(row) * static_cast<size_t>(film.width) + static_cast<size_t>(x / side)) > 0)
          continue;
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(width_) + static_cast<size_t>(x);
        for (size_t c = 0; c < image.channels.size(); ++c) image.channels[c].values[i] = before_.channels[c].values[i];
      }
  writeExr(path_, image, false);
  if (!holes) before_ = side > 1 ? std::move(image) : ExrImage{};
  last_ = Clock::now(), lastSide_ = side;
  return true;
}

}  // namespace wardmis
