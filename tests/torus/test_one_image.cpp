// The torus's image and ray counts equal those of the ring machine, bit for bit, for any partition of the scene.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>

#include "host/torus/torus_result.hpp"
#include "tests/scene/scaled_scene.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

// Returns the number of random machines, which the environment variable RAYA_TORUS_CASES can set.
std::uint32_t random_cases() {
    const char* text = std::getenv("RAYA_TORUS_CASES");
    return text ? static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10)) : quick_cases(6, 16);
}

constexpr std::uint32_t kMaxTestNodes = 100;

// Returns c with random nodes, voxels, links, injection, packet charge and queue length, none of which requires another
// build of the kernels.
TorusCase random_machine(SplitMix& random, const Scene& scene, TorusCase c) {
    do c.nodes = random_sides(random, 5);
    while (c.nodes[0] * c.nodes[1] * c.nodes[2] > kMaxTestNodes);
    const std::uint32_t voxel_choice = random_below(random, 4);
    for (std::size_t axis = 0; axis < 3; ++axis)
        c.voxels[axis] =
            voxel_choice == 0   ? c.nodes[axis]
            : voxel_choice == 1 ? 1 + random_below(random, c.nodes[axis])        // at most as many voxels as nodes
            : voxel_choice == 2 ? c.nodes[axis] * (1 + random_below(random, 3))  // a multiple of the number of nodes
                                : 1 + random_below(random, 9);
    c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
    c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
    c.packets = random_charge(random);
    const std::uint32_t min_queue = raya_min_queue(lights_of(scene), c.bounces);
    const std::uint32_t queues[] = {min_queue, min_queue + random_below(random, 20), 3 * min_queue, 20 * min_queue, 0};
    c.queue = queues[random_below(random, 5)];
    return c;
}

// Renders the scene; after a deadlock, with queues of twice the length.
TorusResult render_without_deadlock(Session& session, const Scene& scene, const TorusCase& c) {
    TorusRenderer renderer(session, scene, settings_of(c));
    for (;;) try {
            return renderer.render();
        } catch (const TorusDeadlock& deadlock) {
            renderer.set_queue(2 * deadlock.figures.queue);
        }
}

}  // namespace

TEST_CASE("at least ten scenes on several machines and queue lengths: the image is the ring's", "[torus][slow]") {
    struct Row {
        std::array<std::uint32_t, 3> nodes;
        Divisions voxels;
        Links links;
        Injection inject;
        std::uint32_t queue;  // in multiples of the minimum queue (one ray tree); 0: the default
    };
    const Row rows[] = {{{1, 1, 1}, {1, 1, 1}, Links::kTorus3d, Injection::kAll, 1},
                        {{2, 1, 1}, {2, 1, 1}, Links::kTorus3d, Injection::kRoot, 2},
                        {{1, 5, 1}, {3, 5, 2}, Links::kTorus2d, Injection::kAll, 0},
                        {{3, 2, 4}, {3, 2, 4}, Links::kTorus3d, Injection::kAll, 1},
                        {{3, 2, 4}, {7, 5, 3}, Links::kTorus2d, Injection::kRoot, 5},
                        {{4, 4, 4}, {4, 4, 4}, Links::kTorus3d, Injection::kAll, 0},
                        {{4, 4, 4}, {2, 3, 1}, Links::kTorus2d, Injection::kAll, 20},
                        {{4, 4, 4}, {9, 8, 7}, Links::kTorus2d, Injection::kRoot, 3}};
    const std::string format = GENERATE("fp32", "spa22");
    Session session(choose_device(""));
    std::vector<Scene> scenes;
    for (const std::string& name : project_scenes()) scenes.push_back(project_scene(name));
    for (int i = 0; i < 3; ++i) scenes.push_back(random_view_scene(kSceneSeeds[i]));
    REQUIRE(scenes.size() >= 10);
    int scenes_done = 0;
    for (const Scene& scene : scenes) {
        ++scenes_done;
        TorusCase c{.width = 18, .height = 12, .lanes = 4, .group = 1, .format = format};
        const std::string expected = ring_image_and_counts(scene, c);
        CHECK_THAT(expected, Catch::Contains("primary 216 "));
        for (const Row& row : rows) {
            if ((&row - rows + scenes_done) % 2 == (format == "spa22"))
                continue;  // each format renders half of the rows
            if (!thorough() && (scenes_done % 2 == 1 || (&row - rows) / 2 % 4 != scenes_done % 4)) continue;
            c.nodes = row.nodes;
            c.voxels = row.voxels;
            c.links = row.links;
            c.inject = row.inject;
            c.queue = row.queue * raya_min_queue(lights_of(scene), c.bounces);
            if (row.queue == 1 && scenes_done % 4)
                c.queue = 0;  // renders with the minimum queue take very many supersteps
            CAPTURE(scene.name, case_text(c));
            CHECK(image_and_counts(render_without_deadlock(session, scene, c)) == expected);
        }
    }
}

