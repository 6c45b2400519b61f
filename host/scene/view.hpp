// Rotation of the camera around its target, random views, and the bounding box of a scene.
#pragma once
#include <Imath/ImathBox.h>

#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

/// Rotates the eye by `degrees` around the axis through `at` along `up`, anticlockwise as seen from above (`up` towards
/// the viewer). Height and distance stay the same. Full turns change no bit; quarter turns use the exact sine and
/// cosine.
View turned(View view, double degrees);

inline constexpr double kLowestView = 5, kHighestView = 75;  // elevation above the target, degrees

/// The scene with a random eye at the same distance from `at` and with the same angle. The eye is uniform on the part
/// of the sphere around `at` between the two elevations above the plane perpendicular to `up`. A function of its
/// arguments, the same on every platform: directions are rounded to six decimals.
Scene random_view(Scene scene, std::uint64_t seed);

/// The axis-aligned bounding box of all spheres, polygons and cones, scene units; empty (isEmpty()) if the scene has
/// only planes. Patches count by their corners.
Imath::Box3d scene_box(const Scene& scene);

}  // namespace raya
