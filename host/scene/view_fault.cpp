#include "host/scene/view_fault.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "host/scene/nff_tokens.hpp"
#include "host/scene/outline.hpp"

namespace raya {

std::string view_fault(const View& view) {
    constexpr double kLeastUpAngle = 1e-6;  // sine of the angle between the gaze and up, below which up is no help
    const Vec3 gaze = view.at - view.from;
    if (gaze.length() < kSmallestLength) return "'from' and 'at' are the same point";
    if (!(view.angle_degrees > 0 && view.angle_degrees < 180))
        return fmt::format("the angle is {}: must lie between 0 and 180 degrees", view.angle_degrees);
    if (unit_vector(gaze).cross(unit_vector(view.up)).length() < kLeastUpAngle)
        return "'up' is zero or points along the gaze; turn it";
    return {};
}

bool is_colour(const Colour& colour) {
    const auto [least, most] = std::minmax({colour.x, colour.y, colour.z});
    return least >= 0 && most <= kLargestNumber;
}

}  // namespace raya
