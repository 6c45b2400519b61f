// Launches with little work change neither the image nor the counts.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <vector>

#include "host/cl/kernel_options.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

// Checks that the images and all counts, superstep by superstep, are equal.
void check_same(const TorusResult& a, const TorusResult& b) {
    CHECK(pixel_hash(a.image) == pixel_hash(b.image));
    CHECK(a.events == b.events);
    CHECK(a.made == b.made);
    CHECK(a.ended == b.ended);
    CHECK(a.load.per_pe == b.load.per_pe);
    CHECK(a.link_words == b.link_words);
    CHECK(a.link_packets == b.link_packets);
    CHECK(a.queue_max == b.queue_max);
    CHECK(a.supersteps.size() == b.supersteps.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < std::min(a.supersteps.size(), b.supersteps.size()); ++i) {
        const Superstep &x = a.supersteps[i], &y = b.supersteps[i];
        different += x.max_node_cycles != y.max_node_cycles || x.max_link_words != y.max_link_words || x.live != y.live;
    }
    CHECK(different == 0);
}

std::uint64_t launches_of(const TorusResult& r) {
    std::uint64_t launches = 0;
    for (const LabelSummary& c : r.commands)
        if (c.kind == "kernel") launches += c.launches;
    return launches;
}

TorusCase random_case(SplitMix& random, const Scene& scene) {
    const std::uint32_t widths[] = {1, 1, 4};
    TorusCase c{.width = 6 + random_below(random, 8), .height = 5 + random_below(random, 6)};
    c.nodes = random_sides(random, 3);
    if (random_below(random, 3) == 0)
        c.voxels = {1 + random_below(random, 4), 1 + random_below(random, 4), 1 + random_below(random, 4)};
    c.links = random_below(random, 2) ? Links::kTorus3d : Links::kTorus2d;
    c.inject = random_below(random, 3) ? Injection::kAll : Injection::kRoot;
    c.packets = random_charge(random);
    c.bounces = 3;
    c.lanes = widths[random_below(random, 3)];
    c.group = c.lanes == 1 ? 3 : 1;
    if (random_below(random, 4)) c.queue = raya_min_queue(lights_of(scene), c.bounces) + 20 + random_below(random, 60);
    return c;
}

}  // namespace

TEST_CASE("bounded launches give the image and counts of unbounded launches", "[torus][slow]") {
    const std::uint64_t seed = 20261;
    SplitMix random(seed);
    Session session(choose_device(""));
    std::uint64_t single_launches = 0, bounded_launches = 0;
    for (unsigned i = 0; i < quick_cases(40, 300); ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i % kSceneSeeds.size()]);
        TorusCase c = random_case(random, scene);
        TorusSettings settings = settings_of(c);
        const std::uint32_t works[] = {1, 7, 100};
        settings.work_per_launch = works[i % 3];
        CAPTURE(seed, i, settings.work_per_launch, case_text(c));
        try {
            const TorusResult whole = render_torus(session, scene, c);
            const TorusResult parts = TorusRenderer(session, scene, settings).render();
            check_same(parts, whole);
            single_launches += launches_of(whole);
            bounded_launches += launches_of(parts);
        } catch (const TorusDeadlock&) {  // both renders must deadlock
            CHECK_THROWS_AS(TorusRenderer(session, scene, settings).render(), TorusDeadlock);
        }
    }
    CHECK(bounded_launches > 3 * single_launches);  // both include the exchanges, which are never divided
}

TEST_CASE("work-groups of many work-items give the same image", "[torus][slow]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 12, .height = 10, .nodes = {2, 2, 1}, .lanes = 1, .group = 1, .bounces = 3};
    c.queue = 400;
    const std::string expected = image_and_counts(render_torus(session, scene, c));
    for (const std::uint32_t group : quick(2, {128u, 64u, 33u, 256u, 1024u})) {
        if (group > session.device().max_group_size) continue;
        CAPTURE(group);
        c.group = group;
        CHECK(image_and_counts(render_torus(session, scene, c)) == expected);
    }
}

TEST_CASE("a launch whose loops the device cuts short is repeated with half the work, for any kernel", "[torus]") {
    struct Row {
        const char* kernel;
        const char* corruption;  // statements that corrupt what a cut launch may have written
    };
    const char* const corrupt_counts =
        "events[(size_t)slot * RAYA_EVENTS] += 1000; made[(size_t)slot * RAYA_KINDS + 1] += 9; "
        "queues[(size_t)slot * run->queue].head.pixel += 1;";
    const char* const corrupt_moves =
        "ended[(size_t)slot * RAYA_KINDS + 2] += 9; status[RAYA_STATUS_QUEUE_MAX] += 1000; "
        "queues[(size_t)slot * run->queue].head.pixel += 1;";
    const Row rows[] = {{"inject", corrupt_counts},
                        {"trace_voxel", corrupt_counts},
                        {"route", corrupt_moves},
                        {"accept", corrupt_moves}};
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 6, .height = 5, .nodes = {2, 2, 1}, .lanes = 1, .group = 3, .bounces = 3};
    for (const Row& row : rows) {
        CAPTURE(row.kernel);
        Session session(choose_device(""));
        c.sources = {};
        const TorusResult whole = render_torus(session, scene, c);
        const std::string file = fmt::format("torus/{}.cl", row.kernel);
        const std::string text = kernel_file(file);
        const std::size_t at = text.find("if (loops_were_cut("), end = text.find('\n', at);
        c.sources.patches = {{file, text.substr(at, end - at),
                              fmt::format("if (work > 3u) {{ status[RAYA_STATUS_CUT] = 1; {} }}", row.corruption)}};
        session.launch_limit(row.kernel) = 8;
        check_same(render_torus(session, scene, c), whole);
        CHECK(session.launch_limit(row.kernel) == 2);
        check_same(render_torus(session, scene, c), whole);
    }
}

TEST_CASE("compose is repeated with more work-groups if the device ends loops early", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 16, .height = 15, .nodes = {2, 1, 1}, .lanes = 1, .group = 1, .bounces = 1};
    const std::string expected = image_and_counts(render_torus(session, scene, c));
    c.sources.patches = {
        {"torus/compose.cl", "if (loops_were_cut(", "if (pixels > 4 * get_global_size(0) || loops_were_cut("}};
    CHECK(image_and_counts(render_torus(session, scene, c)) == expected);
}

TEST_CASE("a loop that the device ends early is detected in every kernel", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    TorusCase c{.width = 6, .height = 5, .nodes = {2, 1, 1}, .lanes = 1, .group = 1, .bounces = 1};
    for (const char* file :
         {"torus/inject.cl", "torus/trace_voxel.cl", "torus/route.cl", "torus/accept.cl", "torus/compose.cl"}) {
        CAPTURE(file);
        c.sources.patches = {{file, "if (loops_were_cut(", "if (!loops_were_cut("}};
        CHECK_THROWS_WITH(render_torus(session, scene, c),
                          Catch::Contains("stopped this kernel's loops before their end and reported no error") &&
                              Catch::Contains("remedy"));
        CHECK_THROWS_AS(render_torus(session, scene, c), DeviceError);
    }
    // The canary must detect that its loop ends after the first iteration.
    c.sources.patches = {{"shared/loop_canary.clh", "i < two; ++i) iterations = iterations + 1;",
                          "i < two; ++i) { iterations = iterations + 1; break; }"}};
    CHECK_THROWS_AS(render_torus(session, scene, c), DeviceError);
}

}  // namespace raya
