// The power of two that scales a scene's lengths into the range of a number format. Multiplication by it is exact, so
// the image is the same bit for bit at any scale, unless numbers come close to the format's limits.
#pragma once
#include <cstdint>

#include "host/model/number_format.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct LengthScale {
    int exponent = 0;     // lengths are multiplied by 2^exponent when the scene is packed
    double largest = 0;   // largest coordinate of eye, lights and finite objects, or distance of a plane; scene units
    double smallest = 0;  // smallest radius, height of a cone, or side of a checker's squares; scene units
    double min_visible = 0;       // smallest length that is visible at that scale, scene units
    std::uint64_t vanishing = 0;  // number of spheres, cones and checkers smaller than min_visible
};

/// Chooses the scale of a scene. Let L be the largest length, S the smallest (L if the scene has only polygons and
/// planes), F the maximum distance of a hit, N the format's smallest number and u = 2^-(Y+1).
///   - Distances within the scene are at most 2 sqrt(3) L, so 4 L <= F makes every hit count.
///   - Radii are squared: S >= sqrt(N). The rounding error of L must be representable: u L >= N.
/// If these hold, the latter two with a margin of a factor of 4, the scale is 1. Otherwise it is the power of two with
/// equal margins above and below, or, if the scene's range is wider than the format's, the largest one with a margin
/// above (of 64 L if there are planes, which extend to the horizon). Near the lower limits, squares of small
/// differences are flushed to 0, so images have fewer digits than the same scene in larger units. UserError with both
/// lengths if no object would be large enough to be visible.
LengthScale length_scale(const Scene& scene, const NumberFormat& format);

}  // namespace raya
