// Two settings change neither the image nor the counts: launches with little work, and link exchange by a kernel
// instead of copy commands.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <vector>

#include "host/cl/tuned.hpp"
#include "host/scene/packer.hpp"
#include "host/torus/launch_plan.hpp"
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

// Returns the memories of two nodes, each with one voxel of `spheres` spheres.
NodeMemories two_nodes(const raya_torus& torus, std::uint32_t spheres) {
    NodeMemories memories;
    memories.starts = {0};
    for (std::uint32_t node = 0; node < 2; ++node) {
        raya_node header{};
        header.job.mapping.width = header.job.mapping.height = 16;
        header.job.lights = 1;
        header.torus = torus;
        header.number = node;
        header.voxels = 1;
        header.voxels_at = kWordsOf<raya_node>;
        raya_voxel_memory voxel{};
        voxel.objects.spheres = spheres;
        const std::size_t start = memories.words.size();
        memories.words.resize(start + kWordsOf<raya_node> + kWordsOf<raya_voxel_memory>);
        put_record(memories.words, start, header);
        put_record(memories.words, start + kWordsOf<raya_node>, voxel);
        memories.starts.push_back(static_cast<std::uint32_t>(memories.words.size()));
    }
    return memories;
}

}  // namespace

TEST_CASE("bounded launches and exchanges by a kernel give the image and counts of unbounded launches and copies",
          "[torus][slow]") {
    const std::uint64_t seed = 20261;
    SplitMix random(seed);
    Session session(choose_device(""));
    std::uint64_t single_launches = 0, bounded_launches = 0;
    for (unsigned i = 0; i < quick_cases(40, 300); ++i) {
        const Scene scene = random_view_scene(kSceneSeeds[i % kSceneSeeds.size()]);
        TorusCase c = random_case(random, scene);
        c.link_move = LinkMove::kCopies;
        TorusSettings settings = settings_of(c);
        const std::uint32_t works[] = {1, 7, 100};
        settings.work_per_launch = works[i % 3];
        settings.kernels.link_move = i % 2 ? LinkMove::kKernel : LinkMove::kCopies;
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
    CHECK(bounded_launches > 4 * single_launches);
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
        c.link_move = group == 128 ? LinkMove::kKernel : LinkMove::kCopies;
        CHECK(image_and_counts(render_torus(session, scene, c)) == expected);
    }
}

TEST_CASE("the method of link exchange is tuned for the device unless an option names it", "[torus]") {
    Session session(choose_device(""));
    const Scene scene = random_view_scene(kSceneSeeds[0]);
    const auto rendered = [&](LinkMove link_move) {
        const TorusCase c{
            .width = 6, .height = 5, .nodes = {2, 1, 1}, .lanes = 0, .bounces = 1, .link_move = link_move};
        return render_torus(session, scene, c);
    };
    const bool cpu = session.device().type == "cpu";
    const TorusResult untuned = rendered(LinkMove::kAutomatic);
    CHECK(untuned.links_origin == (cpu ? "defaults" : "measured"));
    if (cpu) CHECK(untuned.links_by_kernel);
    const ScopedTunedSource tuned_source([](const DeviceInfo& device, const TuningKey& key) {
        TunedValues values = default_values(device, key);
        values.link_exchange = static_cast<std::uint32_t>(LinkMove::kCopies);
        return std::optional(TunedChoice{values, "FILE, DATE"});
    });
    const TorusResult tuned = rendered(LinkMove::kAutomatic), by_option = rendered(LinkMove::kKernel);
    CHECK_FALSE(tuned.links_by_kernel);
    CHECK(tuned.links_origin == "FILE, DATE");
    CHECK(by_option.links_by_kernel);
    CHECK(by_option.links_origin == "options");
    CHECK(image_and_counts(tuned) == image_and_counts(untuned));
    CHECK(image_and_counts(by_option) == image_and_counts(untuned));
}

TEST_CASE("a node's launch is bounded by intersection tests, and by loop iterations where the device limits them",
          "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    const NodeDistribution distribution(torus);
    TorusSettings settings;
    settings.torus = torus;
    DeviceInfo device;
    device.correctly_rounded_divide_sqrt = true;
    const auto plan_of = [&](std::uint32_t spheres) {
        return LaunchPlan(settings, two_nodes(torus, spheres), distribution, {8192, 2048}, {}, device);
    };
    NodeStatus status(2);
    status.words[RAYA_STATUS_QUEUE] = 1000;
    status.words[RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX] = 500;  // packets that may arrive at node 0

    LaunchPlan few_spheres = plan_of(100), many_spheres = plan_of(1'000'000);
    CHECK(many_spheres.trace_voxel().single_launch);  // the queue is empty
    few_spheres.update(status);
    many_spheres.update(status);
    CHECK(few_spheres.trace_voxel().single_launch);
    CHECK(few_spheres.inject().single_launch);
    CHECK(many_spheres.trace_voxel() == LaunchBudget{100'000'000, false});
    many_spheres.clear();
    CHECK(many_spheres.trace_voxel().single_launch);

    device.max_loop_iterations = 65'535;
    LaunchPlan short_loops = plan_of(100), one_voxel_too_long = plan_of(10'000);
    CHECK(short_loops.route() == LaunchBudget{7679, false});  // (65535 - 4096) / 8; a full queue has 8192 packets
    CHECK_FALSE(short_loops.accept().single_launch);
    // Units of work per packet: 1 for its batch, 100 for the tests, 12 for its processing (RAYA_WORK_OF_PROCESSING).
    for (const auto& [packets, single_launch] : {std::pair{22u, true}, std::pair{23u, false}}) {
        NodeStatus waiting(2);
        waiting.words[RAYA_STATUS_QUEUE] = packets - 5;
        waiting.words[RAYA_STATUS_WORDS + RAYA_STATUS_OUTBOX] = 5;
        short_loops.update(waiting);
        CAPTURE(packets);
        CHECK(short_loops.trace_voxel() ==
              (single_launch ? LaunchBudget{2559, true} : LaunchBudget{2559 - 113, false}));
    }
    one_voxel_too_long.update(status);
    CHECK(one_voxel_too_long.trace_voxel() == LaunchBudget{1, false});  // one packet per launch
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
