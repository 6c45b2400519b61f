// The power of two that brings a scene's lengths into the range of a number format. A multiplication by it is exact, so
// an image in which no number comes near the format's limits is the same, bit for bit, at any scale.
#pragma once
#include <cstdint>

#include "host/model/number_format.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct LengthScale {
    int exponent = 0;     // lengths are multiplied by 2^exponent when the scene is packed
    double largest = 0;   // largest coordinate of eye, lights and finite objects, distance of planes; scene units
    double smallest = 0;  // smallest radius, height of a cone, or side of a checker's squares; scene units
    double least = 0;     // what a length must have to be seen at that scale, scene units
    std::uint64_t vanishing = 0;  // spheres, cones and checkers that are smaller
};

/// What a scene's lengths are multiplied by. The rule: let L be the largest length, S the smallest (of a scene of
/// polygons and planes alone L), F the farthest distance of a hit, N the format's smallest number and u = 2^-(Y+1).
///   - Distances within the scene are 2 sqrt(3) L at most: 4 L <= F, so that every hit counts.
///   - Radii are squared: S >= sqrt(N). What L loses to rounding is still a number: u L >= N.
/// Where that holds, the latter two with a factor of 4 to spare, the scale is 1. Elsewhere it is the power of two that
/// leaves as much room above as below, or, in a scene with a wider range than the format, the largest that leaves any
/// above (64 times L more where planes reach to the horizon). Near the lower limits squares of small differences are
/// flushed to 0: images have fewer digits there than the same scene has in larger units. Throws UserError with both
/// lengths where that leaves no object large enough to be seen.
LengthScale length_scale(const Scene& scene, const NumberFormat& format);

}  // namespace raya
