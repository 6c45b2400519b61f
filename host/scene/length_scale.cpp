#include "host/scene/length_scale.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.hpp"

namespace raya {
namespace {

// Margins as exponents of two. kMinMargin: minimum margin between the lengths of an unscaled scene and the format's
// lower limits. kPlaneMargin: margin between the largest length of a scaled scene and the format's upper limit, if the
// scene has planes, which extend to the horizon.
constexpr double kMinMargin = 2, kPlaneMargin = 6;

/// Calls visit(length) for each length that must not be flushed to 0, because the job stores the square of the length
/// or because kernels divide by the length.
template <class Visit>
void for_each_small_length(const Scene& scene, Visit&& visit) {
    for (const Sphere& s : scene.spheres) visit(std::abs(s.radius));
    for (const Cone& c : scene.cones)
        visit(std::min(std::max(std::abs(c.base_radius), std::abs(c.apex_radius)), (c.apex - c.base).length()));
    for (const Surface& s : scene.surfaces)
        if (s.checker) visit(s.checker->size);
}

double largest_length(const Scene& scene) {
    double largest = scene_extent(scene);
    for (const Light& l : scene.lights)
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(l.position[axis]));
    for (const Plane& p : scene.planes) largest = std::max(largest, std::abs(p.distance));
    return largest;
}

/// The margins between the lengths of an unscaled scene and the limits of a format, as exponents of two. A margin is
/// negative if its limit is exceeded.
struct ScaleMargins {
    double to_upper;  // to the upper limit
    double to_lower;  // to the nearer of the two lower limits
};

ScaleMargins margins_of(const LengthScale& scale, const NumberFormat& format) {
    const double smallest_of_format = smallest_number(format);
    return {std::log2(farthest_hit(format) / (4 * scale.largest_length)),
            std::min(std::log2(scale.smallest_length / std::sqrt(smallest_of_format)),
                     std::log2(std::ldexp(scale.largest_length, -format.fraction_bits - 1) / smallest_of_format))};
}

int exponent_for(const ScaleMargins& margins, bool has_planes) {
    if (margins.to_upper >= 0 && margins.to_lower >= kMinMargin) return 0;
    return static_cast<int>(std::floor(
        std::min((margins.to_upper - margins.to_lower + 1) / 2, margins.to_upper - (has_planes ? kPlaneMargin : 0))));
}

[[noreturn]] void refuse(const Scene& scene, const LengthScale& scale, const NumberFormat& format) {
    throw UserError(
        fmt::format("{}: the range of its lengths, {:.3g} to {:.3g}, is too wide for {}: scaled to the largest length, "
                    "all objects are below the smallest visible length, {:.3g}; remedy: --format fp32, or move distant "
                    "objects closer",
                    scene.name, scale.smallest_length, scale.largest_length, format_name(format), scale.min_visible));
}

}  // namespace

LengthScale length_scale(const Scene& scene, const NumberFormat& format) {
    LengthScale scale;
    scale.largest_length = scale.smallest_length = largest_length(scene);
    if (scale.largest_length == 0) return scale;  // only planes through the origin, with the eye at the origin
    std::uint64_t lengths = 0;
    for_each_small_length(scene, [&](double length) {
        scale.smallest_length = std::min(scale.smallest_length, length);
        ++lengths;
    });
    scale.exponent = exponent_for(margins_of(scale, format), !scene.planes.empty());
    scale.min_visible = std::ldexp(std::sqrt(smallest_number(format)), -scale.exponent);
    for_each_small_length(scene, [&](double length) { scale.vanishing_count += length < scale.min_visible; });
    const bool has_flat_objects = !scene.polygons.empty() || !scene.planes.empty();
    if (scale.vanishing_count == lengths && lengths > 0 && !has_flat_objects) refuse(scene, scale, format);
    return scale;
}

}  // namespace raya
