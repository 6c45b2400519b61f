// The grid of a PE decides which objects are tested, never what comes out (`--accel grid`).
#include <catch2/catch.hpp>

#include "error.hpp"
#include "ring/render_scene.hpp"
#include "scene/generate.hpp"
#include "torus/render_torus.hpp"

namespace raya {
namespace {

// What must not depend on the grid: the image and everything that is counted but tests and ways through voxels.
std::string answer_of(const RingResult& r) { return one_image(r.image, r.all.events); }

RingResult render_with(Session& session, const Scene& scene, const RingCase& c, const Accel& accel) {
    RingSettings settings = raya::settings_of(c);
    settings.accel = accel;
    return RingRenderer(session, scene, settings).render();
}

const Accel kAutomatic{.grid = true, .divisions = {}};

Accel cut(std::uint32_t a, std::uint32_t b, std::uint32_t c) { return {.grid = true, .divisions = Divisions{a, b, c}}; }

std::uint64_t tests_of(const EventCounts& e) {
    return e[RAYA_SPHERE_TESTS] + e[RAYA_PLANE_TESTS] + e[RAYA_POLYGON_TESTS] + e[RAYA_CONE_TESTS];
}

}  // namespace

TEST_CASE("a grid changes no bit of the image, whatever its voxels and the format", "[ring][accel]") {
    Session session(choose_device(""));
    const std::string name = GENERATE("centre", "glass", "polygons", "cones", "planes");
    const std::string format = GENERATE("fp32", "spa22");
    const Scene scene = project_scene(name);
    const RingCase c{.width = 32, .height = 24, .pes = 8, .format = format};
    const std::string expected = answer_of(render_with(session, scene, c, {}));
    for (const Accel& accel : {kAutomatic, cut(1, 1, 1), cut(7, 3, 5), cut(1, 40, 2), cut(24, 24, 24)}) {
        CAPTURE(name, format, accel_text(accel));
        const RingResult result = render_with(session, scene, c, accel);
        CHECK(answer_of(result) == expected);
        CHECK(result.all.events[RAYA_STEPS] >= result.all.events[RAYA_WALKS]);
    }
}

TEST_CASE("scenes of all kinds of objects look alike with a grid, in coarse formats too", "[ring][accel]") {
    Session session(choose_device(""));
    const std::string format = GENERATE("fp32", "e6m15t", "e5m10", "e8m12", "e5m6");
    SplitMix random(2026);
    for (const std::uint64_t seed : kRichScenes) {
        const Scene scene = random_view_scene(seed);
        const RingCase c{.width = 24, .height = 20, .pes = 6, .format = format};
        const auto side = [&] { return 1 + static_cast<std::uint32_t>(random.next() % 9); };
        const std::uint32_t a = side(), b = side(), d = side();
        CAPTURE(seed, format, a, b, d);
        const std::string expected = answer_of(render_with(session, scene, c, {}));
        CHECK(answer_of(render_with(session, scene, c, cut(a, b, d))) == expected);
        CHECK(answer_of(render_with(session, scene, c, kAutomatic)) == expected);
    }
}

TEST_CASE("tests and steps are counted for each ray, whatever lanes, groups and PEs", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("polygons");
    const std::string format = GENERATE("fp32", "spa22");
    const RingCase c{.width = 32, .height = 24, .pes = 8, .lanes = 1, .group = 1, .format = format};
    const EventCounts expected = render_with(session, scene, c, cut(5, 4, 6)).all.events;
    CHECK(expected[RAYA_STEPS] > expected[RAYA_WALKS]);
    for (const auto& [lanes, group, pes] : {std::array{4u, 1u, 8u}, {8u, 3u, 32u}, {16u, 1u, 5u}, {1u, 16u, 1u}}) {
        CAPTURE(format, lanes, group, pes);
        RingCase other = c;
        other.lanes = lanes;
        other.group = group;
        other.pes = pes;
        CHECK(render_with(session, scene, other, cut(5, 4, 6)).all.events == expected);
    }
}

TEST_CASE("supersampling through a grid gives the same pixels", "[ring][accel]") {
    Session session(choose_device(""));
    RingCase c{.width = 32, .height = 24, .pes = 8};
    c.antialias.method = AntialiasMethod::kSupersample;
    const Scene scene = project_scene("centre");
    const RingResult plain = render_with(session, scene, c, {}), grid = render_with(session, scene, c, kAutomatic);
    CHECK(plain.recomputed > 0);
    CHECK(answer_of(grid) == answer_of(plain));
}

TEST_CASE("a grid saves nearly all tests of many small spheres", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = generate_balls(3);
    const RingCase c{.width = 48, .height = 48, .pes = 48};
    const RingResult plain = render_with(session, scene, c, {}), grid = render_with(session, scene, c, kAutomatic);
    CHECK(answer_of(grid) == answer_of(plain));
    REQUIRE(grid.accel);
    CHECK(grid.accel->apart == 1);  // the ground
    CHECK(tests_of(plain.all.events) > 20 * tests_of(grid.all.events));
    CHECK(grid.pe_memory.job_words == plain.pe_memory.job_words + grid.accel->words);
}

TEST_CASE("a grid that does not fit a PE is refused with both figures", "[ring][accel]") {
    Session session(choose_device(""));
    const Scene scene = project_scene("centre");
    RingCase c{.machine = "spa"};
    CHECK_THROWS_WITH(render_with(session, scene, c, cut(32, 32, 32)),
                      Catch::Contains("32 KB") && Catch::Contains("--machine grande"));
    CHECK_NOTHROW(render_with(session, scene, c, cut(8, 8, 8)));
}

}  // namespace raya
