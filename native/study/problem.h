// SPDX-License-Identifier: GPL-3.0-or-later
// The integrand and the techniques of one study case: charts that a quadrature integrates over, and samples.
#pragma once

#include <functional>
#include <memory>

#include "bsdf/ward.h"
#include "math/random.h"
#include "math/vec.h"
#include "mis/points.h"
#include "study/input.h"

namespace wardmis {

// A part of the domain, mapped from the unit square (or, in one dimension, from u alone, v being ignored) so that what
// is narrow is spread out. at() gives the point with w = measure per du dv.
struct Chart {
  std::function<Point(double u, double v)> at;
  int dimensions = 2;
  std::vector<double> breaks{0, 0.25, 0.5, 0.75, 1};  // in v: between the first cells
};

// Samples of one technique, structure of arrays.
struct SampleBlock {
  std::vector<double> f;
  std::array<std::vector<double>, kMaxTechniques> p;

  void resize(size_t n, int techniques) {
    f.resize(n);
    for (int k = 0; k < techniques; ++k) p[static_cast<size_t>(k)].resize(n);
  }
};

class Problem {
 public:
  virtual ~Problem() = default;
  virtual std::vector<Chart> charts() const = 0;
  // ln of the probability that a sample of the technique falls outside the domain (below the horizon).
  virtual double logOutside(int technique) const = 0;
  // ln of the integral of f^2/p_i where it is dominated by the edge of the domain, which the charts do not resolve;
  // NaN where they do.
  virtual double logSecondMomentAtEdge(int technique) const = 0;
  // Normalisation of the lobe's density in the planar reduction; 1 in the full model.
  virtual double lobeNormalization() const { return 1; }
  // Draws samples [first, last) of the technique into the block.
  virtual void sample(int technique, Stream& random, SampleBlock& block, size_t first, size_t last) const = 0;

  const StudyInput& input() const { return input_; }
  int techniques() const { return static_cast<int>(input_.techniques.size()); }

 protected:
  explicit Problem(const StudyInput& input) : input_(input) {}
  StudyInput input_;
};

std::unique_ptr<Problem> makeProblem(const StudyInput& input);

constexpr WardVariant wardVariant(StudyBrdf b) { return static_cast<WardVariant>(static_cast<int>(b) - 1); }

}  // namespace wardmis
