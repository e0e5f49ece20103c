// SPDX-License-Identifier: GPL-3.0-or-later
// What a run can learn from its own samples: the points that pooled samples are, and the fractions of `auto`.
#pragma once

#include "mis/strategy.h"

namespace wardmis {

// One sample as a point of the pooled estimate of integrals: sum_kj h(X_kj)/sum_l n_l p_l(X_kj), from all techniques'
// samples, n_l being the number that technique l has drawn.
Point pooledPoint(double f, const Densities& p, const Densities& n, int techniques);

// Of `candidates`, the fractions whose gain in predicted variance x cost over equal counts, less `sigmas` times the
// gain's standard error, is the largest: equal counts, the first of them, where none is above nothing. The variance is
// that of the multi-sample estimator, sum_i a_i Var_{p_i}[f/q], and both are estimated from pilot points.
Densities autoFractions(const Points& pilot, const Densities* cost, double sigmas = 1);

// Fractions proportional to powers of `step` up to the one given, equal ones first.
std::vector<Densities> candidates(int techniques, double step, int power);

// One step of Havran and Sbert's fixed point a_i <- a_i sqrt(M_i), M_i = integral f^2 p_i/q^2, which never raises
// integral f^2/q; repeated until it rests.
Densities equaliseSecondMoments(const Points& points, Densities a);

// a, raised to at least `least` at the cost of the others.
Densities clampFractions(Densities a, int techniques, double least);

}  // namespace wardmis
