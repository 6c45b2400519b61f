// The memory plan of a node: words, queue and mailboxes. The planned sizes are exact to the byte, and error messages
// contain the figures and remedies.
#include <fmt/core.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/torus/random_nodes.hpp"

using namespace raya;
using Catch::Contains;

namespace {

constexpr std::uint32_t kDefaultQueue = 8192;

// Returns the sizes of nodes with one voxel each. Node i's voxel contains counts[i] spheres with one surface. There
// are no lights and no planes.
NodeSizes nodes_with_spheres(const std::vector<std::uint32_t>& counts, const raya_torus& torus) {
    Scene scene = empty_scene();
    scene.lights.clear();
    std::vector<std::set<std::uint32_t>> lists(counts.size());
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::uint32_t n = 0; n < counts[i]; ++n) {
            lists[i].insert(static_cast<std::uint32_t>(scene.spheres.size()));
            scene.spheres.push_back({{0, 0, 0}, 1, 0});
        }
    const Divisions divisions = {torus.nodes[0], torus.nodes[1], torus.nodes[2]};
    return node_sizes(pack(scene), partition_of(divisions, lists), torus);
}

constexpr std::uint64_t padded_to_rows(std::uint64_t bytes) { return (bytes + 15) / 16 * 16; }

// Returns the size in bytes of the words of a node that nodes_with_spheres() makes: header, one voxel, one surface, and
// six words per sphere. The words before the spheres, and the words of the spheres, are each padded to whole rows.
constexpr std::uint64_t node_words_bytes(std::uint32_t spheres) {
    return padded_to_rows(padded_to_rows(sizeof(raya_node) + sizeof(raya_voxel_memory) + 4 * RAYA_SURFACE_WORDS) +
                          24ull * spheres);
}

// Returns the size of queue and mailboxes in bytes. The queue holds `queue` rays of 64 bytes. A mailbox holds a quarter
// of that number, at least 1. Each link has an outbox of rays, an inbox of rays, and an inbox of returns of 32 bytes.
// The node has one outbox of returns, towards the root.
std::uint64_t packet_bytes(std::uint64_t queue, std::uint64_t links) {
    const std::uint64_t box = queue < 8 ? 1 : queue / 4;
    return 64 * (queue + 2 * links * box) + 32 * (links > 0 ? links + 1 : 0) * box;
}

}  // namespace

TEST_CASE("a node's bytes are its words, its queue and its mailboxes", "[torus]") {
    CHECK(node_bytes(100, {8, 2}, 6) == 400 + 64 * (8 + 24) + 32 * 14);
    CHECK(node_bytes(0, {1, 1}, 0) == 64);
    CHECK(node_bytes(std::uint64_t{1} << 40, {UINT32_MAX, UINT32_MAX}, 6) ==
          (std::uint64_t{1} << 42) + (64ull * 13 + 32 * 7) * UINT32_MAX);
}

TEST_CASE("a node has two links to other nodes for each side of more than one node", "[torus]") {
    CHECK(links_of_node(make_torus({4, 4, 4}, Links::kTorus3d)) == 6);
    CHECK(links_of_node(make_torus({4, 4, 4}, Links::kTorus2d)) == 4);
    CHECK(links_of_node(make_torus({2, 1, 2}, Links::kTorus3d)) == 4);
    CHECK(links_of_node(make_torus({1, 1, 2}, Links::kTorus2d)) == 2);
    CHECK(links_of_node(make_torus({1, 1, 1}, Links::kTorus3d)) == 0);
}

