// SPDX-License-Identifier: GPL-3.0-or-later
// The second table of `./dev bench`: nanoseconds that a look at each pattern takes.
#pragma once

#include <fmt/format.h>

#include <chrono>

#include "pattern/gabor.h"
#include "pattern/noise.h"
#include "pattern/simple.h"
#include "pattern/voronoi.h"
#include "pattern/wave.h"

namespace wardmis::test {

inline void benchPatterns() {
  using namespace pattern;
  const auto row = [](const char* name, auto look) {
    constexpr int kLooks = 400;
    double best = 1;
    float sum = 0;
    for (int run = 0; run < 200; run++) {
      const auto start = std::chrono::steady_clock::now();
      for (int i = 0; i < kLooks; i++) {
        const float t = static_cast<float>(i) * 0.37f;
        sum += look(Vec3f{t, 1.3f - t, 0.7f * t});
      }
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    fmt::print("| {} | {:.0f} |{}\n", name, best / kLooks * 1e9, sum == sum ? "" : " NaN");
  };
  fmt::print("\n| pattern | ns a look |\n|---|---:|\n");
  row("Perlin noise, 1D", [](Vec3f p) { return perlin(Point<1>{{p.x}}); });
  row("Perlin noise, 2D", [](Vec3f p) { return perlin(Point<2>{{p.x, p.y}}); });
  row("Perlin noise, 3D", [](Vec3f p) { return perlin(Point<3>{{p.x, p.y, p.z}}); });
  row("Perlin noise, 4D", [](Vec3f p) { return perlin(Point<4>{{p.x, p.y, p.z, 0.5f}}); });
  row("Noise Texture, 3D, 3 octaves", [](Vec3f p) { return noiseFactor({}, {}, p, 0); });
  row("Noise Texture, 3D, 3 octaves, colour", [](Vec3f p) { return noiseColor({}, {}, p, 0).y; });
  for (Version v : {Version::kBlender3, Version::kBlender5}) {
    const auto name = [v](const char* what) {
      return fmt::format("Voronoi Texture, 3D, {}, Blender {}", what, static_cast<int>(v));
    };
    VoronoiSettings s{.version = v};
    row(name("F1").c_str(), [&s](Vec3f p) { return voronoi(s, {}, p, 0).distance; });
    s.feature = VoronoiFeature::kSmoothF1;
    row(name("smooth F1").c_str(), [&s](Vec3f p) { return voronoi(s, {}, p, 0).distance; });
    s.feature = VoronoiFeature::kDistanceToEdge;
    row(name("distance to edge").c_str(), [&s](Vec3f p) { return voronoi(s, {}, p, 0).distance; });
  }
  row("Wave Texture, distorted", [](Vec3f p) { return wave({}, {.distortion = 2}, p); });
  row("White Noise Texture, 3D", [](Vec3f p) { return whiteNoise(3, p, 0); });
  row("Gabor Texture, 2D", [](Vec3f p) { return gabor(2, {}, p).value; });
  row("Gabor Texture, 3D", [](Vec3f p) { return gabor(3, {}, p).value; });
}

}  // namespace wardmis::test
