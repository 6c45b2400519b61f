// The camera on its way round what it looks at, views drawn at random, and the box about a scene's finite objects.
#pragma once
#include <Imath/ImathBox.h>

#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

/// The view after its eye has gone by so many degrees round the axis through `at` along `up`, anticlockwise for who
/// looks against `up`: at the same height and distance. Whole turns change no bit of it, quarter turns have the exact
/// sine and cosine.
View turned(View view, double degrees);

inline constexpr double kLowestView = 5, kHighestView = 75;  // degrees above the level of what is looked at

/// The scene from another place, at the same distance from the point that its view looks at and with the same angle.
/// The place is drawn evenly from the part of the sphere about that point between the two heights; above is where the
/// view's `up` points. A function of its arguments, the same on every platform: directions have six decimals.
Scene random_view(Scene scene, std::uint64_t seed);

/// The smallest box with sides along the axes that holds all spheres, polygons and cones, scene units; empty
/// (isEmpty()) of a scene of planes alone. Patches count by their corners.
Imath::Box3d scene_box(const Scene& scene);

}  // namespace raya
