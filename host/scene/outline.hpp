// Validity of polygon outlines, viewpoints and colours, for scene files and the command line.
#pragma once
#include <string>

#include "host/scene/scene.hpp"

namespace raya {

/// Shorter lengths count as 0: products of four must not underflow a double. A scene may be in any unit; the packer
/// handles lengths that a number format cannot represent next to the largest one (length_scale.hpp).
inline constexpr double kSmallestLength = 1e-30;

/// The maximum distance of a vertex from the plane of its polygon, relative to the polygon's size (the longest side of
/// its bounding box). Files with six digits deviate by about 1e-5; 1e-3 is one pixel if the polygon spans 1,000.
inline constexpr double kFlatness = 1e-3;

enum class OutlineFault { kNone, kNoArea, kCrosses, kNotFlat };

/// The defect of an outline. `reason` completes a sentence that begins with "the polygon".
struct OutlineCheck {
    OutlineFault fault = OutlineFault::kNone;
    std::string reason;
};

/// Removes vertices that repeat their neighbour, with their normals, and checks the outline. A self-intersection is
/// detected only if the signed area is 0.
OutlineCheck clean_outline(Polygon& polygon);

/// Normalises `v`. A vector that has length 1 up to rounding is returned unchanged, so that a scene survives writing
/// and reading; so is the zero vector.
Vec3 unit_vector(const Vec3& v);

/// Returns why a view is invalid: "'from' and 'at' are the same point"; empty if it is valid.
std::string view_error(const View& view);

/// Returns true if all components are in 0..kLargestNumber.
bool is_colour(const Colour& colour);

}  // namespace raya
