// If a scene does not fit a machine, raya's message names a machine and a memory size that can hold the scene. A node
// trial packs the scene for other numbers of nodes to find them.
#include <catch2/catch.hpp>
#include <cstdint>
#include <regex>
#include <string>

#include "tests/torus/random_nodes.hpp"

using namespace raya;
using Catch::Contains;

namespace {

struct PartitionedJob {
    PackedJob job;
    NumberFormat format;

    NodeBuffers plan(const std::array<std::uint32_t, 3>& nodes, const Divisions& voxels, std::uint64_t memory) const {
        const raya_torus torus = make_torus(nodes, Links::kTorus3d);
        const NodeSizes sizes = node_sizes(job, partition(job, format, voxels), torus);
        return plan_buffers("s", sizes, torus, memory, 0, 4, make_node_trial(job, format, voxels));
    }
};

// Returns the value of an option in a message, such as "16x16x8"; `default_sides` if the option is missing.
Divisions sides_in(const std::string& message, const std::string& option, const Divisions& default_sides) {
    std::smatch m;
    if (!std::regex_search(message, m, std::regex(option + " (\\d+)x(\\d+)x(\\d+)"))) return default_sides;
    const auto side = [&](int i) { return static_cast<std::uint32_t>(std::stoul(m[i])); };
    return {side(1), side(2), side(3)};
}

Scene small_spheres(SplitMix& random, int count) {
    Scene scene = empty_scene();
    for (int i = 0; i < count; ++i) scene.spheres.push_back({random_point(random, 2), 0.01, round_surface(random)});
    return scene;
}

}  // namespace

TEST_CASE("the scene fits on the machine and in the memory that a refusal names", "[torus]") {
    int named_machines = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        SplitMix random(seed);
        const PartitionedJob partitioned_job{
            pack(small_spheres(random, 1000 + static_cast<int>(random_below(random, 3000)))), {}};
        const auto nodes = random_sides(random, 3);
        const Divisions voxels = seed % 2 ? nodes : random_sides(random, 6);
        const std::uint64_t memory = 3000 + random_below(random, 4000);
        const std::string message = user_error_message([&] { partitioned_job.plan(nodes, voxels, memory); });
        CAPTURE(seed, sides_text(nodes), sides_text(voxels), memory, message);
        if (message == "no error") continue;
        std::smatch memory_option;
        REQUIRE(std::regex_search(message, memory_option, std::regex("--pe-memory (\\d+)$")));
        CHECK_NOTHROW(partitioned_job.plan(nodes, voxels, std::stoull(memory_option[1])));
        if (message.find("--nodes") == std::string::npos) continue;
        const Divisions larger = sides_in(message, "--nodes", {});
        CHECK_NOTHROW(partitioned_job.plan(larger, sides_in(message, "--voxels", larger), memory));
        ++named_machines;
    }
    CHECK(named_machines > 30);
}

TEST_CASE("if every object is in every voxel, the refusal names no larger machine", "[torus]") {
    SplitMix random(1);
    // e8m7 is so coarse that the region of each sphere covers the whole scene.
    const PartitionedJob partitioned_job{pack(small_spheres(random, 5000)), parse_format("e8m7")};
    for (const auto& nodes : {std::array<std::uint32_t, 3>{1, 1, 1}, {4, 4, 4}})
        CHECK_THAT(user_error_message([&] { partitioned_job.plan(nodes, nodes, 32768); }),
                   Contains("no machine of up to 65536 nodes is large enough; use --pe-memory"));
}
