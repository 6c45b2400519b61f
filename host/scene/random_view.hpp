// Other views of a scene, drawn at random: what one picture shows may be an accident of its view.
#pragma once
#include <cstdint>

#include "host/scene/scene.hpp"

namespace raya {

inline constexpr double kLowestView = 5, kHighestView = 75;  // degrees above the level of what is looked at

/// The scene from another place, at the same distance from the point that its view looks at and with the same angle.
/// The place is drawn evenly from the part of the sphere about that point between the two heights; above is where the
/// view's `up` points. A function of its arguments, the same on every platform: directions have six decimals.
Scene random_view(Scene scene, std::uint64_t seed);

}  // namespace raya
