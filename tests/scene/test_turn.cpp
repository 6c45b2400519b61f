// turned() keeps the distance and height of the eye and rotates it by the angle; whole and quarter turns are exact.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/scene/scene.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

View random_viewpoint(SplitMix& random) {
    const auto coordinate = [&] { return random.uniform(-5, 5); };
    View view;
    view.from = {coordinate(), coordinate(), coordinate()};
    view.at = {coordinate(), coordinate(), coordinate()};
    view.up = {coordinate(), coordinate(), coordinate()};
    return view;
}

TEST_CASE("a turn changes only the azimuth of the camera's position, by the angle", "[view]") {
    const std::uint64_t seed = 41;
    CAPTURE(seed);
    SplitMix random(seed);
    for (int n = 0; n < 500; ++n) {
        const View view = random_viewpoint(random);
        const double degrees = random.uniform(-1000, 1000);
        CAPTURE(n, degrees);
        View rotated = turned(view, degrees);
        const Vec3 axis = view.up.normalized(), before = view.from - view.at, after = rotated.from - rotated.at;
        CHECK(after.length() == Approx(before.length()).epsilon(1e-12));
        CHECK(after.dot(axis) == Approx(before.dot(axis)).margin(1e-12));
        // Projected onto the plane perpendicular to the axis, the two vectors enclose the angle, counter-clockwise.
        const Vec3 level_before = before - axis * before.dot(axis), level_after = after - axis * after.dot(axis);
        const double angle = std::atan2(axis.dot(level_before.cross(level_after)), level_before.dot(level_after));
        CHECK(std::remainder(angle - degrees * std::numbers::pi / 180, 2 * std::numbers::pi) == Approx(0).margin(1e-9));
        rotated.from = view.from;
        CHECK(rotated == view);
    }
}

TEST_CASE("whole and quarter turns are exact", "[view]") {
    SplitMix random(42);
    for (int n = 0; n < 100; ++n) {
        const View view = random_viewpoint(random);
        for (const double degrees : {0.0, 360.0, -720.0}) CHECK(turned(view, degrees) == view);
    }
    View view;
    view.at = {1, 2, 3};
    view.from = {4, 2, 5};
    view.up = {0, 0, 7};
    CHECK(turned(view, 90).from == Vec3(1, 5, 5));
    CHECK(turned(view, 180).from == Vec3(-2, 2, 5));
    CHECK(turned(view, 270).from == Vec3(1, -1, 5));
    CHECK(turned(view, -90).from == Vec3(1, -1, 5));
    CHECK(turned(view, 450).from == Vec3(1, 5, 5));
}

}  // namespace
}  // namespace raya
