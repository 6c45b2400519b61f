// Tests the reference renderer with scenes whose results are known. Further ones: tests/ring/test_known_answers.cpp,
// whose kernels agree with the reference.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <utility>

#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

Surface matt(const Colour& colour) { return {.colour = colour, .diffuse = 1, .checker = {}}; }
Surface glass(double t, double ior) {
    return {.diffuse = 0, .transmittance = t, .refraction_index = ior, .checker = {}};
}

/// Returns an empty scene, viewed from (0, 0, eye_z) towards the origin with an angle of 30 degrees; y is up.
Scene scene_from(double eye_z) {
    Scene scene;
    scene.view = {.from = {0, 0, eye_z}, .at = {0, 0, 0}, .up = {0, 1, 0}, .angle_degrees = 30};
    return scene;
}

Colour radiance(const Scene& scene, const Options& options, double x, double y) {
    Counts counts;
    return trace_pixel(scene, options, x, y, counts);
}

/// Returns the angle between a primary ray and the viewing direction, in radians.
double angle_off_axis(const Scene& scene, const Options& options, double x, double y) {
    const Vec3 view_direction = (scene.view.at - scene.view.from).normalized();
    return std::acos(std::min(1.0, view_direction.dot(primary_ray(scene, options, x, y).direction)));
}

void check_colour(const Colour& colour, const Colour& expected, double tolerance) {
    CAPTURE(colour.x, colour.y, colour.z, expected.x, expected.y, expected.z);
    CHECK((colour - expected).length() <= tolerance);
}

TEST_CASE("primary rays span the view angle from top to bottom, through pixel centres and through corners") {
    const Scene scene = scene_from(5);
    const double h = std::tan(15 * kDegree);
    const Options corners{.width = 9, .height = 5, .corners = true};
    const Ray top_left = primary_ray(scene, corners, 0, 0);
    CHECK((top_left.direction - Vec3(-2 * h, h, -1).normalized()).length() < 1e-15);
    CHECK((primary_ray(scene, corners, 8, 4).direction - Vec3(2 * h, -h, -1).normalized()).length() < 1e-15);
    const Options centres{.width = 4, .height = 2};
    CHECK((primary_ray(scene, centres, 0, 0).direction - Vec3(-1.5 * h, h / 2, -1).normalized()).length() < 1e-15);
    CHECK((primary_ray(scene, centres, -0.5, -0.5).direction - Vec3(-2 * h, h, -1).normalized()).length() < 1e-15);
    for (const bool by_corners : {false, true}) {
        const Options one_pixel{.width = 1, .height = 1, .corners = by_corners};
        CHECK((primary_ray(scene, one_pixel, 0, 0).direction - Vec3(0, 0, -1)).length() < 1e-15);
    }
    const Options column{.width = 1, .height = 3, .corners = true};
    CHECK((primary_ray(scene, column, 0, 0).direction - Vec3(0, h, -1).normalized()).length() < 1e-15);
}

TEST_CASE("the radiance of a sphere lit from the eye follows the closed formula") {
    constexpr double kEye = 5;
    Scene scene = scene_from(kEye);
    const Colour colour(0.9, 0.5, 0.2);
    scene.surfaces = {{.colour = colour, .diffuse = 0.6, .specular = 0.3, .shine = 7, .checker = {}}};
    scene.spheres = {{{0, 0, 0}, 1, 0}};
    scene.lights = {{{0, 0, kEye}, {}}};
    scene.background = {0.1, 0.2, 0.3};
    const Options options{.width = 65, .height = 65, .bounces = 0};
    for (const auto& [x, y] : {std::pair{32, 32}, {40, 32}, {32, 12}, {20, 45}, {33, 50}, {12, 28}}) {
        CAPTURE(x, y);
        const double incidence = std::asin(kEye * std::sin(angle_off_axis(scene, options, x, y)));
        const double gloss = std::pow(std::max(0.0, std::cos(2 * incidence)), 7);
        const Colour expected = 0.5 * 0.6 * colour + 0.5 * (0.6 * std::cos(incidence) * colour + Colour(0.3 * gloss));
        check_colour(radiance(scene, options, x, y), expected, 1e-8);
    }
    check_colour(radiance(scene, options, 0, 0), scene.background, 0);
}

TEST_CASE("the colours of lights add up; shadowed and averted faces get no light") {
    Scene scene = scene_from(5);
    scene.surfaces = {matt({1, 1, 1})};
    scene.planes = {{{0, 0, 1}, 0, 0}};
    scene.lights = {{{0, 0, 4}, Colour(0.5, 0, 0)}, {{3, 0, 3}, Colour(0, 0.5, 0)}};
    scene.spheres = {{{5, 0, 5}, 0.5, 0}};  // behind the second light
    const double ambient = std::sqrt(2) / 4;
    const Options options{.width = 1, .height = 1};
    check_colour(radiance(scene, options, 0, 0), Colour(ambient) + Colour(0.5, 0.5 * std::sqrt(0.5), 0), 1e-8);

    scene.spheres = {{{2, 0, 2}, 0.5, 0}};  // between the plane and the second light
    Counts counts;
    check_colour(trace_pixel(scene, options, 0, 0, counts), Colour(ambient) + Colour(0.5, 0, 0), 1e-8);
    CHECK(counts == Counts{.primary = 1, .primary_hits = 1, .shadow = 2, .shadow_hits = 1});

    scene.spheres[0].centre = {-2, 0, -2};  // behind the plane: casts no shadow
    scene.lights[0].position = {0, 0, -4};
    counts = {};
    check_colour(trace_pixel(scene, options, 0, 0, counts), Colour(ambient) + Colour(0, 0.5 * std::sqrt(0.5), 0), 1e-8);
    CHECK(counts == Counts{.primary = 1, .primary_hits = 1, .shadow = 1});
}

