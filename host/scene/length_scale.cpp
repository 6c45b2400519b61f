#include "host/scene/length_scale.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.hpp"

namespace raya {
namespace {

// Powers of two: between a scene that is packed as it is and the format's lower limits; from the largest length of a
// scene with planes that is scaled to their horizon.
constexpr double kSpare = 2, kHorizon = 6;

/// Calls `see` with each length that must not come out as 0: its square is stored, or it stands under a fraction.
template <class See>
void for_each_small_length(const Scene& scene, See&& see) {
    for (const Sphere& s : scene.spheres) see(std::abs(s.radius));
    for (const Cone& c : scene.cones)
        see(std::min(std::max(std::abs(c.base_radius), std::abs(c.apex_radius)), (c.apex - c.base).length()));
    for (const Surface& s : scene.surfaces)
        if (s.checker) see(s.checker->size);
}

double largest_length(const Scene& scene) {
    double largest = scene_extent(scene);
    for (const Light& l : scene.lights)
        for (int axis = 0; axis < 3; ++axis) largest = std::max(largest, std::abs(l.position[axis]));
    for (const Plane& p : scene.planes) largest = std::max(largest, std::abs(p.distance));
    return largest;
}

/// What is left between a scene at scale 1 and the limits of a format, in powers of two; negative: it is beyond them.
struct ScaleRange {
    double above, below;
};

ScaleRange room_of(const LengthScale& scale, const NumberFormat& format) {
    const double smallest = smallest_number(format);
    return {std::log2(farthest_hit(format) / (4 * scale.largest)),
            std::min(std::log2(scale.smallest / std::sqrt(smallest)),
                     std::log2(std::ldexp(scale.largest, -format.fraction_bits - 1) / smallest))};
}

int exponent_for(const ScaleRange& room, bool has_planes) {
    if (room.above >= 0 && room.below >= kSpare) return 0;
    return static_cast<int>(
        std::floor(std::min((room.above - room.below + 1) / 2, room.above - (has_planes ? kHorizon : 0))));
}

[[noreturn]] void refuse(const Scene& scene, const LengthScale& scale, const NumberFormat& format) {
    throw UserError(
        fmt::format("{}: its lengths, from {:.3g} to {:.3g}, are too far apart for {}: where the largest fits, nothing "
                    "below {:.3g} can be seen, and that is every object; remedy: --format fp32, or bring nearer what "
                    "is so far off",
                    scene.name, scale.smallest, scale.largest, format_name(format), scale.least));
}

}  // namespace

LengthScale length_scale(const Scene& scene, const NumberFormat& format) {
    LengthScale scale;
    scale.largest = scale.smallest = largest_length(scene);
    if (scale.largest == 0) return scale;  // planes through the origin, seen from there
    std::uint64_t lengths = 0;
    for_each_small_length(scene, [&](double length) {
        scale.smallest = std::min(scale.smallest, length);
        ++lengths;
    });
    scale.exponent = exponent_for(room_of(scale, format), !scene.planes.empty());
    scale.least = std::ldexp(std::sqrt(smallest_number(format)), -scale.exponent);
    for_each_small_length(scene, [&](double length) { scale.vanishing += length < scale.least; });
    const bool has_others = !scene.polygons.empty() || !scene.planes.empty();
    if (scale.vanishing == lengths && lengths > 0 && !has_others) refuse(scene, scale, format);
    return scale;
}

}  // namespace raya
