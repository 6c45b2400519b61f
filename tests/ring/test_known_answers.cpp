// Scenes whose images are known analytically, rendered by the kernels.
#include <catch2/catch.hpp>

#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"

namespace raya {
namespace {

Scene known_answer_scene() {
    Scene scene;
    scene.name = "known answer";
    scene.view.from = {0, 0, 0};
    scene.view.at = {0, 0, 1};
    scene.view.angle_degrees = 40;
    return scene;
}

float pixel(const RingResult& r, int row, int column, int channel) {
    return r.image.rgb[static_cast<std::size_t>((row * r.image.width + column) * 3 + channel)];
}

}  // namespace

TEST_CASE("a sphere of Kd = 1 without lights is as bright as the ambient light", "[ring]") {
    Scene scene = known_answer_scene();
    scene.background = {1, 1, 1};
    scene.surfaces = {{.colour = {1, 1, 1}, .diffuse = 1}};
    scene.spheres = {{{0, 0, 5}, 1, 0}, {{1, 1, 4}, 0.5, 0}};
    const RingResult result = render_scene(scene, {.width = 33, .height = 33, .pes = 33});
    CHECK(result.events[RAYA_PRIMARY_HITS] > 50);
    for (const float value : result.image.rgb) CHECK(value == 1.0f);
}

TEST_CASE("a perfect mirror and clear glass are invisible in uniform surroundings", "[ring]") {
    Scene scene = known_answer_scene();
    scene.background = {0.25, 0.5, 0.75};
    scene.surfaces = {{.diffuse = 0, .specular = 1}, {.diffuse = 0, .transmittance = 1, .refraction_index = 1.5}};
    scene.spheres = {{{0, 0, 5}, 1, 0}, {{-1.5, 0, 5}, 0.7, 1}};
    const RingResult result = render_scene(scene, {.width = 32, .height = 32, .pes = 32, .bounces = 31});
    CHECK(result.events[RAYA_REFLECTED] > 20);
    CHECK(result.events[RAYA_REFRACTED] > 20);
    for (std::size_t i = 0; i < result.image.rgb.size(); ++i)
        CHECK(result.image.rgb[i] == Approx(0.25 * double(1 + i % 3)).epsilon(1e-6));
}

TEST_CASE("the light between two mirrors is a geometric series with one term per bounce", "[ring]") {
    Scene scene = known_answer_scene();
    scene.view.from = {0, 0, 0.5};
    scene.view.at = {0, 0, 1};
    scene.surfaces = {{.colour = {1, 0.5, 0.25}, .diffuse = 0.5, .specular = 0.5}};
    scene.planes = {{{0, 0, 1}, 0, 0}, {{0, 0, 1}, 1, 0}};
    for (const std::uint32_t bounces : quick(2, {kTestBounces, 31u, 0u})) {
        const RingResult result =
            render_scene(scene, {.width = 1, .height = 1, .pes = 1, .offset = 0, .bounces = bounces});
        const double series = 0.5 * (1 - std::pow(0.5, bounces + 1)) / 0.5;  // ambient 1, no lights
        CHECK(result.events[RAYA_REFLECTED] == bounces);
        CHECK(pixel(result, 0, 0, 0) == Approx(series).epsilon(1e-6));
        CHECK(pixel(result, 0, 0, 2) == Approx(0.25 * series).epsilon(1e-6));
    }
}

TEST_CASE("a sphere lit from the eye follows Kd (N.L) + Ks (R.L)^n at its centre and half way to its rim", "[ring]") {
    Scene scene = known_answer_scene();
    scene.lights = {{{0, 0, 0}, Colour(1, 1, 1)}};
    scene.surfaces = {{.colour = {1, 0.5, 0}, .diffuse = 0.4, .specular = 0.3, .shine = 20}};
    scene.spheres = {{{0, 0, 5}, 1, 0}};
    const RingResult result = render_scene(scene, {.width = 65, .height = 65, .pes = 65});
    const double ambient = 0.5;  // ambient intensity with n = 1 light: sqrt(n) / (2 n)
    CHECK(pixel(result, 32, 32, 0) == Approx(0.4 * (ambient + 1) + 0.3).epsilon(1e-5));
    CHECK(pixel(result, 32, 32, 1) == Approx(0.2 * (ambient + 1) + 0.3).epsilon(1e-5));
    CHECK(pixel(result, 32, 32, 2) == Approx(0.3).epsilon(1e-5));
    CHECK(pixel(result, 0, 0, 0) == 0);
    // Half way to the rim of the sphere as seen from the eye: b is the angle of the ray to the axis, and a is the angle
    // of the ray to the normal, with sin(a) = 5 sin(b).
    const double slope = std::tan(20 * M_PI / 180) * 16 / 32.5, b = std::atan(slope), a = std::asin(5 * std::sin(b));
    const double cosine = std::cos(a), mirror = std::cos(2 * a);
    const double highlight = mirror > 0 ? 0.3 * std::pow(mirror, 20) : 0;
    CHECK(pixel(result, 32, 48, 0) == Approx(0.4 * (ambient + cosine) + highlight).epsilon(1e-4));
}

TEST_CASE("glass of index 1 is invisible, and a ray through the centre of a glass sphere is not deflected", "[ring]") {
    Scene scene = known_answer_scene();
    scene.surfaces = {{.diffuse = 0, .transmittance = 1, .refraction_index = 1},
                      {.colour = {0.2, 0.6, 1}, .checker = Checker{{1, 0, 0}, {0, 0, 1}, 0.37}}};
    scene.planes = {{{0, 0, 1}, 9, 1}};
    const RingCase c{.width = 33, .height = 33, .pes = 33};
    const RingResult wall = render_scene(scene, c);
    scene.spheres = {{{0, 0, 5}, 1, 0}};
    const RingResult through = render_scene(scene, c);
    CHECK(through.events[RAYA_REFRACTED] > 200);
    int unequal = 0;  // number of values that differ, because rounding selects another colour at a checker corner
    for (std::size_t i = 0; i < wall.image.rgb.size(); ++i)
        unequal += std::abs(wall.image.rgb[i] - through.image.rgb[i]) > 1e-5f;
    CHECK(unequal <= 3);
    scene.surfaces[0].refraction_index = 1.5;
    const RingResult glass = render_scene(scene, c);
    for (int channel = 0; channel < 3; ++channel)
        CHECK(pixel(glass, 16, 16, channel) == Approx(pixel(wall, 16, 16, channel)));
}

}  // namespace raya
