// Random rays aimed at objects. Most are aimed at silhouettes, edges, rims and corners, where rounding decides whether
// a kernel finds a hit.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host/model/number_format.hpp"
#include "host/scene/packer.hpp"
#include "host/scene/polygon.hpp"
#include "host/scene/scene.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/kernels/probe.hpp"
#include "tests/kernels/random_scene.hpp"
#include "tests/reference/reference.hpp"

namespace raya {

inline std::uint32_t below(SplitMix& random, std::uint32_t end) {
    return static_cast<std::uint32_t>(random.next() % end);
}

inline Vec3 axis_direction(SplitMix& random) {
    Vec3 d(0);
    d[static_cast<int>(below(random, 3))] = below(random, 2) == 0 ? 1 : -1;
    return d;
}

/// Bounds of rays that are not wide in a format. Each origin O and each direction D satisfies
///   |O_i| <= reach and | |D|^2 - 1 | <= RAYA_STRETCH
struct RayBounds {
    NumberFormat format;
    double reach = 0;

    /// Returns the spacing of the format's numbers in [1, 2).
    double unit() const { return std::ldexp(1.0, -format.fraction_bits); }
    Vec3 rounded(const Vec3& v) const {
        Vec3 result;
        for (int axis = 0; axis < 3; ++axis) result[axis] = round_to_format(v[axis], format);
        return result;
    }
};

/// Returns the scene scaled by `scale`. Each object is also scaled by its own random factor, 2^-9 to 2. About a third
/// of the cones are aligned with a coordinate axis.
inline Scene with_random_sizes(Scene scene, SplitMix& random, double scale) {
    const auto random_factor = [&] { return std::exp2(random.uniform(-9, 1)); };
    scene.view.from *= scale;
    for (Sphere& s : scene.spheres) s = {scale * s.centre, scale * random_factor() * s.radius, s.surface};
    for (Plane& p : scene.planes) p.distance *= scale;
    for (Polygon& p : scene.polygons) {
        const double factor = random_factor();
        const Vec3 first = p.vertices[0];
        for (Vec3& v : p.vertices) v = scale * (first + factor * (v - first));
    }
    for (Cone& c : scene.cones) {
        const double factor = random_factor();
        if (below(random, 3) == 0) c.apex = c.base + (c.apex - c.base).length() * axis_direction(random);
        c = {scale * c.base, scale * factor * c.base_radius, scale * (c.base + factor * (c.apex - c.base)),
             scale * factor * c.apex_radius, c.surface};
    }
    return scene;
}

/// The target of a ray: a point of an object, and a direction in which a ray through the point grazes the object.
struct Aim {
    Vec3 point{0}, tangent{0};
};

/// Returns a random unit vector perpendicular to `axis`.
inline Vec3 perpendicular(SplitMix& random, const Vec3& axis) {
    for (;;) {
        const Vec3 v = axis.cross(random_direction(random));
        if (v.length() > 0.1 * axis.length()) return v.normalized();
    }
}

inline Aim aim_at(SplitMix& random, const Sphere& s) {
    const Vec3 normal = random_direction(random);
    return {s.centre + std::abs(s.radius) * normal, perpendicular(random, normal)};
}

/// Aims at an edge or a corner of the polygon; `tangent` lies in its plane.
inline Aim aim_at(SplitMix& random, const Polygon& p) {
    const std::size_t i = below(random, static_cast<std::uint32_t>(p.vertices.size()));
    const Vec3 start = p.vertices[i], side = p.vertices[(i + 1) % p.vertices.size()] - start;
    return {start + (below(random, 3) == 0 ? 0 : random.uniform(0, 1)) * side,
            perpendicular(random, newell_normal(p.vertices).normalized())};
}

/// Aims at the side, a rim or the axis of the cone; `tangent` lies along the side or around the axis.
inline Aim aim_at(SplitMix& random, const Cone& c) {
    static constexpr std::array<double, 4> kEnds = {0, 1, 1e-3, 1 - 1e-3};
    const Vec3 axis = (c.apex - c.base).normalized(), outward = perpendicular(random, axis);
    const double fraction = below(random, 2) == 0 ? kEnds[below(random, kEnds.size())] : random.uniform(0, 1);
    const double radius = std::abs(c.base_radius) + fraction * (std::abs(c.apex_radius) - std::abs(c.base_radius));
    const Vec3 point = c.base + fraction * (c.apex - c.base) + (below(random, 8) == 0 ? 0 : radius) * outward;
    const Vec3 side = c.apex - c.base + (std::abs(c.apex_radius) - std::abs(c.base_radius)) * outward;
    const Vec3 rim_tangent = axis.cross(outward),
               mixed = random.uniform(-1, 1) * side.normalized() + random.uniform(-1, 1) * rim_tangent;
    return {point, below(random, 3) == 0   ? side.normalized()
                   : below(random, 2) == 0 ? rim_tangent
                                           : mixed.normalized()};
}

inline Aim aim_at(SplitMix& random, const Scene& scene, std::size_t number) {
    if (number < scene.spheres.size()) return aim_at(random, scene.spheres[number]);
    number -= scene.spheres.size() + scene.planes.size();
    if (number < scene.polygons.size()) return aim_at(random, scene.polygons[number]);
    return aim_at(random, scene.cones[number - scene.polygons.size()]);
}

/// Returns the distance from a point along `direction` to the surface of the cube of allowed origins. The cube contains
/// the points whose coordinates do not exceed `reach` in absolute value.
inline double distance_within_reach(const RayBounds& bounds, const Vec3& point, const Vec3& direction) {
    double distance = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis)
        if (direction[axis] != 0)
            distance =
                std::min(distance, (std::copysign(bounds.reach, direction[axis]) - point[axis]) / direction[axis]);
    return std::max(distance, 0.0);
}

