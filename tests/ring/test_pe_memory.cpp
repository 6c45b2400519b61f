// What fits into a PE.
#include <catch2/catch.hpp>
#include <cstdint>

#include "error.hpp"
#include "ring/pe_memory.hpp"

using namespace raya;
using Catch::Contains;

namespace {

/// Bytes beside words of the job and pixels: the walk through a ray tree, which grows by a waiting ray a bounce.
std::uint64_t walk_bytes(std::uint32_t bounces) {
    return plan_pe_memory(machine_named("grande"), "s", 0, bounces, 0).bytes();
}

Machine machine_of(std::uint32_t bytes) {
    Machine machine = machine_named("spa");
    machine.pe_memory_bytes = bytes;
    return machine;
}

}  // namespace

TEST_CASE("memory is words of the job, the walk and three words a pixel, 4 bytes each", "[ring]") {
    const PeMemory memory = plan_pe_memory(machine_named("spa"), "s", 1000, 8, 256);
    CHECK(memory.job_words == 1000);
    CHECK(memory.block_pixels == 256);
    CHECK(memory.bytes() == 4 * 1000 + walk_bytes(8) + 12 * 256);
    CHECK(walk_bytes(8) - walk_bytes(7) == 4 * 7);  // origin, direction, weight
    CHECK(walk_bytes(0) > 0);
}

TEST_CASE("a machine without a limit holds everything", "[ring]") {
    const PeMemory memory = plan_pe_memory(machine_named("grande"), "s", 100'000'000, 8, 1'000'000);
    CHECK(memory.block_pixels == 1'000'000);
    CHECK(memory.bytes() > 400'000'000);
}

TEST_CASE("a share that does not fit is cut into the largest blocks that do", "[ring]") {
    const auto walk = static_cast<std::uint32_t>(walk_bytes(8));
    const std::uint64_t words = 500;
    for (const std::uint32_t pixels : {1u, 2u, 99u}) {
        const std::uint32_t exact = 4 * 500 + walk + 12 * pixels;
        CAPTURE(pixels);
        CHECK(plan_pe_memory(machine_of(exact), "s", words, 8, pixels).block_pixels == pixels);  // to the last byte
        CHECK(plan_pe_memory(machine_of(exact), "s", words, 8, pixels + 1).block_pixels == pixels);
        CHECK(plan_pe_memory(machine_of(exact + 11), "s", words, 8, 1000).block_pixels == pixels);
        CHECK(plan_pe_memory(machine_of(exact + 12), "s", words, 8, 1000).block_pixels == pixels + 1);
    }
    // The paper's run on one PE: 256 x 256 pixels.
    const PeMemory one = plan_pe_memory(machine_named("spa"), "s", 300, 8, 65'536);
    CHECK(one.block_pixels > 1000);
    CHECK(one.bytes() <= 32 * 1024);
    CHECK(one.bytes() + 12 > 32 * 1024);
}

TEST_CASE("a scene that leaves no room for a pixel is refused with both figures and the remedy", "[ring]") {
    const std::uint64_t words = (32 * 1024 - walk_bytes(8) - 12) / 4;  // the most that fit
    CHECK(plan_pe_memory(machine_named("spa"), "big.nff", words, 8, 256).block_pixels == 1);
    CHECK_THROWS_AS(plan_pe_memory(machine_named("spa"), "big.nff", words + 1, 8, 256), UserError);
    const std::uint64_t hundred_kb = (100 * 1024 - walk_bytes(8) - 12) / 4;
    CHECK_THROWS_WITH(plan_pe_memory(machine_named("spa"), "big.nff", hundred_kb, 8, 256),
                      Contains("big.nff") && Contains("100.0 KB") && Contains("32 KB") && Contains("the SPA") &&
                          Contains("--machine grande"));
}
