// Whether the outline of a polygon can be traced.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace raya {

/// Lengths below this are refused: in fp32 they vanish beside the rest of a scene.
inline constexpr double kSmallestLength = 1e-9;

/// How far a vertex may lie from the plane of its polygon, as a share of the polygon's size (the longest side of its
/// box). Files of six digits stray by some 1e-5; a thousandth is a pixel where the polygon spans 1,000.
inline constexpr double kFlatness = 1e-3;

enum class OutlineFault { kNone, kNoArea, kNotFlat };

/// What is wrong with an outline, and that as the end of a sentence that begins "the polygon".
struct OutlineVerdict {
    OutlineFault fault = OutlineFault::kNone;
    std::string reason;
};

/// Drops vertices that repeat their neighbour, with their normals. Whether the outline crosses itself is not looked at.
OutlineVerdict tidy_outline(Polygon& polygon);

/// `v` with length 1. A vector that has it already, to rounding, is left as it is, so that a scene survives being
/// written and read. The zero vector is returned as it is.
Vec3 unit_vector(const Vec3& v);

}  // namespace raya
