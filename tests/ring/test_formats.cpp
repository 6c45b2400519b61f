// Images in reduced formats: the sphere filter changes no bit of an image, and images agree with the reference.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <random>

#include "host/scene/generate.hpp"
#include "tests/reference/reference.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

// Returns spheres that are hard cases for the filter's bounds: spheres that touch or nest, tiny, distant and half
// buried spheres, and spheres seen from inside.
Scene hard_spheres(std::uint32_t seed) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Scene scene;
    scene.name = "hard spheres";
    scene.view = {.from = {0, -6, 1.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle_degrees = 50};
    scene.background = {0.3, 0.4, 0.6};
    scene.lights = {{{4, -5, 6}, {}}, {{-3, 1, 2}, {}}};
    scene.surfaces = {{.colour = {0.9, 0.5, 0.3}, .diffuse = 0.6, .specular = 0.4, .shine = 30},
                      {.colour = {1, 1, 1},
                       .diffuse = 0.1,
                       .specular = 0.1,
                       .shine = 90,
                       .transmittance = 0.8,
                       .refraction_index = 1.4}};
    for (int i = 0; i < 25; ++i) {
        const Vec3 centre(uniform(-2, 2), uniform(-2, 2), uniform(-2, 2));
        const double radius = std::pow(10, uniform(-2.5, 0));
        scene.spheres.push_back({centre, radius, i % 2});
        if (i % 3 == 0) scene.spheres.push_back({centre + Vec3(0, 0, radius * 1.5), radius / 2, 0});  // touching
        if (i % 4 == 0) scene.spheres.push_back({centre, radius * 0.9, 1});                           // nested
        if (i % 5 == 0) scene.spheres.push_back({centre, -radius * 1.2, 0});  // seen from inside
    }
    scene.planes = {{{0, 0, 1}, -1, 0}};
    return scene;
}

}  // namespace

TEST_CASE("the sphere filter changes no bit of the image and no count", "[ring]") {
    for (const char* format : quick(1, {"spa22", "e6m10", "e8m21", "e7m12", "e6m15t"}))
        for (const std::uint32_t seed : quick(1, {1u, 2u, 3u})) {
            CAPTURE(format, seed);
            const Scene scene = hard_spheres(seed);
            const RingResult plain =
                render_scene(scene, {.width = 96, .height = 96, .format = format, .filter = false});
            const RingResult filtered = render_scene(scene, {.width = 96, .height = 96, .format = format});
            CHECK(plain.build_options.find("RAYA_FILTER") == std::string::npos);
            CHECK(filtered.build_options.find("-DRAYA_FILTER=1") != std::string::npos);
            CHECK(plain.events[RAYA_REFRACTED] > 100);
            CHECK(pixel_hash(filtered.image) == pixel_hash(plain.image));
            CHECK(filtered.events == plain.events);
        }
}

TEST_CASE("the sphere filter changes no image or count of thousands of spheres", "[ring]") {
    const Scene scenes[] = {generate_balls(3), generate_random(500, 3)};
    for (const Scene& scene : scenes) {
        const RingResult plain = render_scene(scene, {.width = 48, .height = 48, .format = "spa22", .filter = false});
        const RingResult filtered = render_scene(scene, {.width = 48, .height = 48, .format = "spa22"});
        CHECK(pixel_hash(filtered.image) == pixel_hash(plain.image));
        CHECK(filtered.events == plain.events);
    }
}

TEST_CASE("the sphere filter is off if its error bounds do not hold", "[ring]") {
    const NumberFormat spa22 = parse_format("spa22");
    CHECK(filters_are_valid(spa22, 16384));
    CHECK_FALSE(filters_are_valid(spa22, 16385));
    CHECK_FALSE(filters_are_valid(parse_format("fp32"), 1));
    CHECK_FALSE(filters_are_valid(parse_format("e6m9"), 1));
    CHECK(filters_are_valid(parse_format("e5m10"), 64));
    CHECK_FALSE(filters_are_valid(parse_format("e5m10"), 65));
}

TEST_CASE("spa22 images show neither shadow acne nor light leaks", "[ring]") {
    // Counts the pixels that differ by 0.1 or more, except those within an eighth of a pixel of an edge. The format's
    // rounding moves edges by less than an eighth of a pixel; shadow acne and light leaks would affect whole areas.
    constexpr std::uint32_t kSide = 128;
    constexpr double kMaxWrongPixels = 0.002;  // fraction of all pixels
    for (const std::string& name : project_scenes()) {
        CAPTURE(name);
        const Scene scene = project_scene(name);
        const RingResult result = render_scene(scene, {.width = kSide, .height = kSide, .format = "spa22"});
        const reference::Options options{.width = kSide, .height = kSide};
        const reference::Difference d =
            reference::compare(reference::render(scene, options), result.image.rgb, scene, options, 0.1, 1.0 / 8);
        fmt::print("{:8} spa22: PSNR {:4.1f} dB, {} pixels differ by more than 0.1, of which {} graze an edge\n", name,
                   d.psnr_db, d.above_limit, d.excused);
        CHECK(d.above_limit - d.excused <= kMaxWrongPixels * kSide * kSide);
    }
}

}  // namespace raya
