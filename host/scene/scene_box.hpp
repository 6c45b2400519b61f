// The box about a scene's finite objects.
#pragma once
#include <Imath/ImathBox.h>

#include "host/scene/scene.hpp"

namespace raya {

/// The smallest box with sides along the axes that holds all spheres, polygons and cones, scene units; empty
/// (isEmpty()) of a scene of planes alone. Patches count by their corners.
Imath::Box3d scene_box(const Scene& scene);

}  // namespace raya
