// What an outline of a polygon, a viewpoint and colours must be, whoever gives them: a scene's file or the command
// line.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace raya {

/// Lengths below this count as 0: products of four must fit double precision. What a number format cannot hold next to
/// the scene's largest length is the packer's concern (length_scale.hpp), so that a scene may be in any unit.
inline constexpr double kSmallestLength = 1e-30;

/// How far a vertex may lie from the plane of its polygon, as a share of the polygon's size (the longest side of its
/// box). Files of six digits stray by some 1e-5; a thousandth is a pixel where the polygon spans 1,000.
inline constexpr double kFlatness = 1e-3;

enum class OutlineFault { kNone, kNoArea, kCrosses, kNotFlat };

/// What is wrong with an outline, and that as the end of a sentence that begins "the polygon".
struct OutlineVerdict {
    OutlineFault fault = OutlineFault::kNone;
    std::string reason;
};

/// Drops vertices that repeat their neighbour, with their normals. An outline that crosses itself is detected only
/// where its signed area is 0.
OutlineVerdict tidy_outline(Polygon& polygon);

/// `v` with length 1. A vector that has it already, to rounding, is left as it is, so that a scene survives being
/// written and read. The zero vector is returned as it is.
Vec3 unit_vector(const Vec3& v);

/// Why nothing can be seen from there: "'from' and 'at' are the same point"; empty where it can.
std::string view_fault(const View& view);

/// Whether light can have that colour: components from 0 to kLargestNumber.
bool is_colour(const Colour& colour);

}  // namespace raya
