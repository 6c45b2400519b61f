// Choice of the power of two by which a scene's lengths are multiplied, so that they fit the range of a number format.
// The multiplication is exact, so the image is the same bit for bit at any scale, unless numbers come close to the
// format's limits.
#pragma once
#include <cstdint>

#include "host/model/number_format.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct LengthScale {
    int exponent = 0;        // lengths are multiplied by 2^exponent when the scene is packed
    double largest = 0;      // largest coordinate of eye, lights and finite objects, or plane's distance; scene units
    double smallest = 0;     // smallest radius, height of a cone, or side of a checker's squares; scene units
    double min_visible = 0;  // smallest visible length at that scale, scene units
    std::uint64_t vanishing = 0;  // number of spheres, cones and checkers smaller than min_visible
};

/// Chooses the scale of a scene. Let L be LengthScale::largest, S LengthScale::smallest (L if the scene has no such
/// length), F the maximum distance of a hit in the number format, N the format's smallest number, and
/// u = 2^-(Y+1) its relative rounding error. The scaled lengths should satisfy three conditions:
///   - 4 L <= F: distances within the scene are at most 2 sqrt(3) L, so every hit is found.
///   - S >= sqrt(N): the squares of radii are representable.
///   - u L >= N: the rounding error of the largest length is representable.
/// If the unscaled scene satisfies these, the latter two with a margin of a factor of 4, the scale is 1. Otherwise the
/// scale is the power of two with equal margins to the upper and the lower limits, but at most the largest one with
/// 4 L <= F, or with 64 * 4 L <= F if there are planes, which extend to the horizon. Near the lower limits, squares of
/// small differences are flushed to 0, so images have fewer correct digits than images of the same scene in larger
/// units. Throws UserError, with both lengths, if no object would be large enough to be visible.
LengthScale length_scale(const Scene& scene, const NumberFormat& format);

}  // namespace raya