TEST_CASE("random scenes on random machines: the image is the ring's", "[torus][slow]") {
    const std::uint64_t seed = 6021;
    const std::string format = GENERATE("fp32", "spa22", "e8m12t", "e5m10", "e5m6");
    Session session(choose_device(""));
    SplitMix random(seed);
    const std::uint32_t scenes = std::max(3u, random_cases() / 4);
    for (std::uint32_t i = 0; i < scenes; ++i) {
        const Scene scene = i % 3 == 2 ? far_mirror_scene(seed + i, format) : random_view_scene(seed + i);
        TorusCase c{
            .width = 1 + random_below(random, 20), .height = 1 + random_below(random, 16), .lanes = 4, .group = 1};
        c.format = format;
        const std::string expected = ring_image_and_counts(scene, c);
        for (std::uint32_t k = 0; k < random_cases() / scenes; ++k) {
            const TorusCase machine = random_machine(random, scene, c);
            CAPTURE(seed, i, k, case_text(machine));
            CHECK(image_and_counts(render_without_deadlock(session, scene, machine)) == expected);
        }
    }
}

TEST_CASE("lanes and group size change no bit of the torus's image and no packet's route", "[torus][slow]") {
    const Scene scene = random_view_scene(kSceneSeeds[3]);
    struct Row {
        std::uint32_t lanes, group;
        const char* format;
    };
    const Row rows[] = {{1, 1, "spa22"}, {8, 3, "spa22"}, {1, 8, "fp32"},
                        {4, 3, "fp32"},  {16, 1, "fp32"}, {8, 1, "fp32"}};
    Session session(choose_device(""));
    std::map<std::string, std::string> expected;
    std::map<std::pair<std::string, Injection>, TorusResult> first_results;
    for (const Row& row : quick_of(3, rows)) {
        TorusCase c{.lanes = row.lanes, .group = row.group, .format = row.format};
        if (!expected.contains(row.format)) expected[row.format] = ring_image_and_counts(scene, c);
        for (const Injection inject : {Injection::kAll, Injection::kRoot})
            for (const std::uint32_t queue : {raya_min_queue(lights_of(scene), c.bounces), 0u}) {
                c.inject = inject;
                c.queue = queue;
                c.nodes = {3, 2, 2};
                CAPTURE(case_text(c));
                const TorusResult r = render_without_deadlock(session, scene, c);
                CHECK(image_and_counts(r) == expected[row.format]);
                const TorusResult& expected_result = first_results.try_emplace({row.format, inject}, r).first->second;
                CHECK(r.made == expected_result.made);
                CHECK(r.ended == expected_result.ended);
                CHECK(r.events[RAYA_DISCARDED] == expected_result.events[RAYA_DISCARDED]);
                CHECK(r.link_packets == expected_result.link_packets);
                CHECK(r.link_words == expected_result.link_words);
            }
    }
}

