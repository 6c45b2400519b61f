// Chooses the power of two by which a scene's lengths are multiplied so that they fit the range of a number format. The
// multiplication is exact, so the scale changes no bit of the image unless numbers come close to the format's limits.
#pragma once
#include <cstdint>

#include "host/model/number_format.hpp"
#include "host/scene/scene.hpp"

namespace raya {

struct LengthScale {
    int exponent = 0;  // lengths are multiplied by 2^exponent when the scene is packed
    // Maximum magnitude of the coordinates of eye, lights and finite objects, and of planes' distances; scene units.
    double largest_length = 0;
    double smallest_length = 0;  // scene units; minimum of radii, heights of cones, and sides of checkers' squares
    double min_visible = 0;      // scene units; smallest length that is visible at this scale
    std::uint64_t vanishing_count = 0;  // number of spheres, cones and checkers smaller than min_visible
};

/// Chooses the scale of a scene. L is LengthScale::largest_length. S is LengthScale::smallest_length, or L if the scene
/// has no radius, cone or checker. F is the maximum distance of a hit in the number format, N the format's smallest
/// positive number, and u = 2^-(Y+1) its relative rounding error. The scaled lengths should satisfy three conditions:
///   - 4 L <= F: distances within the scene are at most 2 sqrt(3) L, so every hit is found.
///   - S >= sqrt(N): the squares of radii are representable.
///   - u L >= N: the rounding error of the largest length is representable.
/// The scale is 1 if the unscaled scene satisfies the first condition, and the other two with a margin of a factor
/// of 4. Otherwise the scale is the power of two with equal margins to the upper and the lower limits, but at most the
/// largest one with 4 L <= F, or with 64 * 4 L <= F if there are planes, which extend to the horizon. Near the lower
/// limits, squares of small differences are flushed to 0, so images have fewer correct digits than images of the same
/// scene in larger units. Throws UserError, with L and S in the message, if no object would be large enough to be
/// visible.
LengthScale length_scale(const Scene& scene, const NumberFormat& format);

}  // namespace raya
