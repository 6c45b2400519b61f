// Tests that compare() detects wrong pixels and excuses only edges, and that render() agrees with trace_pixel().
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

/// Returns a scene with flat regions and edges: a sphere, half in the shadow of another sphere, in front of a
/// background.
Scene two_spheres() {
    Scene scene;
    scene.view = {.from = {0, 0, 5}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle_degrees = 40};
    scene.background = {0.2, 0.3, 0.4};
    scene.surfaces = {{.colour = {0.8, 0.6, 0.4}, .diffuse = 0.7, .specular = 0.2, .shine = 10, .checker = {}},
                      {.diffuse = 0.1, .specular = 0.2, .transmittance = 0.6, .refraction_index = 1.4, .checker = {}}};
    scene.spheres = {{{0, 0, 0}, 1, 0}, {{0.8, 0.8, 1}, 0.4, 1}};
    scene.lights = {{{4, 4, 5}, {}}};
    return scene;
}

std::vector<float> floats(const Image& image) {
    std::vector<float> rgb;
    for (const Colour& pixel : image.pixels)
        for (int i = 0; i < 3; ++i) rgb.push_back(static_cast<float>(pixel[i]));
    return rgb;
}

constexpr Options kOptions{.width = 33, .height = 33};

/// Returns the index of pixel (x, y)'s first value in the result of floats().
std::size_t value_index(int x, int y) { return static_cast<std::size_t>(3 * (y * kOptions.width + x)); }

TEST_CASE("an image agrees with itself; render() agrees with trace_pixel()") {
    const Scene scene = two_spheres();
    const Image image = render(scene, kOptions);
    const Difference difference = compare(image, floats(image), scene, kOptions);
    CHECK(difference.psnr_db > 140);
    CHECK(difference.largest < 1e-7);
    CHECK((difference.above_limit == 0 && difference.excused == 0));
    Counts counts;
    for (int y = 0; y < 33; ++y)
        for (int x = 0; x < 33; ++x)
            REQUIRE(trace_pixel(scene, kOptions, x, y, counts) == image.pixels[value_index(x, y) / 3]);
    CHECK(counts == image.counts);
    CHECK(counts.primary == 33 * 33);
    CHECK((counts.primary_hits > 200 && counts.refracted > 20 && counts.shadow_hits > 20));
}

TEST_CASE("pixels on an edge are excused, other pixels are not") {
    const Scene scene = two_spheres();
    const Image image = render(scene, kOptions);
    const auto with_error_at = [&](int x, int y, float error) {
        std::vector<float> rgb = floats(image);
        rgb[value_index(x, y) + 1] += error;
        return compare(image, rgb, scene, kOptions);
    };
    const Difference flat_region = with_error_at(12, 20, 0.1F);
    CHECK((flat_region.above_limit == 1 && flat_region.excused == 0));
    CHECK(flat_region.largest == Approx(0.1).epsilon(1e-5));
    CHECK(flat_region.psnr_db == Approx(10 * std::log10(33 * 33 * 3 / 0.01)).epsilon(1e-5));
    CHECK(with_error_at(0, 0, 0.1F).excused == 0);
    CHECK(with_error_at(12, 20, 0.007F).above_limit == 0);
    CHECK(with_error_at(12, 20, std::nanf("")).above_limit == 1);
    CHECK(with_error_at(12, 20, std::nanf("")).psnr_db < 0);
    CHECK(with_error_at(12, 20, HUGE_VALF).above_limit == 1);

    // The silhouette of a sphere of radius 1, seen from distance 5, lies where tan(angle) = 1 / sqrt(24).
    const double edge = 16.5 * (1 + 1 / std::sqrt(24) / std::tan(20 * std::numbers::pi / 180)) - 0.5;
    const int x = static_cast<int>(std::lround(edge));
    CAPTURE(edge, x);
    CHECK(grazes_edge(scene, kOptions, x, 16, 1.05 * std::abs(edge - x)));
    CHECK_FALSE(grazes_edge(scene, kOptions, x, 16, 0.1 * std::abs(edge - x)));
}

TEST_CASE("an edge between objects of the same colour counts as an edge") {
    Scene scene = two_spheres();
    scene.spheres.clear();
    scene.lights.clear();
    scene.polygons = {{{{-9, -9, 0}, {0, -9, 0}, {0, 9, 0}, {-9, 9, 0}}, {}, 0},
                      {{{0, -9, 0}, {9, -9, 0}, {9, 9, 0}, {0, 9, 0}}, {}, 0}};
    const Options options{.width = 4, .height = 4};  // the edge lies half a pixel to the right of the second column
    CHECK(grazes_edge(scene, options, 1, 1, 0.51));
    CHECK_FALSE(grazes_edge(scene, options, 1, 1, 0.49));
}

TEST_CASE("values are clamped to 0..1 before they are compared; wrong sizes throw") {
    Scene scene = two_spheres();
    scene.background = {2, 0, 0};
    const Image image = render(scene, kOptions);
    std::vector<float> rgb = floats(image);
    rgb[value_index(0, 0)] = 3;
    rgb[value_index(0, 0) + 1] = -1;
    CHECK(compare(image, rgb, scene, kOptions).above_limit == 0);
    rgb.pop_back();
    CHECK_THROWS_AS(compare(image, rgb, scene, kOptions), std::invalid_argument);
}

}  // namespace
}  // namespace raya::reference
