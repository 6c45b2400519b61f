// Rotation of the eye around the point that it looks at, random views, and the bounding box of a scene.
#pragma once
#include <Imath/ImathBox.h>

#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

/// Rotates the eye by `degrees` around the axis through `at` along `up`, counter-clockwise when `up` points towards the
/// observer. The eye keeps its height and distance. Full turns change no bit; quarter turns use exact sines and
/// cosines.
View turned(View view, double degrees);

/// Limits of the elevation of the eye in random_view().
inline constexpr double kMinElevationDegrees = 5, kMaxElevationDegrees = 75;

/// Returns the scene with a random eye at the old eye's distance from `at`. The new eye is uniformly distributed on the
/// zone of the sphere around `at` between the elevations kMinElevationDegrees and kMaxElevationDegrees above the plane
/// perpendicular to `up`. The result depends only on the arguments, not on the platform: directions are rounded to six
/// decimals.
Scene random_view(Scene scene, std::uint64_t seed);

/// Returns the axis-aligned bounding box of all spheres, polygons and cones, in scene units; the box is empty
/// (isEmpty()) if the scene has only planes.
Imath::Box3d scene_box(const Scene& scene);

}  // namespace raya
