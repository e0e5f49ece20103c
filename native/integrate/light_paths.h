// SPDX-License-Identifier: GPL-3.0-or-later
// Subpaths from the lights: their vertices, to which those of the camera's paths are connected, and what they bring to
// the film. Of one camera sample of the image at a time, and shared by all pixels.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "integrate/plan.h"
#include "math/scratch.h"
#include "mis/ways.h"
#include "world/camera_ray.h"
#include "world/light_emission.h"

namespace wardmis {

// A place on a surface that light has come to.
struct LightVertex {
  Hit hit;
  Vec3f position, towards;  // world; unit, to the vertex or the emitter before
  // What it brings, over the density of coming here by area across the ray and by solid angle: the light that goes on
  // from here is f cos times that over the cosine of `towards` and the face's normal.
  Rgb flux;
  double density;  // as of a PathEnd; of a first vertex per solid angle of the emitter
  Ways back;
  bool joins = true;  // to the vertex before it, whose lobe was not a sharp one
  uint32_t emitter;
  float distance;                                // to the emitter, of a first vertex
  uint16_t length;                               // 1: the first after the emitter
  uint16_t passed, passedFirst;                  // surfaces that it came straight through, and those before the first
  std::array<uint16_t, kBounceKinds> bounces{};  // by which a path from the camera goes on from here
};

// What tells about how much a vertex would bring, were it seen.
struct LightSketch {
  Vec3f position, normal;  // of the face, on the side that light came to
  float flux;              // luminance, over the cosine
  float others;            // about PathEnd::others(), without the geometry of the joining ray
  uint16_t length;
  bool transmits, sharp;  // sharp: has no lobes but those of one direction, seen from where the light came
};

// Light that has come to the film.
struct Splat {
  float px, py;  // pixels of the full frame
  Rgb value;     // integrated over the film's area, in pixels, without a weight
  int surfaces;  // of the path
  Ways ways;     // all by which it may come, with as many samples at a hit as are asked for and one connection
};

// What some paths bring.
struct LightList {
  std::vector<LightVertex> vertices;
  std::vector<LightSketch> sketches;  // of the vertices
  std::vector<Splat> splats;
  std::array<uint32_t, WayImages::kMostSurfaces + 1> tried{};  // of vertices by their length, for the film
  void clear() { vertices.clear(), sketches.clear(), splats.clear(), tried = {}; }
};

// Whose vertices are kept, of a camera sample of the image: what they take is bounded. Of those that are left out the
// film alone knows.
inline constexpr uint32_t kMostKeptPaths = 1 << 17;

// How many of them there are to be, and what is there for a camera sample.
struct LightPaths {
  const LightEmission& emission;
  WeightPower power{};
  uint32_t paths = 0;          // for each camera sample of the image
  uint32_t kept = 0;           // of these, whose vertices are there
  int connections = 1;         // at the first vertex of a camera path; where pixels differ, at least their mean
  int laterConnections = 1;    // at each other
  double verticesPerPath = 1;  // expected: any number that is the same for all is right
  bool toFilm = true;
  bool countsBounces = false;  // kinds of bounces are limited
  double pixelsPerRay = 1;     // of the image, for one camera ray: more in a coarse pilot

  std::vector<LightVertex> vertices{};
  std::vector<LightSketch> sketches{};  // of the vertices
  std::vector<Rgb> film{};              // of each pixel of the border: what came to it, over the number of paths

  bool connects() const { return connections > 0 || laterConnections > 0; }
  // Of one connection, to each vertex of one path, as if all were made. For weights: a connection is chosen among
  // several, and is worth more than one at random.
  static constexpr double kWorth = 4;
  double perVertex() const { return paths > 0 ? kWorth / verticesPerPath : 0; }
  // Of a path from a light at its vertex, with one connection of each camera vertex: how many there are depends on the
  // pixel.
  PathEnd endAt(const LightVertex& v, Join join) const {
    return {join, v.joins ? power(perVertex()) : 0, v.back, v.density};
  }
  // Rays to the film for each camera ray through a pixel.
  double perPixel() const { return toFilm ? paths * pixelsPerRay : 0; }
};

// A vertex of a camera's path, to which they are connected.
struct CameraVertex {
  CameraVertex(const LightPaths& paths, const PixelWays& counts) : light(paths), ways(counts) {}

  const LightPaths& light;
  const PixelWays& ways;  // of the pixel
  int connections(uint32_t vertex) const { return vertex == 0 ? ways.connections : ways.laterConnections; }
  double perVertex(uint32_t vertex) const { return light.perVertex() * connections(vertex); }
  PathEnd end;
  std::array<int, kBounceKinds> left{};      // bounces that a path may still make
  int depth = 1;                             // most surface hits of a whole path
  Scratch<PathEnd, kMaxSamplesPerHit> next;  // of each continuation, but for the cosine where it ends
  // Where a pilot notes what the samples bring; null: nobody does.
  struct Notes {
    WayTally& tally;
    size_t pixel;
    WayScatter* scatter;  // of each technique at the first hit; null where the candidates are not asked
  };
  const Notes* notes = nullptr;
  Rgb before{1, 1, 1}, throughput{1, 1, 1};  // of what is seen at the first hit, and here

  void note(Rgb value, const Ways& all, double weight, uint32_t vertex, int byLight) const {
    notes->tally.note(notes->pixel, value * throughput, all, weight, static_cast<int>(vertex) + 1, byLight);
  }

  // At a surface, whose face the ray meets at this cosine. reached: by paths from the lights.
  void arrive(float cosine, bool reached) {
    if (reached)
      end.density *= light.power(std::abs(double(cosine)));
    else
      end = {};
  }
};

}  // namespace wardmis
