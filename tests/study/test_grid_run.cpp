// Renders through a grid in one PE, against a machine that walks its rays as packets, and sums of events.
#include <catch2/catch.hpp>
#include <random>

#include "host/model/t805.hpp"
#include "host/scene/generate.hpp"
#include "host/study/grid_run.hpp"
#include "host/torus/torus_renderer.hpp"

namespace raya {
namespace {

EventCounts on_one_node(Session& session, const Scene& scene, const Divisions& divisions, const GridSettings& grid) {
    TorusSettings settings;
    settings.machine = machine_named("grande");
    settings.width = settings.height = grid.side;
    settings.torus = make_torus({1, 1, 1}, Links::kTorus3d);
    settings.voxels = divisions;
    settings.bounces = grid.bounces;
    settings.sampling = grid.sampling;
    return TorusRenderer(session, scene, settings).render().events;
}

TEST_CASE("a PE's grid and a node of the torus count the same rays, walks and steps", "[study][slow]") {
    constexpr unsigned kSeed = 54;
    std::mt19937 random(kSeed);
    Session session(choose_device(""));
    for (int i = 0; i < 6; ++i) {
        CAPTURE(kSeed, i);
        const Scene scene = generate_random(1 + int(random() % 60), random());
        const Divisions divisions = {std::uint32_t(1 + random() % 9), std::uint32_t(1 + random() % 9),
                                     std::uint32_t(1 + random() % 9)};
        const GridSettings grid{.side = 12, .bounces = 2, .sampling = i % 2 ? Sampling::kCorners : Sampling::kCentres};
        const GridRun run = run_grid(session, {"random", scene}, divisions, grid);
        const EventCounts node = on_one_node(session, scene, divisions, grid);
        for (const int event : {RAYA_PRIMARY, RAYA_PRIMARY_HITS, RAYA_REFLECTED, RAYA_REFRACTED, RAYA_SHADOW,
                                RAYA_SHADOW_HITS, RAYA_SHADED, RAYA_LIT, RAYA_WALKS, RAYA_STEPS}) {
            CAPTURE(event);
            CHECK(run.events[std::size_t(event)] == node[std::size_t(event)]);
        }
        CHECK(run.events[RAYA_SPHERE_TESTS] <= node[RAYA_SPHERE_TESTS]);  // a shadow ray may end before the last object
        CHECK(run.objects == scene.spheres.size());
        CHECK(run.voxels() == std::uint64_t{divisions[0]} * divisions[1] * divisions[2]);
        CHECK(run.measured_ms > 0);
    }
}

TEST_CASE("rays, tests and modelled time are sums over events", "[study]") {
    std::mt19937 random(55);
    for (int i = 0; i < 300; ++i) {
        EventCounts events;
        for (auto& count : events) count = random();
        CHECK(ray_count(events) ==
              events[RAYA_PRIMARY] + events[RAYA_REFLECTED] + events[RAYA_REFRACTED] + events[RAYA_SHADOW]);
        CHECK(test_count(events) == events[RAYA_SPHERE_TESTS] + events[RAYA_PLANE_TESTS] + events[RAYA_POLYGON_TESTS] +
                                        events[RAYA_CONE_TESTS]);
        double ns = 0;
        for (std::size_t event = 0; event < RAYA_EVENTS; ++event)
            ns += 40.0 * t805_cycles()[event] * static_cast<double>(events[event]);
        CHECK(t805_ms(events) == Approx(1e-6 * ns).epsilon(1e-12));
    }
}

}  // namespace
}  // namespace raya
