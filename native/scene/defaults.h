// SPDX-License-Identifier: GPL-3.0-or-later
// What a picture needs and files of other programs often lack.
#pragma once

#include "scene/scene.h"

namespace wardmis {

// Gives a scene without a camera a view of all that it holds, and a file without WARDMIS_scene a constant sky of
// radiance 1 if it has no lights, and nothing that shines or no camera: what glows on a mere model is meant to be seen,
// not to light it. Each is said in Scene::notes. After the film's size is known.
void addDefaults(Scene& scene);

}  // namespace wardmis
