// SPDX-License-Identifier: GPL-3.0-or-later
// One lobe as a whole: the integral of its density, its albedo, its sampler against its density, its sampling weights.
#pragma once

#include "study/problem.h"
#include "study/stability_numbers.h"

namespace wardmis {

struct LobeReport {
  double mass = 0;           // integral of the pdf over the hemisphere
  double below = 0;          // P_below, from the horizon's distance alone
  double albedo = 0;         // integral of f_s cos for rho_s = 1
  double quadrature = 0;     // the larger of their estimated relative errors
  double largestWeight = 0;  // of the samples
  double pSingle = 1;        // chi-square p-value in float; 1 where the renderer samples in double
  double pDouble = 1;
  bool single = false;  // whether the float sampler is in use for this lobe
};

// The integrals of the functions `tested`, by quadrature in the plane of slopes.
void integrateLobe(const WardFunctions<long double>& tested, const StudyInput& input, LobeReport& report);

// The largest weight and the p-value of `count` samples: their (e^-E, psi) counted in 16 x 16 cells, of which the
// density predicts the counts.
template <class T>
double chiSquareOfLobe(const WardFunctions<T>& tested, const WardFunctions<long double>& density,
                       const StudyInput& input, int count, Stream random, double& largestWeight);

extern template double chiSquareOfLobe(const WardFunctions<float>&, const WardFunctions<long double>&,
                                       const StudyInput&, int, Stream, double&);
extern template double chiSquareOfLobe(const WardFunctions<double>&, const WardFunctions<long double>&,
                                       const StudyInput&, int, Stream, double&);

}  // namespace wardmis
