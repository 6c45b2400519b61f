// The memory of a node: its words, its queue and its mailboxes. Sizes are exact to the byte, and error messages contain
// the figures and remedies. The image of a render depends on the contents of the words.
#include <fmt/core.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "host/torus/torus_plan.hpp"
#include "tests/kernels/random_scene.hpp"
#include "tests/torus/random_torus.hpp"

using namespace raya;
using Catch::Contains;

namespace {

constexpr std::uint32_t kDefaultQueue = 8192;

using Lists = std::vector<std::set<std::uint32_t>>;

// Returns the sizes of nodes with one voxel each. lists[node]: numbers of the objects in the node's voxel, which must
// not be planes.
NodeSizes sizes_of(const Scene& scene, const Lists& lists, const raya_torus& torus) {
    Partition p;
    p.grid = {{-1, -2, -3}, {0.25F, 0.5F, 0.75F}, {torus.nodes[0], torus.nodes[1], torus.nodes[2]}, 100};
    p.starts = {0};
    for (const std::set<std::uint32_t>& list : lists) {
        p.objects.insert(p.objects.end(), list.begin(), list.end());
        p.starts.push_back(static_cast<std::uint32_t>(p.objects.size()));
    }
    JobSettings settings;
    settings.image = {16, 16};
    return node_sizes(pack_job(scene, settings), p, torus);
}

// Returns the number of words of a node with one voxel of spheres: a header, the voxel, surfaces, planes, and six words
// per sphere, of which two are its surface and its number. The words before the spheres, and those of the spheres, are
// each padded to whole rows.
std::uint64_t words_of(std::uint64_t spheres, std::uint64_t surfaces, std::uint64_t planes = 0) {
    return padded_to_rows(padded_to_rows((sizeof(raya_node) + sizeof(raya_voxel_memory)) / 4 +
                                         surfaces * RAYA_SURFACE_WORDS + planes * RAYA_PLANE_WORDS) +
                          spheres * (RAYA_SPHERE_WORDS + 2));
}

// Returns the sizes of nodes of which node i has counts[i] spheres with one surface.
NodeSizes sizes_of_spheres(const std::vector<std::uint32_t>& counts, const raya_torus& torus) {
    Scene scene = empty_scene();
    scene.lights.clear();
    Lists lists(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::uint32_t n = 0; n < counts[i]; ++n) {
            lists[i].insert(static_cast<std::uint32_t>(scene.spheres.size()));
            scene.spheres.push_back({{0, 0, 0}, 1, 0});
        }
    return sizes_of(scene, lists, torus);
}

// Returns the size of queue and mailboxes in bytes. The queue holds `queue` rays of 64 bytes. A mailbox holds a quarter
// of that number, at least 1. Each link has an outbox of rays, an inbox of rays, and an inbox of returns of 32 bytes.
// The node has one outbox of returns, towards the root.
std::uint64_t packet_bytes(std::uint64_t queue, std::uint64_t links) {
    const std::uint64_t box = queue < 8 ? 1 : queue / 4;
    return 64 * (queue + 2 * links * box) + 32 * (links > 0 ? links + 1 : 0) * box;
}

}  // namespace

TEST_CASE("a node holds only its own objects, and the surfaces of these and of the planes", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    Scene scene = empty_scene();
    scene.lights.clear();
    scene.surfaces.assign(5, {});
    for (int i = 0; i < 4; ++i) scene.spheres.push_back({{0, 0, 0}, 1, i});
    const auto sizes = [&] { return sizes_of(scene, {{0, 1, 2}, {2, 3}}, torus); };
    CHECK(sizes() == NodeSizes{words_of(3, 3), words_of(2, 2)});
    scene.spheres[2].surface = 0;
    CHECK(sizes() == NodeSizes{words_of(3, 2), words_of(2, 2)});
    scene.planes = {{{0, 0, 1}, 0, 4}, {{0, 1, 0}, 0, 3}};
    CHECK(sizes() == NodeSizes{words_of(3, 4, 2), words_of(2, 3, 2)});
}

TEST_CASE("nodes with more than 2^30 words in total are refused", "[torus]") {
    const NodeSizes sizes{1 << 29, 1, (1 << 29) - 1, 1};
    CHECK_NOTHROW(check_words(sizes, std::vector<std::uint32_t>{0, 1, 2}));
    CHECK_THROWS_WITH(check_words(sizes, std::vector<std::uint32_t>{0, 1, 2, 3}),
                      Contains("4 nodes need 1073741825 words") && Contains("use fewer nodes or voxels"));
}

TEST_CASE("a node's bytes are its words, its queue and its mailboxes", "[torus]") {
    CHECK(node_bytes(100, {8, 2}, 6) == 400 + 64 * (8 + 24) + 32 * 14);
    CHECK(node_bytes(0, {1, 1}, 0) == 64);
    CHECK(node_bytes(std::uint64_t{1} << 40, {UINT32_MAX, UINT32_MAX}, 6) ==
          (std::uint64_t{1} << 42) + (64ull * 13 + 32 * 7) * UINT32_MAX);
}

