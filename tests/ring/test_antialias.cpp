// Anti-aliasing on the ring: sample points and thresholds. Numbers of rotations: test_route.cpp. That images do not
// depend on the distribution of the pixels, and equal functions of the whole image: tests/property.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/property/whole_image.hpp"
#include "tests/ring/render_scene.hpp"

namespace raya {
namespace {

using whole_image::count_differences;
using whole_image::value_at;

/// Returns two shiny spheres above a checkered floor. Some colour values exceed 1.
Scene two_spheres() {
    Scene scene;
    scene.background = {0.3, 0.5, 0.8};
    scene.lights = {{{-3, 6, -4}, Colour{1.5, 1.4, 1.1}}};
    scene.surfaces = {{.diffuse = 0.8, .checker = Checker{{0.9, 0.8, 0.7}, {0.3, 0.25, 0.2}, 0.5}},
                      {.colour = {0.9, 0.2, 0.1}, .diffuse = 0.7, .specular = 0.6, .shine = 20},
                      {.colour = {0.2, 0.2, 0.9}, .diffuse = 0.5, .specular = 0.3, .shine = 50}};
    scene.spheres = {{{0.62, 0.1, 5}, 0.6, 1}, {{-0.7, 0.2, 4}, 0.65, 2}};
    scene.planes = {{{0, 1, 0}, -0.15, 0}};
    scene.view.angle_degrees = 40;
    return scene;
}

// Offsets of a pixel's additional sample points, {down, right} in half pixels, in the order of summation.
using Offsets = std::array<std::array<int, 2>, 4>;
constexpr Offsets kAxes = {{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}};
constexpr Offsets kDiagonals = {{{-1, -1}, {-1, 1}, {1, -1}, {1, 1}}};

const Offsets& offsets_of(const Antialias& antialias) {
    return antialias.points == RAYA_POINTS_AXES ? kAxes : kDiagonals;
}

/// Returns the mean of the point (row, column) of the finer image and of the four additional points around this point.
float mean_of_points(const Image& fine, int row, int column, int colour, const RingCase& c) {
    std::array<float, 5> values = {value_at(fine, row, column, colour)};
    for (std::size_t n = 0; n < 4; ++n) {
        const auto& offset = offsets_of(c.antialias)[n];
        values[n + 1] = value_at(fine, row + offset[0], column + offset[1], colour);
    }
    return whole_image::mean_of_five(values, settings_of(c).format);
}

}  // namespace

TEST_CASE("the additional points lie half a pixel away, for any camera", "[ring][antialias]") {
    const Scene scene = project_scene("spheres");
    Session session(choose_device(""));
    constexpr int kWidth = 33, kHeight = 21;
    for (const char* format : {"fp32", "spa22"}) {
        // Doubling the number of intervals exactly halves the steps between pixel corners. The finer image has no
        // points beyond the sample points of the outermost pixels, so these pixels, 104 of 693, are not compared.
        const RingCase fine_case{
            .width = 2 * kWidth - 1, .height = 2 * kHeight - 1, .sampling = Sampling::kCorners, .format = format};
        const Image fine = RingRenderer(session, scene, settings_of(fine_case)).render().image;
        for (const raya_u32 points : {RAYA_POINTS_AXES, RAYA_POINTS_DIAGONALS}) {
            const RingCase c{.width = kWidth,
                             .height = kHeight,
                             .sampling = Sampling::kCorners,
                             .format = format,
                             .antialias = {AntialiasMethod::kSupersample, 0, points}};
            const RingResult result = RingRenderer(session, scene, settings_of(c)).render();
            const Image expected = whole_image::make_image(kWidth, kHeight, [&](int row, int column, int colour) {
                const bool inner = row > 0 && row + 1 < kHeight && column > 0 && column + 1 < kWidth;
                if (!inner) return value_at(result.image, row, column, colour);
                return mean_of_points(fine, 2 * row, 2 * column, colour, c);
            });
            CAPTURE(format, points);
            CHECK(result.recomputed == kWidth * kHeight);
            CHECK(count_differences(result.image, expected) == 0);
        }
    }
}

TEST_CASE("pixels whose difference equals the threshold are marked; differences outside 0..1 do not count",
          "[ring][antialias]") {
    Session session(choose_device(""));
    const std::string format = GENERATE("fp32", "spa22");
    const double last_place = format == "fp32" ? 0x1p-23 : 0x1p-15;
    // Without lights, a surface of Kd = 1 shows its own colour, so the image has two colours, which differ in one
    // component.
    const auto recomputed_pixels = [&](double background, double object, double threshold, int component) {
        Scene scene = two_spheres();
        scene.background = scene.surfaces[1].colour = {0.5, 0.5, 0.5};
        scene.background[component] = background;
        scene.surfaces[1] = {.colour = scene.surfaces[1].colour, .diffuse = 1};
        scene.surfaces[1].colour[component] = object;
        scene.lights.clear();
        scene.planes.clear();
        scene.spheres.resize(1);
        const RingCase c{.width = 16,
                         .height = 24,
                         .pes = 16,
                         .format = format,
                         .antialias = {.method = AntialiasMethod::kSupersample, .threshold = threshold}};
        return RingRenderer(session, scene, settings_of(c)).render().recomputed;
    };
    const std::uint64_t outline_pixels = recomputed_pixels(0, 1, 0.5, 0);
    CAPTURE(format);
    CHECK(outline_pixels > 10);
    CHECK(outline_pixels < 100);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125, 0) == outline_pixels);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125, 1) == outline_pixels);
    CHECK(recomputed_pixels(0.375, 0.25, 0.125, 2) == outline_pixels);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125 * (1 + last_place), 0) == 0);
    CHECK(recomputed_pixels(0.25, 0.375, 0.125 * (1 + last_place / 4), 0) ==
          outline_pixels);  // a threshold is rounded to the format
    CHECK(recomputed_pixels(0.25, 0.375 - 0.25 * last_place, 0.125, 2) == 0);
    CHECK(recomputed_pixels(-7, 0, 0.125, 1) == 0);
    CHECK(recomputed_pixels(1, 9, 0.125, 0) == 0);
    CHECK(recomputed_pixels(-7, 9, 1, 1) == outline_pixels);
}

}  // namespace raya
