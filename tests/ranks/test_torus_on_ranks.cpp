// The torus distributed over ranks. Image, counts, loads, supersteps and traffic equal those of a single rank.
#include <catch2/catch.hpp>

#include "host/torus/topology.hpp"
#include "host/torus/torus_result.hpp"
#include "tests/ranks/same_results.hpp"
#include "tests/ranks/thread_ranks.hpp"
#include "tests/thorough.hpp"
#include "tests/torus/random_torus.hpp"
#include "tests/torus/render_torus.hpp"

namespace raya {
namespace {

struct RenderOutput {
    TorusResult result;
    std::string packets;  // one line for each record
};

std::string text_of(const PacketRecord& r) {
    return fmt::format("{} {} {} {} {:x} {:x}\n", r.superstep, r.source, r.destination, r.words, r.head.pixel,
                       r.head.state);
}

RenderOutput render_on(Ranks& ranks, const Scene& scene, const TorusSettings& settings) {
    Session session(choose_device(""));
    RenderOutput output;
    const Scene empty_scene;
    TorusRenderer renderer(session, ranks.is_first() ? scene : empty_scene, settings, ranks);
    output.result = renderer.render({}, {.packets = [&](const PacketRecord& r) { output.packets += text_of(r); }});
    return output;
}

void check_same(const RenderOutput& single, const RenderOutput& distributed) {
    check_same(single.result, distributed.result);
    CHECK(single.packets == distributed.packets);
}

TorusCase random_case(SplitMix& random, const Scene& scene) {
    TorusCase c{.group = 1};
    do c.nodes = random_sides(random, 4);
    while (c.nodes[0] * c.nodes[1] * c.nodes[2] > 40);
    for (std::size_t axis = 0; axis < 3; ++axis)
        c.voxels[axis] = random.next() % 2 ? c.nodes[axis] : 1 + random_below(random, 7);
    c.links = random.next() % 2 ? Links::kTorus3d : Links::kTorus2d;
    c.inject = random.next() % 2 ? Injection::kAll : Injection::kRoot;
    c.packets = random_charge(random);
    const std::uint32_t min_queue = raya_min_queue(static_cast<std::uint32_t>(scene.lights.size()), c.bounces);
    c.queue = random.next() % 2 ? 0 : min_queue * (1 + random_below(random, 20));
    return c;
}

}  // namespace

TEST_CASE("each rank has a cuboid of nodes, of nearly equal size, and rank 0 has the root", "[ranks]") {
    constexpr std::uint64_t kSeed = 99;
    SplitMix random(kSeed);
    for (int i = 0; i < 300; ++i) {
        const raya_torus torus = random_torus(random, 6);
        const std::uint32_t nodes = raya_nodes(torus), ranks = 1 + random_below(random, std::min(nodes, 12u));
        CAPTURE(kSeed, i, torus_text(torus), ranks);
        const std::vector<std::uint32_t> rank_of = ranks_of_nodes(torus, ranks);
        CHECK(rank_of[RAYA_ROOT] == 0);
        for (std::uint32_t rank = 0; rank < ranks; ++rank) {
            raya_place low{{~0u, ~0u, ~0u}}, high{};
            std::uint32_t nodes_of_rank = 0;
            for (std::uint32_t node = 0; node < nodes; ++node) {
                if (rank_of[node] != rank) continue;
                const raya_place p = raya_torus_place(torus, node);
                for (int axis = 0; axis < 3; ++axis) {
                    low.at[axis] = std::min(low.at[axis], p.at[axis]);
                    high.at[axis] = std::max(high.at[axis], p.at[axis]);
                }
                ++nodes_of_rank;
            }
            REQUIRE(nodes_of_rank > 0);
            std::uint32_t nodes_of_box = 1;
            for (int axis = 0; axis < 3; ++axis) nodes_of_box *= 1 + high.at[axis] - low.at[axis];
            CHECK(nodes_of_box == nodes_of_rank);
        }
    }
    const raya_torus cube = make_torus({4, 4, 4}, Links::kTorus3d);
    const auto max_nodes = [&](std::uint32_t count) {
        Ranks ranks = silent_rank(0, count);
        return NodeDistribution(cube, ranks).max_count();
    };
    for (const std::uint32_t ranks : {1u, 2u, 4u, 8u, 16u, 32u, 64u}) CHECK(max_nodes(ranks) == 64 / ranks);
    CHECK(max_nodes(3) <= 32);
    CHECK(max_nodes(7) <= 16);
}

TEST_CASE("slots, inner nodes and inboxes of a rank agree with the links of its nodes", "[ranks]") {
    constexpr std::uint64_t kSeed = 5;
    SplitMix random(kSeed);
    for (int i = 0; i < 200; ++i) {
        const raya_torus torus = random_torus(random, 5);
        const std::uint32_t ranks = 1 + random_below(random, std::min(raya_nodes(torus), 9u));
        CAPTURE(kSeed, i, torus_text(torus), ranks);
        for (std::uint32_t rank = 0; rank < ranks; ++rank) {
            Ranks this_rank = silent_rank(rank, ranks);
            const NodeDistribution distribution(torus, this_rank);
            for (std::uint32_t slot = 0; slot < distribution.count(); ++slot) {
                const std::uint32_t node = distribution.own()[slot];
                CHECK(distribution.slot_of(node) == slot);
                bool inner = true;
                for (std::uint32_t link = 0; link < RAYA_LINKS; ++link)
                    inner &= distribution.has(raya_link_end(torus, node, link));
                CHECK(inner == (slot < distribution.inner_nodes()));
            }
            for (std::uint32_t link = 0; link < RAYA_LINKS; ++link) {
                std::vector<int> uses(distribution.inboxes());  // [inbox]: number of links that use it
                for (const std::uint32_t node : distribution.own()) {
                    const std::uint32_t sender = raya_link_end(torus, node, link ^ 1u),
                                        inbox = distribution.inbox_from(sender, link);
                    REQUIRE(inbox < distribution.inboxes());
                    ++uses[inbox];
                }
                CHECK(std::count_if(uses.begin(), uses.end(), [](int n) { return n > 1; }) == 0);
            }
        }
    }
}

TEST_CASE("random toruses: image and traffic, or the deadlock, are the same on 1 to 8 ranks", "[ranks]") {
    constexpr std::uint64_t kSeed = 77;
    SplitMix random(kSeed);
    std::vector<Scene> scenes;
    for (const std::string& name : project_scenes()) scenes.push_back(project_scene(name));
    std::uint32_t cases = 0, deadlocks = 0;
    for (std::uint32_t i = 0; i < quick_cases(20, 100); ++i) {
        const Scene& scene = scenes[i % scenes.size()];
        const TorusCase c = random_case(random, scene);
        CAPTURE(kSeed, i, scene.name, case_text(c));
        const TorusSettings settings = settings_of(c);
        const std::uint32_t counts[] = {2, 3, 4, 7, 8};
        const std::uint32_t count = counts[i % 5];
        if (count > raya_nodes(settings.torus)) continue;
        RenderOutput single;
        std::string deadlock;
        try {
            single = render_on(Ranks::single(), scene, settings);
        } catch (const TorusDeadlock& error) {
            deadlock = error.what();
        }
        if (!deadlock.empty()) {
            on_ranks(count, [&](Ranks& ranks) {
                std::string message;
                try {
                    render_on(ranks, scene, settings);
                } catch (const TorusDeadlock& error) {
                    message = error.what();
                }
                if (ranks.is_first() && message != deadlock)
                    throw std::logic_error("message of rank 0: " + message + "; of a single rank: " + deadlock);
                if (message.empty()) throw std::logic_error("a rank does not detect the deadlock");
            });
            ++deadlocks;
            continue;
        }
        RenderOutput distributed;
        on_ranks(count, [&](Ranks& ranks) {
            RenderOutput own_output = render_on(ranks, scene, settings);
            if (ranks.is_first())
                distributed = std::move(own_output);
            else if (!own_output.packets.empty() || !own_output.result.image.rgb.empty())
                throw std::logic_error("a rank other than 0 has packets or an image");
        });
        check_same(single, distributed);
        ++cases;
    }
    WARN(cases << " machines completed their renders, " << deadlocks << " deadlocked");
    CHECK(cases > 8);
}

TEST_CASE("toruses: the work of the ranks' kernels adds up to that of a single rank", "[ranks]") {
    const Scene scene = project_scene("glass");
    const TorusSettings settings = settings_of({.nodes = {3, 2, 2}, .group = 1});
    const auto works_of = [&](Ranks& ranks) {
        return torus_kernel_work(settings, render_on(ranks, scene, settings).result);
    };
    const std::vector<KernelWork> single = works_of(Ranks::single());
    std::vector<std::vector<KernelWork>> works(3);
    on_ranks(3, [&](Ranks& ranks) { works[ranks.rank()] = works_of(ranks); });
    for (const std::vector<KernelWork>& of_rank : works) CHECK(of_rank[1].operations < single[1].operations);
    check_sums(single, works, {"accept"});
}

TEST_CASE("more ranks than nodes are refused with both numbers", "[ranks]") {
    CHECK_THROWS_WITH(ranks_of_nodes(make_torus({2, 1, 1}, Links::kTorus3d), 3),
                      Catch::Contains("3 ranks for 2 nodes") && Catch::Contains("start 2 ranks or fewer"));
}

}  // namespace raya