TEST_CASE("without a memory limit the queue has the requested or the default length", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    const NodeSizes sizes = sizes_of_spheres({3, 4}, torus);
    const auto plan = [&](std::uint32_t queue, std::uint32_t min_queue) {
        const NodeBuffers buffers = plan_buffers("balls.nff", sizes, torus, {}, queue, min_queue);
        return std::vector<std::uint32_t>{buffers.queue, buffers.box};
    };
    CHECK(plan(0, 5) == std::vector<std::uint32_t>{kDefaultQueue, kDefaultQueue / 4});
    CHECK(plan(0, 10000) == std::vector<std::uint32_t>{10000, 2500});  // at least the packets of one ray tree
    CHECK(plan(5, 5) == std::vector<std::uint32_t>{5, 1});
    CHECK(plan(11, 5) == std::vector<std::uint32_t>{11, 2});
    CHECK(plan(1, 0) == std::vector<std::uint32_t>{1, 1});
    CHECK(user_error_message([&] { plan(6, 7); }) ==
          "balls.nff: --queue 6: the tree of a single ray may need 7 packets; use --queue 7 or more");
    CHECK(default_queue(2048) == kDefaultQueue);
    CHECK(default_queue(4096) == kDefaultQueue / 2);
    CHECK(default_queue(65536) == 256);
}

TEST_CASE("the planned queue is the longest that fits, to the byte", "[torus]") {
    for (std::uint64_t seed = 1; seed <= 300; ++seed) {
        SplitMix random(seed);
        const std::array<std::uint32_t, 3> nodes = {1 + random_below(random, 3), 1 + random_below(random, 3), 1};
        const raya_torus torus = make_torus(nodes, Links::kTorus3d);
        std::vector<std::uint32_t> counts(nodes[0] * nodes[1]);
        for (std::uint32_t& count : counts) count = 1 + random_below(random, 50);
        const std::uint32_t max_count = *std::max_element(counts.begin(), counts.end());
        const std::uint32_t min_queue = 1 + random_below(random, 40), links = links_of_node(torus);
        const NodeSizes sizes = sizes_of_spheres(counts, torus);
        const std::uint32_t queue = min_queue + random_below(random, kDefaultQueue - min_queue);
        const std::uint64_t exact_bytes = 4 * words_of(max_count, 1) + packet_bytes(queue, links);
        CAPTURE(seed, torus_text(torus), max_count, min_queue, queue);
        const auto plan = [&](std::uint64_t bytes, std::uint32_t requested_queue) {
            return plan_buffers("s", sizes, torus, bytes, requested_queue, min_queue);
        };
        CHECK(plan(exact_bytes, 0).queue == queue);
        CHECK(plan(exact_bytes, 0).box == (queue < 8 ? 1 : queue / 4));
        CHECK(plan(exact_bytes + 63, 0).queue == queue);
        CHECK(plan(exact_bytes, queue).queue == queue);
        CHECK_THROWS_AS(plan(exact_bytes - 1, queue), UserError);
        if (queue > min_queue) CHECK(plan(exact_bytes - 1, 0).queue == queue - 1);
        if (queue == min_queue) CHECK_THROWS_AS(plan(exact_bytes - 1, 0), UserError);
        CHECK(plan(std::uint64_t{1} << 32, 0).queue == kDefaultQueue);
    }
}

TEST_CASE("a scene that does not fit is refused with figures, the fullest node and remedies that suffice", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 2}, Links::kTorus3d);
    const NodeSizes sizes = sizes_of_spheres({100, 300, 20, 200}, torus);
    struct Row {
        std::uint64_t limit;
        std::uint32_t queue, shortest;
        const char *fitting, *remedy;
    };
    const Row rows[] = {{4 * words_of(200, 1) + packet_bytes(9, 4), 0, 9, "3 of 4", "more --nodes"},
                        {4 * words_of(300, 1) + packet_bytes(100, 4), 1000, 1000, "0 of 4", "--queue 100"}};
    for (const Row& row : rows) {
        const auto plan = [&](std::uint64_t memory, std::uint32_t queue) {
            return plan_buffers("s.nff", sizes, torus, memory, queue, 9);
        };
        const std::uint64_t buffers = packet_bytes(row.shortest, 4), needed = 4 * words_of(300, 1) + buffers;
        const std::uint64_t sufficient = (needed + 1023) / 1024 * 1024;
        CHECK(
            user_error_message([&] { plan(row.limit, row.queue); }) ==
            fmt::format("s.nff: does not fit: {} nodes can hold their voxels; node 1 needs {:.1f} KB for the scene and "
                        "{:.1f} KB for buffers, a node has {:.1f} KB; use {} or --pe-memory {}",
                        row.fitting, std::ceil(static_cast<double>(words_of(300, 1)) / 25.6) / 10,
                        std::ceil(static_cast<double>(buffers) / 102.4) / 10,
                        std::floor(static_cast<double>(row.limit) / 102.4) / 10, row.remedy, sufficient));
        CHECK(plan(sufficient, row.queue).queue >= row.shortest);
        try {
            plan(row.limit, row.queue);
        } catch (const DoesNotFit& error) {
            CHECK(error.needed_bytes == needed);
            CHECK(error.memory_bytes == row.limit);
        }
    }
    CHECK(plan_buffers("s.nff", sizes, torus, rows[1].limit, 100, 9).queue == 100);
}
