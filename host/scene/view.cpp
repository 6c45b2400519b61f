#include "host/scene/view.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/scene/outline.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

/// Cosine and sine of an angle; exact for quarter turns.
struct Direction {
    double cosine, sine;
};

Direction direction_at(double degrees) {
    const double quarters = std::round(degrees / 90), remainder = (degrees - 90 * quarters) * std::numbers::pi / 180;
    const double c = std::cos(remainder), s = std::sin(remainder);
    switch (static_cast<int>(std::fmod(quarters, 4) + 4) % 4) {
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        case 3:
            return {s, -c};
        default:
            return {c, s};
    }
}

double round_to_millionth(double x) { return std::round(x * 1e6) / 1e6 + 0.0; }

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Extends `box` so that it contains a disk perpendicular to `axis`, which has length 1. Along a coordinate axis, the
/// disk extends from its centre by its radius times the sine of the angle between `axis` and the coordinate axis.
void extend_by_disk(Imath::Box3d& box, const Vec3& centre, double radius, const Vec3& axis) {
    Vec3 extent;
    for (int i = 0; i < 3; ++i) extent[i] = std::abs(radius) * std::sqrt(std::max(0.0, 1 - axis[i] * axis[i]));
    box.extendBy(centre - extent);
    box.extendBy(centre + extent);
}

}  // namespace

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
    view.from = view.at + Vec3(round_to_millionth(direction.x), round_to_millionth(direction.y),
                               round_to_millionth(direction.z)) *
                              arm.length();
    return scene;
}

Imath::Box3d scene_box(const Scene& scene) {
    Imath::Box3d box;
    for (const Sphere& s : scene.spheres) {
        box.extendBy(s.centre - Vec3(std::abs(s.radius)));
        box.extendBy(s.centre + Vec3(std::abs(s.radius)));
    }
    for (const Polygon& p : scene.polygons)
        for (const Vec3& v : p.vertices) box.extendBy(v);
    for (const Cone& c : scene.cones) {
        const Vec3 axis = unit_vector(c.apex - c.base);
        extend_by_disk(box, c.base, c.base_radius, axis);
        extend_by_disk(box, c.apex, c.apex_radius, axis);
    }
    return box;
}

}  // namespace raya