TEST_CASE("without a memory limit the queue has the requested or the default length", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    const NodeSizes sizes = nodes_with_spheres({3, 4}, torus);
    const auto plan = [&](std::uint32_t queue, std::uint32_t min_queue) {
        const NodeBuffers buffers = plan_buffers("s", sizes, torus, {}, queue, min_queue);
        return std::vector<std::uint32_t>{buffers.queue, buffers.box};
    };
    CHECK(plan(0, 5) == std::vector<std::uint32_t>{kDefaultQueue, kDefaultQueue / 4});
    CHECK(plan(0, 10000) == std::vector<std::uint32_t>{10000, 2500});  // at least the packets of one ray tree
    CHECK(plan(5, 5) == std::vector<std::uint32_t>{5, 1});
    CHECK(plan(11, 5) == std::vector<std::uint32_t>{11, 2});
    CHECK(plan(100'000, 5) == std::vector<std::uint32_t>{100'000, 25'000});
    CHECK(plan(1, 0) == std::vector<std::uint32_t>{1, 1});
}

TEST_CASE("the default queue is shorter on machines of more than 2048 nodes", "[torus]") {
    CHECK(default_queue(1) == kDefaultQueue);
    CHECK(default_queue(2048) == kDefaultQueue);
    CHECK(default_queue(4096) == kDefaultQueue / 2);
    CHECK(default_queue(65536) == 256);
}

TEST_CASE("queues and mailboxes that exceed the device's memory are refused, with a length that fits", "[torus]") {
    DeviceMemory device;
    // 64 nodes: the mailboxes, 64 x 6 x (1 + 1000) packets of 64 bytes, are the largest buffer.
    device.max_buffer = 64ull * 6 * 1001 * 64;
    device.total = std::uint64_t{1} << 40;
    const auto refusal = [&](std::uint32_t queue) {
        return user_error_message(
            [&] { check_device_memory("s.nff", buffers_for(queue), 64, "a small device", device); });
    };
    CHECK(refusal(4000) == "no error");
    CHECK(refusal(4003) == "no error");
    CHECK(refusal(4004) ==
          "s.nff: queues of 4004 packets and their mailboxes in 64 nodes do not fit the memory of a small device; use "
          "--queue 2002 or fewer nodes");
    // Total memory for 4000 packets: the queues, and the mailboxes for rays and returns at both ends of each link.
    device.total = 64ull * 64 * 4000 + 3 * device.max_buffer;
    CHECK(refusal(4000) == "no error");
    --device.total;
    CHECK_THAT(refusal(4000), Catch::Contains("use --queue 2000 or fewer nodes"));
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
        const NodeSizes sizes = nodes_with_spheres(counts, torus);
        const std::uint32_t queue = min_queue + random_below(random, kDefaultQueue - min_queue);
        const std::uint64_t exact_bytes = node_words_bytes(max_count) + packet_bytes(queue, links);
        CAPTURE(seed, torus_text(torus), max_count, min_queue, queue);
        const auto plan = [&](std::uint64_t bytes, std::uint32_t requested_queue) {
            return plan_buffers("s", sizes, torus, bytes, requested_queue, min_queue);
        };
        REQUIRE(node_bytes(sizes.words.back(), {0, 0}, links) == node_words_bytes(counts.back()));
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

TEST_CASE("a queue that is too short for the tree of one ray is refused, with the required length", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 1}, Links::kTorus3d);
    const NodeSizes sizes = nodes_with_spheres({3, 4}, torus);
    CHECK(user_error_message([&] { plan_buffers("balls.nff", sizes, torus, {}, 6, 7); }) ==
          "balls.nff: --queue 6: the tree of a single ray may need 7 packets; use --queue 7 or more");
    CHECK(plan_buffers("balls.nff", sizes, torus, {}, 7, 7).queue == 7);
}

TEST_CASE("a scene that does not fit is refused with figures, the fullest node and the remedy", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 2}, Links::kTorus3d);
    const NodeSizes sizes = nodes_with_spheres({100, 300, 20, 200}, torus);
    const std::uint64_t limit = node_words_bytes(200) + packet_bytes(9, 4);
    const std::string figures = fmt::format(
        "s.nff: does not fit: 3 of 4 nodes can hold their voxels, 1 cannot; node 1 (voxel 1, 0, 0 with 300 objects) "
        "needs {:.1f} KB for the scene and 1.9 KB for buffers, a node has {:.1f} KB; ",
        std::ceil(node_words_bytes(300) / 102.4) / 10, std::floor(double(limit) / 102.4) / 10);
    REQUIRE(packet_bytes(9, 4) == 1920);  // 1.875 KB
    const std::uint64_t sufficient_bytes = (node_words_bytes(300) + 1920 + 1023) / 1024 * 1024;
    const auto refusal = [&](std::uint32_t queue) {
        return user_error_message([&] { plan_buffers("s.nff", sizes, torus, limit, queue, 9); });
    };
    CHECK(refusal(0) == figures + fmt::format("use more --nodes or --pe-memory {}", sufficient_bytes));
    CHECK(plan_buffers("s.nff", sizes, torus, sufficient_bytes, 0, 9).queue >= 9);

    try {
        plan_buffers("s.nff", sizes, torus, limit, 0, 9);
        FAIL("plan_buffers() has accepted a scene that does not fit");
    } catch (const NodesDoNotFit& error) {
        CHECK(error.nodes == 4);
        CHECK(error.fitting == 3);
        CHECK(error.fullest == 1);
        CHECK(error.needed_bytes == node_words_bytes(300) + packet_bytes(9, 4));
        CHECK(error.memory_bytes == limit);
    }
}

