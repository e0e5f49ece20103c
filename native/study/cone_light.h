// SPDX-License-Identifier: GPL-3.0-or-later
// A light of any size: Ward's lobe under a cone of uniform radiance R about the mirror direction, sampled as the
// renderer samples suns and spheres (toCone). Techniques: those of the input, where `uniform` is the light, uniform in
// the cone.
#pragma once

#include "study/problem.h"

namespace wardmis {

// halfAngle in radians; the cone must lie above the surface.
std::unique_ptr<Problem> makeConeLight(const StudyInput& input, double halfAngle);

}  // namespace wardmis
