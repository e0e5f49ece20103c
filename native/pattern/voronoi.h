// SPDX-License-Identifier: GPL-3.0-or-later
// Cellular noise (Worley, "A Cellular Texture Basis Function", 1996): distances to points of which each cell of the
// lattice has one. The node Voronoi Texture.
#pragma once

#include "pattern/point.h"

namespace wardmis::pattern {

enum class VoronoiFeature { kF1, kF2, kSmoothF1, kDistanceToEdge, kNSphereRadius };
enum class VoronoiMetric { kEuclidean, kManhattan, kChebychev, kMinkowski };

struct VoronoiSettings {
  Version version = Version::kBlender5;
  int dimensions = 3;
  VoronoiFeature feature = VoronoiFeature::kF1;
  VoronoiMetric metric = VoronoiMetric::kEuclidean;  // of F1, F2 and smooth F1 in two or more dimensions
  bool normalize = false;                            // by the largest distance; not in 3.4
};
struct VoronoiInputs {
  float scale = 5, detail = 0, roughness = 0.5f, lacunarity = 2;  // 3.4 has the scale alone
  float smoothness = 1, exponent = 0.5f, randomness = 1;
};
// What a feature does not have is 0.
struct VoronoiValue {
  float distance = 0;
  Rgb color;       // of the point
  Vec3f position;  // of the point, in the node's coordinates
  float w = 0;     // its fourth coordinate, or the only one
  float radius = 0;
};
VoronoiValue voronoi(const VoronoiSettings& settings, const VoronoiInputs& inputs, Vec3f p, float w);

}  // namespace wardmis::pattern
