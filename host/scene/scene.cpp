#include "host/scene/scene.hpp"

#include <fmt/core.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "host/error.hpp"
#include "host/scene/polygon.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

/// Intensity of each light without a colour, and of ambient light, in a scene of n lights (SPD).
double default_intensity(std::size_t lights) {
    const auto n = static_cast<double>(lights);
    return std::sqrt(n) / (2 * n);
}

using SurfaceKey = std::array<double, 16>;

/// Returns all numbers of a surface, so that equal surfaces have equal keys.
SurfaceKey surface_key(const Surface& s) {
    const Checker c = s.checker.value_or(Checker{Colour(0), Colour(0), 0});
    return {s.colour.x, s.colour.y, s.colour.z, s.diffuse, s.specular, s.shine, s.transmittance, s.refraction_index,
            c.even.x,   c.even.y,   c.even.z,   c.odd.x,   c.odd.y,    c.odd.z, c.size,          s.checker ? 1.0 : 0.0};
}

}  // namespace

void merge_equal_surfaces(Scene& scene) {
    const std::vector<Surface> old_surfaces = std::exchange(scene.surfaces, {});
    std::map<SurfaceKey, int> index_of_key;
    std::vector<int> new_index(old_surfaces.size(), -1);  // new index of each old surface; -1: none so far
    const auto index_of = [&](std::size_t surface) {
        if (new_index.at(surface) >= 0) return new_index[surface];
        const auto [entry, added] =
            index_of_key.try_emplace(surface_key(old_surfaces[surface]), static_cast<int>(index_of_key.size()));
        if (added) scene.surfaces.push_back(old_surfaces[surface]);
        return new_index[surface] = entry->second;
    };
    const auto renumber = [&](auto& objects) {
        for (auto& object : objects) object.surface = index_of(static_cast<std::size_t>(object.surface));
    };
#define RAYA_RENUMBER(kind, kinds, KIND) renumber(scene.kinds);
    RAYA_OBJECT_LIST(RAYA_RENUMBER)
}

void drop_objects(Scene& scene) {
    // `= {}` would keep the vectors' memory.
#define RAYA_DROP(kind, kinds, KIND) scene.kinds = decltype(scene.kinds)();
    RAYA_OBJECT_LIST(RAYA_DROP)
#ifdef __GLIBC__
    malloc_trim(0);  // glibc keeps freed blocks of small size, which the vertices of polygons are
#endif
}

Colour light_colour(const Scene& scene, const Light& light) {
    return light.colour ? *light.colour : Colour(default_intensity(scene.lights.size()));
}

double ambient_intensity(const Scene& scene) {
    return scene.lights.empty() ? 1.0 : default_intensity(scene.lights.size());
}

double scene_extent(const Scene& scene) {
    double extent = largest_coordinate(scene.view.from);
    for (const Sphere& s : scene.spheres) extent = std::max(extent, largest_coordinate(s.centre) + std::abs(s.radius));
    for (const Polygon& p : scene.polygons)
        for (const Vec3& v : p.vertices) extent = std::max(extent, largest_coordinate(v));
    for (const Cone& c : scene.cones) {
        extent = std::max(extent, largest_coordinate(c.base) + std::abs(c.base_radius));
        extent = std::max(extent, largest_coordinate(c.apex) + std::abs(c.apex_radius));
    }
    return extent;
}

