// SPDX-License-Identifier: GPL-3.0-or-later
// Weights over all ways in which two ends, the camera's and the lights', may share the vertices of a path (Veach 1997,
// section 10.2). Each end has a density for going on from a vertex to the next; a path of ends that meet has been made
// by one of them up to some vertex and by the other from there on, joined by a connection. The densities of all other
// ways are those of this one times ratios, which each end sums up as it goes (as in Georgiev 2012, "Implementing vertex
// connection and merging"), so that a weight takes one look at either end however long they are.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wardmis {

// What joins the ends: the groups of ways whose numbers of samples can be chosen.
enum Join : uint8_t {
  kByCamera,  // nothing: the camera's path finds the emitter, or a sample of the lights does at its last vertex
  kAtFirst,   // a connection to the first surface that the camera sees
  kAtLater,   // one to a later vertex
  kAtFilm,    // the path from the light is traced to the film
  kJoins
};

// Of connections to a vertex of the camera's path, by its number.
constexpr Join joinAt(uint32_t vertex) { return vertex == 0 ? kAtFirst : kAtLater; }

// Densities, by group.
struct Ways {
  std::array<double, kJoins> of{};

  static Ways one(Join join, double density) {
    Ways w;
    w.of[join] = density;
    return w;
  }
  double sum() const { return (of[0] + of[1]) + (of[2] + of[3]); }
  Ways& operator+=(const Ways& b) {
    for (size_t i = 0; i < kJoins; ++i) of[i] += b.of[i];
    return *this;
  }
  // Of numbers that are larger by these.
  Ways operator*(const std::array<double, kJoins>& factors) const {
    Ways w = *this;
    for (size_t i = 0; i < kJoins; ++i) w.of[i] *= factors[i];
    return w;
  }
  Ways operator*(double s) const {
    Ways w = *this;
    for (double& each : w.of) each *= s;
    return w;
  }
};

// What one end knows at its last vertex of the ways in which the other end made more of the path: densities relative to
// this end's own, by which it came here from its vertex before. Per area of the vertices, expected numbers of samples
// included.
struct PathEnd {
  Join join = kAtFilm;
  double connect = 0;  // of joining the vertex, made by the other end, and the one before; 0: they cannot be
  Ways back;           // of the other end's ways beyond, for each density by solid angle of its going on from here
  double density = 1;  // of this end's coming here

  // The sum over those ways. reverse: at which the other end goes on from here, per solid angle; rough: whether what it
  // scatters there can be connected at all.
  Ways others(double reverse, bool rough = true) const {
    constexpr double kLeast = 1e-100;  // where densities underflow, the other ways are all that counts
    const double scale = 1 / (density > kLeast ? density : kLeast);
    Ways w = back * (reverse * scale);
    if (rough) w.of[join] += connect * scale;
    return w;
  }
};

// The exponent of the weights: of the balance heuristic 1, of the power heuristic 2. Sums over ways are of powers.
struct WeightPower {
  bool square = false;
  double operator()(double density) const { return square ? density * density : density; }
};

}  // namespace wardmis
