// length_scale() scales a scene into the middle of a format's range, and does not scale a scene within the range.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "host/scene/nff.hpp"
#include "host/scene/scene.hpp"
#include "tests/paths.h"
#include "tests/scene/scaled_scene.hpp"

namespace raya {
namespace {
using Catch::Matchers::Contains;

const NumberFormat kFp32{}, kSpa22{6, 15, false}, kSmall{5, 10, false};

/// Returns a scene with a sphere of `radius`, seen from `distance`.
Scene sphere_seen_from(double radius, double distance) {
    Scene scene;
    scene.name = "one.nff";
    scene.view.from = {0, 0, -distance};
    scene.surfaces.emplace_back();
    scene.spheres.push_back({{0, 0, 0}, radius, 0});
    return scene;
}

TEST_CASE("the project's scenes need no scaling in fp32 and in the SPA's format", "[length_scale]") {
    for (const char* name : {"centre", "spheres", "mirrors", "glass", "polygons", "cones", "planes"}) {
        const Scene scene = read_nff(std::string(RAYA_SOURCE_DIR "/scenes/") + name + ".nff");
        CAPTURE(name);
        for (const NumberFormat& format : {kFp32, kSpa22}) {
            CHECK(length_scale(scene, format).exponent == 0);
            CHECK(length_scale(scene, format).vanishing_count == 0);
        }
    }
    for (const int level : {0, 4, 5}) CHECK(length_scale(generate_balls(level), kSpa22).exponent == 0);
}

TEST_CASE("a scene within a format's range is not scaled; outside the range it is scaled to the middle",
          "[length_scale]") {
    // e6m15: the maximum hit distance is 2^15, so the maximum length is 2^13. The minimum radius is 2^-15, which a
    // margin of a factor of 4 raises to 2^-13.
    CHECK(length_scale(sphere_seen_from(1, 8192), kSpa22).exponent == 0);
    CHECK(length_scale(sphere_seen_from(1, 8193), kSpa22).exponent == -8);
    CHECK(length_scale(sphere_seen_from(0x1p-13, 8), kSpa22).exponent == 0);
    CHECK(length_scale(sphere_seen_from(0x1.fp-14, 8), kSpa22).exponent > 0);
    CHECK(length_scale(sphere_seen_from(1, 32), kSmall).exponent == 0);
    CHECK(length_scale(sphere_seen_from(1, 33), kSmall).exponent == -4);
    Scene far_light = sphere_seen_from(1, 4);
    far_light.lights.push_back({{0, 1e6, 0}, {}});
    CHECK(length_scale(far_light, kSpa22).exponent < -6);
    CHECK(length_scale(far_light, kSpa22).largest_length == 1e6);
    Scene far_plane = sphere_seen_from(1, 4);
    far_plane.planes.push_back({{0, 1, 0}, -1e6, 0});
    CHECK(length_scale(far_plane, kSpa22).exponent < -7);
}

TEST_CASE("outside a format's range, a scene twice as large has half the scale", "[length_scale]") {
    std::mt19937 random(14);
    for (int i = 0; i < 300; ++i) {
        const double radius = std::pow(10, std::uniform_real_distribution<double>(-3, 1)(random));
        const double distance = radius * std::pow(10, std::uniform_real_distribution<double>(0.5, 3)(random));
        const Scene scene = sphere_seen_from(radius, distance);
        CAPTURE(i, radius, distance);
        for (const NumberFormat& format : {kSpa22, NumberFormat{8, 7, true}, kFp32}) {
            const int out_of_range = format.exponent_bits == 8 ? 70 : 20;
            for (const int k : {-out_of_range, out_of_range, out_of_range + 9}) {
                const int exponent = length_scale(scaled_scene(scene, std::ldexp(1, k)), format).exponent;
                CHECK(exponent == length_scale(scaled_scene(scene, std::ldexp(1, k + 1)), format).exponent + 1);
                const double largest = std::ldexp(distance, k + exponent), smallest = std::ldexp(radius, k + exponent);
                CHECK(4 * largest <= farthest_hit(format));
                CHECK(smallest * smallest >= smallest_number(format));
            }
        }
    }
}

TEST_CASE("objects too small for the format are counted, and a scene of only such objects is refused",
          "[length_scale]") {
    Scene scene = sphere_seen_from(1, 1e6);
    scene.spheres.push_back({{0, 0, 0}, 1e-5, 0});
    scene.spheres.push_back({{3, 0, 0}, 2e-6, 0});
    const LengthScale scale = length_scale(scene, kSpa22);
    CHECK(scale.vanishing_count == 2);
    CHECK(scale.smallest_length == 2e-6);
    CHECK(scale.min_visible > 1e-5);
    CHECK(scale.min_visible < 1);
    CHECK(length_scale(scene, kFp32).vanishing_count == 0);
    const Scene speck = sphere_seen_from(1e-4, 1e6);
    CHECK_THROWS_AS(length_scale(speck, kSpa22), UserError);
    CHECK_THROWS_WITH(length_scale(speck, kSpa22), Contains("one.nff") && Contains("0.0001 to 1e+06") &&
                                                       Contains("e6m15") && Contains("--format fp32"));
    CHECK_NOTHROW(length_scale(speck, kFp32));
}

}  // namespace
}  // namespace raya