TEST_CASE("subsets of the pixels combine to the whole image", "[torus]") {
    const std::uint64_t seed = 77'001;
    SplitMix random(seed);
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[4]);
    for (int i = 0; i < 6; ++i) {
        TorusCase c{
            .width = 1 + random_below(random, 9), .height = 1 + random_below(random, 9), .lanes = 4, .group = 1};
        const std::string expected = ring_image_and_counts(scene, c);
        c = random_machine(random, scene, c);
        c.queue = 0;
        c.pixels.stride = std::array{1u, 2u, 3u, 7u, c.width, c.width + 1}[static_cast<std::size_t>(i)];
        Image whole{static_cast<int>(c.width), static_cast<int>(c.height),
                    std::vector<float>(std::size_t{3} * c.width * c.height)};
        EventCounts events{};
        for (c.pixels.first = 0; c.pixels.first < c.pixels.stride; ++c.pixels.first) {
            CAPTURE(seed, i, case_text(c));
            const TorusResult part = render_torus(session, scene, c);
            for (std::size_t e = 0; e < events.size(); ++e) events[e] += part.events[e];
            std::size_t outside = 0;
            for (std::size_t at = 0; at < whole.rgb.size(); ++at) {
                const bool in_subset = at / 3 >= c.pixels.first && (at / 3 - c.pixels.first) % c.pixels.stride == 0;
                if (in_subset) whole.rgb[at] = part.image.rgb[at];
                outside += !in_subset && part.image.rgb[at] != 0;
            }
            CHECK(outside == 0);
        }
        CAPTURE(seed, i, case_text(c));
        CHECK(image_and_counts(whole, events) == expected);
    }
}

TEST_CASE("a subset without pixels gives a black image", "[torus]") {
    const Scene scene = random_view_scene(kSceneSeeds[7]);
    TorusCase c{.width = 5, .height = 3, .lanes = 4, .group = 1};
    c.pixels = {20, 15};
    c.inject = GENERATE(Injection::kAll, Injection::kRoot);
    const TorusResult black = render_torus(scene, c);
    CHECK(black.image.rgb == std::vector<float>(45, 0));
    CHECK(black.made == PacketCounts{});
    CHECK(black.hops == 0);
}

TEST_CASE("512 nodes with few pixels each give the ring's image", "[torus]") {
    const Scene scene = random_view_scene(kSceneSeeds[5]);
    Session session(choose_device(""));
    TorusCase c{.width = 9, .height = 7, .lanes = 4, .group = 1};
    const std::string expected = ring_image_and_counts(scene, c);
    c.nodes = {8, 8, 8};
    for (const Links links : {Links::kTorus3d, Links::kTorus2d})
        for (const Injection inject : {Injection::kAll, Injection::kRoot}) {
            c.links = links;
            c.inject = inject;
            CAPTURE(case_text(c));
            CHECK(image_and_counts(render_torus(session, scene, c)) == expected);
        }
}

TEST_CASE("a scene scaled beyond the format's range gives the image of the unscaled scene", "[torus]") {
    Session session(choose_device(""));
    for (const std::string format : {"spa22", "e6m10"}) {
        Scene scene = random_view_scene(kSceneSeeds[0]);
        scene.planes.clear();
        const TorusCase c{.width = 18, .height = 12, .nodes = {3, 2, 2}, .lanes = 4, .group = 1, .format = format};
        const Scene large = scaled_scene(scene, 0x1p16);
        CAPTURE(format);
        CHECK(image_and_counts(render_torus(session, large, c)) == ring_image_and_counts(scene, c));
        CHECK(render_torus(session, large, c).scale.exponent < -8);
    }
}

TEST_CASE("a second render on the same machine gives the same image and counts", "[torus]") {
    Session session(choose_device(""));
    TorusRenderer renderer(session, random_view_scene(kSceneSeeds[6]), settings_of(TorusCase{.lanes = 4, .group = 1}));
    const TorusResult first = renderer.render(), second = renderer.render();
    CHECK(image_and_counts(first) == image_and_counts(second));
    CHECK(first.events == second.events);
    CHECK(first.made == second.made);
    CHECK(first.link_words == second.link_words);
    CHECK(first.link_packets == second.link_packets);
    CHECK(first.supersteps.size() == second.supersteps.size());
    CHECK(first.queue_max == second.queue_max);
    CHECK(first.load.per_pe == second.load.per_pe);
}

}  // namespace raya
