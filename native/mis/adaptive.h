// SPDX-License-Identifier: GPL-3.0-or-later
// What a run of the study learns from its own samples, as points.
#pragma once

#include "mis/strategy.h"

namespace wardmis {

// One sample as a point of the pooled estimate of integrals: sum_kj h(X_kj)/sum_l n_l p_l(X_kj), from all techniques'
// samples, n_l being the number that technique l has drawn.
Point pooledPoint(double f, const Densities& p, const Densities& n, int techniques);

// One step of Havran and Sbert's fixed point a_i <- a_i sqrt(M_i), M_i = integral f^2 p_i/q^2, which never raises
// integral f^2/q; repeated until it rests.
Densities equaliseSecondMoments(const Points& points, Densities a);

// a, raised to at least `least` at the cost of the others.
Densities clampFractions(Densities a, int techniques, double least);

}  // namespace wardmis