TEST_CASE("a glass sphere shows the squares of a checkered plane where the closed formula predicts them") {
    constexpr double kEye = 5, kIor = 1.5, kPlaneDistance = 3, kSquareSize = 0.05;
    Scene scene = scene_from(kEye);
    Surface checkered = matt({1, 1, 1});
    checkered.checker = Checker{{1, 0, 0}, {0, 1, 0}, kSquareSize};
    scene.surfaces = {glass(1, kIor), checkered};
    scene.spheres = {{{0, 0, 0}, 1, 0}};
    scene.planes = {{{0, 0, 1}, -kPlaneDistance, 1}};
    const Options options{.width = 201, .height = 201, .bounces = 2};
    int odd = 0;
    for (int x = 100; x < 170; ++x) {
        const double theta = angle_off_axis(scene, options, x, 100);
        const double incidence = std::asin(kEye * std::sin(theta));
        const double inner = std::asin(std::sin(incidence) / kIor);
        const double exit_angle = incidence - theta + std::numbers::pi - 2 * inner;  // polar angle of the exit point
        const double ray_angle = theta - 2 * (incidence - inner);
        const double plane_x = std::sin(exit_angle) + (std::cos(exit_angle) + kPlaneDistance) * std::tan(ray_angle);
        const double square = plane_x / kSquareSize;
        if (std::abs(square - std::round(square)) < 1e-4)
            continue;  // the margin of secondary rays shifts the squares' edges
        CAPTURE(x, plane_x);
        const bool even = std::fmod(std::floor(square), 2) == 0;
        odd += !even;
        check_colour(radiance(scene, options, x, 100), even ? Colour(1, 0, 0) : Colour(0, 1, 0), 0);
    }
    CHECK(odd > 15);
}

TEST_CASE("under total reflection, one reflected ray carries the reflected and the transmitted fraction") {
    constexpr double kKs = 0.25, kT = 0.5, kIor = 1.5;
    Scene scene;
    scene.surfaces = {{.diffuse = 0, .specular = kKs, .transmittance = kT, .refraction_index = kIor, .checker = {}},
                      matt({1, 1, 1})};
    scene.planes = {{{0, 0, 1}, 0, 0}, {{0, 0, 1}, -2, 1}};  // water seen from below; a bright ground
    const double critical = std::asin(1 / kIor);
    const auto radiance_upwards = [&](double incidence, Counts& counts) {
        scene.view.from = {0, 0, -1};
        scene.view.at = scene.view.from + Vec3(std::sin(incidence), 0, std::cos(incidence));
        return trace_pixel(scene, {.width = 1, .height = 1}, 0, 0, counts);
    };
    Counts below_critical, above_critical;
    check_colour(radiance_upwards(critical - 0.001, below_critical), Colour(kKs), 1e-15);
    CHECK(below_critical == Counts{.primary = 1, .primary_hits = 1, .reflected = 1, .refracted = 1});
    check_colour(radiance_upwards(critical + 0.001, above_critical), Colour(kKs + kT), 1e-15);
    CHECK(above_critical == Counts{.primary = 1, .primary_hits = 1, .reflected = 1});
}

TEST_CASE("checker squares alternate, also across coordinate 0") {
    Scene scene = scene_from(10);
    scene.surfaces = {matt({0, 0, 1})};
    scene.surfaces[0].checker = Checker{{1, 0, 0}, {0, 1, 0}, 0.5};
    for (const Vec3& normal : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}) {
        scene.planes = {{normal, 0, 0}};
        for (int u = -3; u < 3; ++u)
            for (int v = -3; v < 3; ++v) {
                CAPTURE(normal.x, normal.y, normal.z, u, v);
                const double pu = (u + 0.5) / 2, pv = (v + 0.5) / 2;
                const Vec3 p = normal.x > 0 ? Vec3(0, pu, pv) : normal.y > 0 ? Vec3(pu, 0, pv) : Vec3(pu, pv, 0);
                const auto hit = closest_hit(scene, {p + normal, -normal});
                REQUIRE(hit);
                CHECK(hit->odd_square == ((u + v) % 2 != 0));
                CHECK(hit->colour == (hit->odd_square ? Colour(0, 1, 0) : Colour(1, 0, 0)));
            }
    }
}

}  // namespace
}  // namespace raya::reference
