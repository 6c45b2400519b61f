// A PE's grid or BVH selects the objects that are tested and never changes the image (`--accel grid`, `--accel bvh`):
// cases that random scenes (tests/property) rarely have.
#include <catch2/catch.hpp>

#include "host/error.hpp"
#include "host/scene/generate.hpp"
#include "tests/ring/render_scene.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

// Returns the results that do not depend on the accelerator: the image, and all counts except those of tests,
// traversals and traversal steps.
std::string image_and_events(const RingResult& r) { return image_and_counts(r.image, r.events); }

RingResult render_with(Session& session, const Scene& scene, const RingCase& c, const Accel& accel) {
    RingSettings settings = raya::settings_of(c);
    settings.accel = accel;
    return RingRenderer(session, scene, settings).render();
}

const Accel automatic_grid{.kind = AccelKind::kGrid, .divisions = {}}, bvh{.kind = AccelKind::kBvh, .divisions = {}};

Accel grid_of(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return {.kind = AccelKind::kGrid, .divisions = Divisions{a, b, c}};
}

std::uint64_t tests_of(const EventCounts& e) {
    return e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS];
}

}  // namespace

// A floor of many squares, a square larger than all of them, and an infinite plane lie in the same plane: a ray hits
// them at equal distances.
TEST_CASE(
    "of a plane, a separate polygon and listed polygons at equal distances, the one with the lowest number is hit",
    "[ring][accel]") {
    Session session(choose_device(""));
    Scene scene = project_scene("planes");
    scene.planes = {{{0, 0, 1}, 0, 0}};
    // The sphere makes the box high. So a ray finds the large square in voxels before the voxel of the hit.
    scene.spheres = {{{-4, -4, 4}, 0.1, 0}};
    scene.cones.clear();
    scene.polygons = {};
    const auto add_square = [&](double x, double y, double side, int surface) {
        scene.polygons.push_back(
            {{{x, y, 0}, {x + side, y, 0}, {x + side, y + side, 0}, {x, y + side, 0}}, {}, surface});
    };
    const auto surfaces = static_cast<int>(scene.surfaces.size());
    for (int i = 0; i < 40; ++i) add_square(-4 + i % 8, -2 + i / 8, 1, i % surfaces);
    add_square(-100, -100, 200, 1 % surfaces);
    for (int i = 0; i < 40; ++i) add_square(-4 + i / 5, -2 + i % 5, 1, (i + 1) % surfaces);
    scene.view.from = {1, -6, 5};
    scene.view.at = {0, 0, 0};
    scene.view.up = {0, 0, 1};
    scene.lights = {{{2, 1, 8}, {}}};
    for (const bool plane : {true, false}) {
        if (!plane) scene.planes.clear();
        const RingCase c{.width = 32, .height = 24, .pes = 8};
        const std::string expected = image_and_events(render_with(session, scene, c, {}));
        const RingResult grid = render_with(session, scene, c, automatic_grid);
        CAPTURE(plane);
        CHECK(image_and_events(grid) == expected);
        CHECK(grid.accel->separate == 1);
        CHECK(image_and_events(render_with(session, scene, c, grid_of(9, 9, 3))) == expected);
        CHECK(image_and_events(render_with(session, scene, c, bvh)) == expected);
    }
}

// The lights lie in a ceiling of squares. So, up to rounding, a shadow ray meets the square around its light at the
// ray's end.
TEST_CASE("a hit at the end of a shadow ray does not count, in any voxel", "[ring][accel]") {
    Session session(choose_device(""));
    const std::string format = GENERATE(from_range(quick(1, {"spa22", "fp32"})));
    Scene scene = project_scene("planes");
    scene.planes.clear();
    scene.cones.clear();
    scene.spheres = {{{0, 0, 8}, 0.5, 0}};  // makes the box higher than the ceiling
    const auto square = [](double x, double y, double z, double side) {
        return Polygon{{{x, y, z}, {x + side, y, z}, {x + side, y + side, z}, {x, y + side, z}}, {}, 0};
    };
    scene.polygons = {square(-8, -8, 0, 16)};
    for (int i = 0; i < 256; ++i) scene.polygons.push_back(square(i % 16 - 8, i / 16 - 8, 4, 1));
    scene.lights = {{{0.5, 0.5, 4}, {}}, {{-3, 2, 4}, {}}, {{2.25, -4.75, 4}, {}}};
    scene.view.from = {1, -6, 3};
    scene.view.at = {0, 0, 0};
    scene.view.up = {0, 0, 1};
    const RingCase c{.width = 48, .height = 40, .pes = 8, .format = format};
    const RingResult plain = render_with(session, scene, c, {});
    CHECK(plain.events[RAYA_SHADOW_HITS] > 0);
    CHECK(plain.events[RAYA_LIT] > 0);
    for (const Accel& accel : {bvh, automatic_grid, grid_of(5, 6, 7), grid_of(3, 2, 16)}) {
        CAPTURE(format, accel_text(accel));
        CHECK(image_and_events(render_with(session, scene, c, accel)) == image_and_events(plain));
    }
}

TEST_CASE("a grid or BVH saves 95 % of the tests of many small spheres", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = generate_balls(3);
    const RingCase c{.width = 48, .height = 48, .pes = 48};
    const RingResult plain = render_with(session, scene, c, {}), grid = render_with(session, scene, c, automatic_grid);
    CHECK(image_and_events(grid) == image_and_events(plain));
    REQUIRE(grid.accel);
    CHECK(grid.accel->separate == 1);  // the ground polygon
    CHECK(tests_of(plain.events) > 20 * tests_of(grid.events));
    CHECK(grid.pe_memory.job_words == plain.pe_memory.job_words + grid.accel->words);
    const RingResult tree = render_with(session, scene, c, bvh);
    CHECK(image_and_events(tree) == image_and_events(plain));
    CHECK(tests_of(plain.events) > 20 * tests_of(tree.events));
    CHECK(tree.pe_memory.job_words == plain.pe_memory.job_words + tree.accel->words);
}

TEST_CASE("a grid that does not fit a PE is refused; the message gives the PE's memory and a remedy", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("centre");
    RingCase c{.machine = "spa"};
    CHECK_THROWS_WITH(render_with(session, scene, c, grid_of(32, 32, 32)),
                      Catch::Contains("32 KB") && Catch::Contains("--machine grande"));
    CHECK_NOTHROW(render_with(session, scene, c, grid_of(8, 8, 8)));
}

}  // namespace raya
