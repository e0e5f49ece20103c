// SPDX-License-Identifier: GPL-3.0-or-later
// A BRDF at single pairs of directions, in any precision: lines of numbers in, lines of numbers out.
#pragma once

#include <string>

#include "study/input.h"

namespace wardmis {

enum class Precision : uint8_t { kFloat, kDouble, kLongDouble };

struct EvalSettings {
  StudyInput surface;  // its BRDF, alpha, m, rhoD and rhoS
  Precision precision = Precision::kDouble;
  bool sample = false;  // lines are u1 u2 wo instead of wi wo
  bool json = false;
};

// For every line of `in` the values of
//   f       rho_d/pi + rho_s f_s
//   pdf     of the lobe's sampling, and its logarithm, which does not underflow
//   weight  f cos(theta_i) / pdf
// all zero unless both directions are above. Numbers are read as doubles, rounded to the precision, and not normalised.
void evalLines(const EvalSettings& settings, int in, int out);

}  // namespace wardmis
