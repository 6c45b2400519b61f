// Short queues. The minimum queue is sufficient if nodes need not wait for each other. A queue one packet shorter is
// refused. A machine that deadlocks finishes with a longer queue.
#include <catch2/catch.hpp>

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

}  // namespace

TEST_CASE("the minimum queue suffices if one node processes all rays", "[torus]") {
    Session session(choose_device(""));
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
            const Scene scene = scene_in_one_voxel(1);
            TorusCase c{.nodes = {4, 4, 4}, .links = links, .inject = inject, .lanes = 4, .group = 1};
            c.queue = min_queue_of(scene, c);
            CAPTURE(case_text(c));
            const TorusResult r = render_torus(session, scene, c);
            CHECK(image_and_counts(r) == ring_image_and_counts(scene, c));
            CHECK(r.events[RAYA_REFLECTED] > 2 * c.width * c.height);
            CHECK(r.load.efficiency < 1. / 48);  // one of 64 nodes has three quarters of the load
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

TEST_CASE("a machine that deadlocks finishes with a longer queue, and deadlocks again with the shorter", "[torus]") {
    const Scene scene = project_scene("mirrors");
    Session session(choose_device(""));
    TorusCase c{.width = 40, .height = 40, .nodes = {4, 4, 4}, .links = Links::kTorus2d, .lanes = 4, .group = 1};
    c.format = "spa22";
    const std::uint32_t shortest = min_queue_of(scene, c);
    c.queue = shortest;
    TorusRenderer renderer(session, scene, settings_of(c));
    // Returns image and counts, or the message of the deadlock.
    const auto outcome = [&](std::uint32_t queue) {
        renderer.set_queue(queue);
        std::string image;
        const std::string refusal = user_error_message([&] { image = image_and_counts(renderer.render()); });
        return image.empty() ? refusal : image;
    };
    const std::string deadlock = outcome(shortest);
    CAPTURE(shortest);
    CHECK_THAT(deadlock, Catch::Contains("deadlock") && Catch::Contains(fmt::format("full at {} packets", shortest)));
    std::uint32_t queue = 2 * shortest;
    while (outcome(queue).find("deadlock") != std::string::npos) queue *= 2;
    CHECK(outcome(queue) == ring_image_and_counts(scene, c));
    CHECK(renderer.render().queue_max <= queue);
    CHECK(outcome(shortest) == deadlock);  // no state of the other renders remains
}

}  // namespace raya
