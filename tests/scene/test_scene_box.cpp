// scene_box() returns the smallest box that contains all finite objects.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/scene/scene.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

Vec3 random_vector(SplitMix& random, double magnitude) {
    return {random.uniform(-magnitude, magnitude), random.uniform(-magnitude, magnitude),
            random.uniform(-magnitude, magnitude)};
}

Scene cone_scene(const Cone& cone) {
    Scene scene;
    scene.cones.push_back(cone);
    return scene;
}

TEST_CASE("the bounding box of a cone touches its two circles", "[scene_box]") {
    SplitMix random(77);
    for (int i = 0; i < 200; ++i) {
        const double sign = i % 2 == 0 ? 1 : -1;
        const Cone cone{random_vector(random, 5), sign * random.uniform(0, 2), random_vector(random, 5),
                        sign * random.uniform(0, 2), 0};
        const Box box = scene_box(cone_scene(cone));
        const Vec3 axis = (cone.apex - cone.base).normalized();
        const Vec3 not_parallel = std::abs(axis.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
        const Vec3 u = axis.cross(not_parallel).normalized(), v = axis.cross(u);
        Box circles_box;
        constexpr int kPoints = 720;
        for (int k = 0; k < kPoints; ++k) {
            const double angle = 2 * std::numbers::pi * k / kPoints;
            const Vec3 direction = u * std::cos(angle) + v * std::sin(angle);
            circles_box.extend(cone.base + direction * cone.base_radius);
            circles_box.extend(cone.apex + direction * cone.apex_radius);
        }
        CAPTURE(i);
        for (int axis_number = 0; axis_number < 3; ++axis_number) {
            CHECK(box.min[axis_number] == Approx(circles_box.min[axis_number]).margin(1e-4));
            CHECK(box.max[axis_number] == Approx(circles_box.max[axis_number]).margin(1e-4));
            CHECK(box.min[axis_number] <= circles_box.min[axis_number] + 1e-12);
            CHECK(box.max[axis_number] >= circles_box.max[axis_number] - 1e-12);
        }
    }
}

TEST_CASE("the bounding box contains spheres of either sign of radius and polygons, and ignores planes",
          "[scene_box]") {
    Scene scene;
    scene.planes.push_back({{0, 0, 1}, 7, 0});
    CHECK(scene_box(scene).is_empty());
    scene.spheres.push_back({{1, 2, 3}, -2, 0});
    CHECK(scene_box(scene) == Box{{-1, 0, 1}, {3, 4, 5}});
    scene.polygons.push_back({{{0, 0, 0}, {9, 0, 0}, {0, -4, 0}}, {}, 0});
    CHECK(scene_box(scene) == Box{{-1, -4, 0}, {9, 4, 5}});
}

}  // namespace
}  // namespace raya