/// Returns an origin for a ray towards the aim. Rounding may move the origin slightly beyond the bounds.
inline Vec3 random_origin(SplitMix& random, const RayBounds& bounds, const Aim& aim) {
    const bool grazes = below(random, 2) == 0;
    const Vec3 to_origin = grazes ? (below(random, 2) == 0 ? 1.0 : -1.0) * aim.tangent : random_direction(random);
    const double distance = distance_within_reach(bounds, aim.point, to_origin);
    switch (below(random, 4)) {
        case 0:
            return aim.point + distance * to_origin;
        case 1:
            return aim.point + random.uniform(0, distance) * to_origin;
        case 2:
            return aim.point + distance * std::exp2(random.uniform(-12, 0)) * to_origin;
        default: {  // a corner of the cube of allowed origins
            Vec3 corner;
            for (int axis = 0; axis < 3; ++axis) corner[axis] = (below(random, 2) == 0 ? 1 : -1) * bounds.reach;
            return grazes ? aim.point + distance * to_origin : corner;
        }
    }
}

/// Returns a ray towards the aim. Its direction has an error of a few units in the last place. The direction's length
/// is 1 or another length that RAYA_STRETCH allows.
inline reference::Ray random_aimed_ray(SplitMix& random, const RayBounds& bounds, Aim aim) {
    if (below(random, 2) == 0) aim.point = bounds.rounded(aim.point);
    const double stretch = bounds.format.is_fp32() ? 0x1p-18 : 16 * bounds.unit();  // RAYA_STRETCH
    for (;;) {
        const Vec3 start = bounds.rounded(random_origin(random, bounds, aim));
        const Vec3 arm = aim.point - start;
        const double distance = arm.length(), blur = below(random, 4) * bounds.unit() * random.uniform(0, 7) * distance;
        if (distance == 0) continue;
        const double length = below(random, 2) == 0 ? 1 : 1 + random.uniform(-0.5, 0.5) * stretch;
        const Vec3 d = bounds.rounded(length * (arm + blur * random_direction(random)).normalized());
        double max_coordinate = 0;
        for (int axis = 0; axis < 3; ++axis) max_coordinate = std::max(max_coordinate, std::abs(start[axis]));
        if (max_coordinate <= bounds.reach && std::abs(d.length2() - 1) <= stretch) return {start, d};
    }
}

/// Rays, and the objects that they are aimed at. Rays 16 i to 16 i + 15 are aimed at objects[i].
struct AimedRays {
    std::vector<std::uint32_t> objects;  // object numbers in the job
    std::vector<reference::Ray> rays;
};

/// Returns 16 * `rounds` rays aimed at each finite object.
inline AimedRays aim_at_all(SplitMix& random, const Scene& scene, const RayBounds& bounds, int rounds) {
    AimedRays aimed;
    const std::vector<int> numbers = object_numbers(scene);
    for (int round = 0; round < rounds; ++round)
        for (std::uint32_t object = 0; object < numbers.size(); ++object) {
            const auto number = static_cast<std::size_t>(numbers[object]);
            if (number >= scene.spheres.size() && number < scene.spheres.size() + scene.planes.size()) continue;
            aimed.objects.push_back(object);
            for (std::size_t i = 0; i < kMaxLanes; ++i)
                aimed.rays.push_back(random_aimed_ray(random, bounds, aim_at(random, scene, number)));
        }
    return aimed;
}

}  // namespace raya
