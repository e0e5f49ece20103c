// SPDX-License-Identifier: GPL-3.0-or-later
// Which of many spheres a ray passes through: of lamps, which are no surfaces and hide nothing.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "math/vec.h"

namespace wardmis {

class SphereAccel {
 public:
  struct Sphere {
    Vec3f center;
    float radius;
  };
  SphereAccel();
  // Throws Error(kMemory) and Error(kScene).
  explicit SphereAccel(const std::vector<Sphere>& spheres);
  ~SphereAccel();
  SphereAccel& operator=(SphereAccel&&) noexcept;

  // Indices of spheres, in order; all those that the ray passes through are among them.
  struct Found {
    static constexpr size_t kMost = 64;
    std::array<uint32_t, kMost> index;
    size_t count = 0;
    bool tooMany = false;  // there are more: any may be met
  };
  void find(Vec3f origin, Vec3f direction, float tMax, Found& found) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace wardmis
