// Short queues. The minimum queue is sufficient if nodes need not wait for each other. A queue one packet shorter is
// refused. A machine that deadlocks finishes with a longer queue.
#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <optional>

#include "host/torus/torus_result.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

std::uint32_t min_queue_of(const Scene& scene, const TorusCase& c) {
    return raya_min_queue(lights_of(scene), c.bounces);
}

// Returns a scene of mirrors and glass in a hollow mirror ball, which also contains the eye and the lights. A small
// sphere in each of two distant corners enlarges the bounding box, so that all rays stay in one of its 4 x 4 x 4
// voxels.
Scene scene_in_one_voxel(std::uint64_t seed) {
    SplitMix random(seed);
    Scene scene = empty_scene();
    scene.surfaces[1].specular = 0.75;
    scene.spheres = {{{-2, -2, -2}, 0.01, 0}, {{2, 2, 2}, 0.01, 0}};
    const Vec3 middle(0.5, 0.5, 0.5);  // centre of voxel (2, 2, 2), whose side is 1
    scene.spheres.push_back({middle, -0.45, 1});
    for (int i = 0; i < 12; ++i)
        scene.spheres.push_back({middle + random.uniform(0.15, 0.35) * random_direction(random),
                                 random.uniform(0.02, 0.1), round_surface(random)});
    scene.view.from = middle;
    scene.view.at = middle + random_direction(random);
    scene.view.up = random_direction(random);
    scene.view.angle_degrees = 100;
    scene.lights = {{middle + 0.05 * random_direction(random), {}}, {middle + 0.1 * random_direction(random), {}}};
    return scene;
}

// Image hash and counts of a finished render, or the figures of its deadlock.
struct RenderOutcome {
    std::string image;
    std::optional<DeadlockFigures> deadlock;
};

RenderOutcome render_outcome(TorusRenderer& renderer) {
    try {
        return {image_and_counts(renderer.render()), {}};
    } catch (const TorusDeadlock& error) {
        return {{}, error.figures};
    }
}

// Doubles the queue until the machine finishes, and returns the outcome.
RenderOutcome outcome_of_longer_queue(TorusRenderer& renderer, std::uint32_t& queue) {
    RenderOutcome outcome;
    do {
        renderer.set_queue(queue *= 2);
        outcome = render_outcome(renderer);
    } while (outcome.deadlock);
    return outcome;
}

bool same_figures(const DeadlockFigures& a, const DeadlockFigures& b) {
    return a.superstep == b.superstep && a.live == b.live && a.full == b.full && a.queue == b.queue;
}

}  // namespace

TEST_CASE("a single node renders with the minimum queue", "[torus]") {
    Session session(choose_device(""));
    for (std::size_t i = 0; i < 6; ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i]);
        TorusCase c{.nodes = {1, 1, 1}, .voxels = {1, 1, 1}, .lanes = 4, .group = 1};
        if (i % 2) c.voxels = {3, 2, 4};
        c.queue = min_queue_of(scene, c);
        CAPTURE(kSceneSeeds[i], case_text(c));
        const TorusResult r = render_torus(session, scene, c);
        CHECK(image_and_counts(r) == ring_image_and_counts(scene, c));
        CHECK(r.queue_max <= c.queue);
        CHECK(r.hops == 0);
    }
}

TEST_CASE("the minimum queue suffices if one node processes all rays", "[torus]") {
    Session session(choose_device(""));
    for (std::uint64_t seed = 1; seed <= 2; ++seed)
        for (const Links links : {Links::kTorus3d, Links::kTorus2d})
            for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
                const Scene scene = scene_in_one_voxel(seed);
                TorusCase c{.nodes = {4, 4, 4}, .links = links, .inject = inject, .lanes = 4, .group = 1};
                c.queue = min_queue_of(scene, c);
                CAPTURE(seed, case_text(c));
                const TorusResult r = render_torus(session, scene, c);
                CHECK(image_and_counts(r) == ring_image_and_counts(scene, c));
                CHECK(r.events[RAYA_PRIMARY_HITS] == c.width * c.height);
                CHECK(r.events[RAYA_REFLECTED] > 2 * c.width * c.height);
                const auto& loads = r.load.per_pe;
                const auto total_load = std::accumulate(loads.begin(), loads.end(), std::uint64_t{0});
                CHECK(*std::max_element(loads.begin(), loads.end()) > total_load / 4 * 3);
            }
}

