// Random scenes that are hard for accelerators. All have objects of every kind, so that they need the same kernels.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

#include "tests/kernels/random_scene.hpp"
#include "tests/scene/random_below.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {

/// Returns a scene of spheres, polygons and cones of very different sizes that touch, nest and coincide. Many of the
/// polygons are axis-aligned. Every third scene is seen along an axis.
inline Scene crowded_scene(std::uint64_t seed) {
    Scene scene = random_view_scene(seed);
    SplitMix random(seed);
    const auto surface = [&] { return round_surface(random); };
    const auto size = [&] { return std::pow(10.0, random.uniform(-3, 0.3)); };
    for (int i = 0; i < 30; ++i) {
        const Vec3 at = random_point(random, kSceneReach);
        const double r = size();
        scene.spheres.push_back({at, r, surface()});
        if (i % 5 == 0) scene.spheres.push_back({at, r, surface()});                      // a duplicate
        if (i % 5 == 1) scene.spheres.push_back({at, -r / 2, surface()});                 // nested, seen from inside
        if (i % 5 == 2) scene.spheres.push_back({at + Vec3(2 * r, 0, 0), r, surface()});  // touching
    }
    for (int i = 0; i < 20; ++i) {
        const Vec3 at = random_point(random, kSceneReach);
        const Vec3 u(size(), 0, 0), v = i % 2 ? Vec3(0, 0, size()) : Vec3(0, size(), 0);
        scene.polygons.push_back({{at, at + u, at + u + v, at + v}, {}, surface()});
        // A star. With six or more corners it is concave.
        Polygon star{{}, {}, surface()};
        const std::uint32_t corners = 3 + random_below(random, 40);
        for (std::uint32_t k = 0; k < corners; ++k) {
            const double angle = 2 * std::numbers::pi * k / corners, radius = corners > 5 && k % 2 ? 0.5 : 1;
            star.vertices.push_back(-at + radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        scene.polygons.push_back(star);
        const Vec3 apex = at + 0.3 * random_point(random, kSceneReach);
        scene.cones.push_back({at, size(), apex, size(), surface()});
    }
    if (random.next() % 3 == 0) scene.view.from = scene.view.at - Vec3(0, 0, 8);
    return scene;
}

/// Returns a scene that has, for each kind of object, twice as many copies of random objects as original objects. The
/// copies have distant object numbers and random surfaces. So most rays hit several objects at equal distances.
inline Scene scene_with_copies(std::uint64_t seed) {
    Scene scene = random_view_scene(seed);
    SplitMix random(seed);
    const auto add_copies = [&](auto& objects) {
        auto copies = objects;
        const std::size_t count = objects.size();
        for (std::size_t i = 0; i < 2 * count; ++i) {
            auto copy = objects[random_below(random, count)];
            copy.surface = static_cast<int>(random_below(random, 3));
            copies.push_back(copy);
        }
        objects = copies;
    };
    add_copies(scene.spheres);
    add_copies(scene.polygons);
    add_copies(scene.cones);
    return scene;
}

/// Returns triangles in one plane around a corner. The picture shows only a few units in the last place of fp32 around
/// the corner, so rays hit edges of triangles, and a box without a margin for rounding errors would miss hits.
inline Scene scene_of_a_corner(std::uint64_t seed) {
    SplitMix random(seed);
    Scene scene = random_view_scene(seed);
    scene.planes.clear();
    const Vec3 behind(0, 0, 20);  // places the other objects behind the eye
    for (Sphere& sphere : scene.spheres) sphere.centre = sphere.centre + behind;
    for (Polygon& polygon : scene.polygons)
        for (Vec3& corner : polygon.vertices) corner = corner + behind;
    for (Cone& cone : scene.cones) {
        cone.base = cone.base + behind;
        cone.apex = cone.apex + behind;
    }
    const double x = whole_uniform(random, 13) - 5.5, y = whole_uniform(random, 13) - 5.5;
    for (int column = -2; column < 2; ++column)
        for (int row = -2; row < 2; ++row) {
            const Vec3 low(x + column, y + row, 0), high = low + Vec3(1, 1, 0);
            const int surface = static_cast<int>(random_below(random, 3));
            scene.polygons.push_back({{low, low + Vec3(1, 0, 0), high}, {}, surface});
            scene.polygons.push_back({{low, high, low + Vec3(0, 1, 0)}, {}, (surface + 1) % 3});
        }
    scene.view.at = Vec3(x, y, 0);
    scene.view.from = Vec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(3, 9));
    scene.view.angle_degrees = 3e-6;
    return scene;
}

}  // namespace raya