TEST_CASE("if a shorter queue fits, the refusal names it", "[torus]") {
    const raya_torus torus = make_torus({2, 1, 2}, Links::kTorus3d);
    const NodeSizes sizes = nodes_with_spheres({100, 300, 20, 200}, torus);
    const std::uint64_t limit = node_words_bytes(300) + packet_bytes(100, 4);
    const std::string message = user_error_message([&] { plan_buffers("s", sizes, torus, limit, 1000, 9); });
    const std::uint64_t sufficient_bytes = (node_words_bytes(300) + packet_bytes(1000, 4) + 1023) / 1024 * 1024;
    CHECK_THAT(message, Contains("0 of 4 nodes can hold") && Contains("and 226.6 KB for buffers") &&
                            Contains(fmt::format("; use --queue 100 or --pe-memory {}", sufficient_bytes)));
    CHECK(plan_buffers("s", sizes, torus, limit, 100, 9).queue == 100);
    CHECK(plan_buffers("s", sizes, torus, sufficient_bytes, 1000, 9).queue == 1000);
}

TEST_CASE("a refusal gives the fullest node's number of voxels, or the position of its only voxel", "[torus]") {
    SplitMix random(3);
    Scene scene = empty_scene();
    for (int i = 0; i < 40; ++i) add_sphere(scene, random, 1);
    scene.planes.resize(2);
    const PackedJob job = pack(scene);
    std::vector<std::set<std::uint32_t>> lists(24);  // 4 x 3 x 2 voxels
    lists[3] = {0, 1, 2, 3, 4};
    lists[19] = {5, 6, 7};  // (3, 1, 1)
    for (std::uint32_t i = 8; i < 40; ++i) lists[i % 2].insert(i);
    lists[1].clear();
    lists[0].clear();
    const Partition partition = partition_of({4, 3, 2}, lists);
    const auto refusal = [&](const std::array<std::uint32_t, 3>& nodes) {
        const raya_torus torus = make_torus(nodes, Links::kTorus3d);
        const NodeSizes sizes = node_sizes(job, partition, torus);
        return user_error_message([&] { plan_buffers("s", sizes, torus, 100, 0, 1); });
    };
    CHECK_THAT(refusal({4, 3, 2}), Contains("0 of 24 nodes") && Contains("node 3 (voxel 3, 0, 0 with 7 objects)"));
    CHECK_THAT(refusal({2, 3, 2}), Contains("0 of 12 nodes") && Contains("node 1 (2 voxels with 7 objects)"));
    CHECK_THAT(refusal({1, 1, 1}), Contains("0 of 1 nodes") && Contains("node 0 (24 voxels with 10 objects)"));
}