TEST_CASE("a queue below the minimum length is refused, and the message names the minimum", "[torus]") {
    Session session(choose_device(""));
    SplitMix random(1);
    for (int i = 0; i < 20; ++i) {
        Scene scene = random_view_scene(5);
        scene.lights.resize(random_below(random, 5), scene.lights[0]);
        TorusCase c{.lanes = 4, .group = 1, .bounces = random_below(random, 32)};
        const std::uint32_t min_queue = min_queue_of(scene, c);
        c.queue = 1 + random_below(random, min_queue - 1);
        if (i % 2) c.queue = min_queue - 1;
        CAPTURE(i, case_text(c), min_queue);
        const std::string refusal = user_error_message([&] { render_torus(session, scene, c); });
        CHECK_THAT(refusal, Catch::Contains("--queue") && Catch::Contains(std::to_string(min_queue)));
    }
}

TEST_CASE("a machine that deadlocks finishes with a longer queue", "[torus]") {
    const char* const name = GENERATE("centre", "mirrors");
    const Scene scene = project_scene(name);
    Session session(choose_device(""));
    TorusCase c{.width = 40, .height = 40, .nodes = {4, 4, 4}, .links = Links::kTorus2d, .lanes = 4, .group = 1};
    c.format = "spa22";
    c.queue = min_queue_of(scene, c);
    const std::string expected = ring_image_and_counts(scene, c);
    int deadlocks = 0;
    for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
        TorusCase short_queue = c;
        short_queue.queue += inject == Injection::kRoot ? 3 : 0;
        short_queue.inject = inject;
        CAPTURE(name, case_text(short_queue));
        TorusRenderer renderer(session, scene, settings_of(short_queue));
        const RenderOutcome first = render_outcome(renderer);
        if (!first.deadlock) CHECK(first.image == expected);
        if (!first.deadlock) continue;
        ++deadlocks;
        CHECK(first.deadlock->queue == short_queue.queue);
        CHECK(first.deadlock->nodes == 64);
        CHECK(first.deadlock->full <= 64);
        CHECK(first.deadlock->live > first.deadlock->full * short_queue.queue);
        CHECK(first.deadlock->superstep > 0);
        std::uint32_t queue = short_queue.queue;
        CHECK(outcome_of_longer_queue(renderer, queue).image == expected);
        const TorusResult r = renderer.render();
        CHECK(r.queue_max <= queue);
        CHECK(r.made == r.ended);
        // The deadlock repeats identically: no state of the first render or of the longer ones remains.
        renderer.set_queue(short_queue.queue);
        const RenderOutcome second_outcome = render_outcome(renderer);
        REQUIRE(second_outcome.deadlock);
        CHECK(same_figures(*second_outcome.deadlock, *first.deadlock));
    }
    CHECK(deadlocks >= 2);  // otherwise the test checks nothing
}

TEST_CASE("with a queue one packet shorter than the shortest sufficient queue, the machine deadlocks", "[torus]") {
    const Scene scene = project_scene("mirrors");
    Session session(choose_device(""));
    TorusCase c{.width = 24, .height = 24, .nodes = {4, 4, 4}, .links = Links::kTorus2d, .lanes = 4, .group = 1};
    c.format = "spa22";
    const std::string expected = ring_image_and_counts(scene, c);
    const std::uint32_t min_queue = min_queue_of(scene, c);
    const auto outcome = [&](std::uint32_t queue) {
        c.queue = queue;
        std::string image;
        const std::string refusal =
            user_error_message([&] { image = image_and_counts(render_torus(session, scene, c)); });
        return image.empty() ? refusal : image;
    };
    std::uint32_t queue = min_queue;
    std::string previous, current = outcome(queue);
    for (; current != expected && queue < 4 * min_queue; current = outcome(++queue)) previous = current;
    CAPTURE(min_queue, queue, previous);
    CHECK(current == expected);
    REQUIRE(queue > min_queue);  // otherwise the test checks nothing
    CHECK_THAT(previous, Catch::Contains("deadlock") && Catch::Contains("are full at " + std::to_string(queue - 1)));
}

TEST_CASE("queues of any length give the ring's image, if necessary after they are doubled", "[torus]") {
    const std::uint64_t seed = 616;
    SplitMix random(seed);
    Session session(choose_device(""));
    int deadlocks = 0;
    for (std::uint32_t i = 0; i < 10; ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i % 4]);
        TorusCase c{.width = 24, .height = 20, .lanes = 4, .group = 1};
        c.nodes = {1 + random_below(random, 5), 1 + random_below(random, 4), 1 + random_below(random, 4)};
        c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
        c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
        c.queue = min_queue_of(scene, c) + random_below(random, 8);
        CAPTURE(seed, i, case_text(c));
        TorusRenderer renderer(session, scene, settings_of(c));
        RenderOutcome outcome = render_outcome(renderer);
        if (outcome.deadlock) {
            ++deadlocks;
            outcome = outcome_of_longer_queue(renderer, c.queue);
        }
        CHECK(outcome.image == ring_image_and_counts(scene, c));
    }
    CAPTURE(deadlocks);
    CHECK(deadlocks < 10);
}

}  // namespace raya