namespace {

/// Returns cosine and sine of an angle; exact for quarter turns.
std::pair<double, double> direction_at(double degrees) {
    const double quarters = std::round(degrees / 90), remainder = (degrees - 90 * quarters) * std::numbers::pi / 180;
    const double c = std::cos(remainder), s = std::sin(remainder);
    const std::array<std::pair<double, double>, 4> turns = {{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
    return turns[static_cast<std::size_t>(std::fmod(quarters, 4) + 4) % 4];
}

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

}  // namespace

// Along a coordinate axis, the disk extends from its centre by its radius times the sine of the angle between `axis`
// and the coordinate axis.
void extend_by_disk(Box& box, const Vec3& centre, double radius, const Vec3& axis) {
    Vec3 extent;
    for (int i = 0; i < 3; ++i) extent[i] = std::abs(radius) * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    box.extend(centre - extent);
    box.extend(centre + extent);
}

View turned(View view, double degrees) {
    const double angle = std::fmod(degrees, 360);
    if (angle == 0) return view;
    const auto [cosine, sine] = direction_at(angle);
    const Vec3 axis = view.up.normalized(), arm = view.from - view.at;
    // Rodrigues' rotation formula.
    view.from = view.at + arm * cosine + axis.cross(arm) * sine + axis * (axis.dot(arm) * (1 - cosine));
    return view;
}

Scene random_view(Scene scene, std::uint64_t seed) {
    View& view = scene.view;
    const Vec3 up = view.up.normalized(), arm = view.from - view.at;
    const Vec3 not_parallel = std::abs(up.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 east = up.cross(not_parallel).normalized(), north = up.cross(east);
    SplitMix random(seed);
    // A uniform point on a sphere has a uniform height, because the area of a zone is proportional to its height
    // (Archimedes).
    const double height =
        random.uniform(std::sin(radians(kMinElevationDegrees)), std::sin(radians(kMaxElevationDegrees)));
    const double azimuth = random.uniform(0, 2 * std::numbers::pi), horizontal = std::sqrt(1 - height * height);
    const Vec3 direction = up * height + (east * std::cos(azimuth) + north * std::sin(azimuth)) * horizontal;
    view.from = view.at + rounded(direction, 1e6) * arm.length();
    return scene;
}

Box scene_box(const Scene& scene) {
    Box box;
    for (const Sphere& s : scene.spheres) {
        box.extend(s.centre - Vec3(std::abs(s.radius)));
        box.extend(s.centre + Vec3(std::abs(s.radius)));
    }
    for (const Polygon& p : scene.polygons)
        for (const Vec3& v : p.vertices) box.extend(v);
    for (const Cone& c : scene.cones) {
        const Vec3 axis = unit_vector(c.apex - c.base);
        extend_by_disk(box, c.base, c.base_radius, axis);
        extend_by_disk(box, c.apex, c.apex_radius, axis);
    }
    return box;
}

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
    for (const Light& l : scene.lights) largest = std::max(largest, largest_coordinate(l.position));
    for (const Plane& p : scene.planes) largest = std::max(largest, std::abs(p.distance));
    return largest;
}

/// Returns the exponent of the scale, from the margins between the lengths of the unscaled scene and the limits of the
/// format: the upper one, and the nearer of the two lower ones. A margin is negative if its limit is exceeded.
int exponent_for(const LengthScale& scale, const NumberFormat& format, bool has_planes) {
    const double smallest_of_format = smallest_number(format);
    const double to_upper = std::log2(farthest_hit(format) / (4 * scale.largest_length));
    const double to_lower =
        std::min(std::log2(scale.smallest_length / std::sqrt(smallest_of_format)),
                 std::log2(std::ldexp(scale.largest_length, -format.fraction_bits - 1) / smallest_of_format));
    if (to_upper >= 0 && to_lower >= kMinMargin) return 0;
    return static_cast<int>(
        std::floor(std::min((to_upper - to_lower + 1) / 2, to_upper - (has_planes ? kPlaneMargin : 0))));
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
    scale.exponent = exponent_for(scale, format, !scene.planes.empty());
    scale.min_visible = std::ldexp(std::sqrt(smallest_number(format)), -scale.exponent);
    for_each_small_length(scene, [&](double length) { scale.vanishing_count += length < scale.min_visible; });
    const bool has_flat_objects = !scene.polygons.empty() || !scene.planes.empty();
    if (scale.vanishing_count == lengths && lengths > 0 && !has_flat_objects)
        throw UserError(fmt::format(
            "{}: the range of its lengths, {:.3g} to {:.3g}, is too wide for {}: scaled to the largest length, all "
            "objects "
            "are below the smallest visible length, {:.3g}; remedy: --format fp32, or move distant objects closer",
            scene.name, scale.smallest_length, scale.largest_length, format_name(format), scale.min_visible));
    return scale;
}

}  // namespace raya
