// SPDX-License-Identifier: GPL-3.0-or-later
// Panoramic projections: from a point of the view plane to a direction and back (docs/scene-format.md). In the camera's
// axes, which looks along -z.
#pragma once

#include "scene/scene.h"

namespace wardmis {

// Unit; 0 where the camera sees nothing. camera: a panoramic one.
Vec3f panoramaDirection(const Camera& camera, float x, float y);

// The point of the view plane where a unit direction is seen.
Vec2f panoramaPoint(const Camera& camera, Vec3f direction);

// How far, as an angle, neighbouring pixels at this point of the view plane look apart: the mean of both directions.
float panoramaPixel(const Camera& camera, const Film& film, Vec2f point);

}  // namespace wardmis
