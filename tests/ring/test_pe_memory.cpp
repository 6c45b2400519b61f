// The memory plan of a PE (plan_pe_memory()).
#include <catch2/catch.hpp>
#include <cstdint>
#include <string>

#include "host/model/machine.hpp"
#include "host/ring/ring_plan.hpp"
#include "host/scene/split_mix.hpp"

using namespace raya;
using Catch::Contains;

namespace {

/// Returns the number of bytes of the stack for the ray tree. The stack grows by one ray per bounce.
std::uint64_t ray_tree_bytes(std::uint32_t bounces) {
    return plan_pe_memory(machine_named("grande"), {.scene = "s", .bounces = bounces}).bytes();
}

Machine machine_of(std::uint64_t bytes) {
    Machine machine = machine_named("spa");
    machine.pe_memory_bytes = static_cast<std::uint32_t>(bytes);
    return machine;
}

PeDemand demand(std::uint64_t job_words, std::uint32_t share, AntialiasMethod method = AntialiasMethod::kNone) {
    return {.scene = "s", .job_words = job_words, .bounces = 8, .share_pixels = share, .antialias = method};
}

/// Returns the number of bytes that a PE needs if it exchanges pixels, without the pixels in transit. Each pixel has
/// three words of colour, and three words of sums (filter) or a mark of one byte (supersampling).
std::uint64_t bytes_without_band(const PeDemand& d) {
    const std::uint64_t pixel_bytes = d.antialias == AntialiasMethod::kFilter ? 24 : 13;
    return 4 * d.job_words + ray_tree_bytes(d.bounces) + pixel_bytes * d.share_pixels;
}

/// Returns the number of pixels in the longest band if the share is cut into the minimum number of equal bands that fit
/// in the free bytes; 0 if no band fits.
std::uint32_t longest_band(std::uint32_t share, std::uint64_t free_bytes) {
    for (std::uint32_t parts = 1; parts <= share; ++parts) {
        const std::uint32_t longest = share / parts + (share % parts != 0);
        if (12ull * longest <= free_bytes) return longest;
    }
    return 0;
}

}  // namespace

TEST_CASE("a PE's memory is the job's words, the stack for the ray tree and three words per pixel, of 4 bytes each",
          "[ring]") {
    const PeMemory memory = plan_pe_memory(machine_named("spa"), demand(1000, 256));
    CHECK(memory.job_words == 1000);
    CHECK(memory.block_pixels == 256);
    CHECK((memory.sum_pixels == 0 && memory.band_pixels == 0 && memory.marks == 0));
    CHECK(memory.bytes() == 4 * 1000 + ray_tree_bytes(8) + 12 * 256);
    CHECK(ray_tree_bytes(8) - ray_tree_bytes(7) == 4 * 7);  // a ray has 7 words: origin, direction, weight
    CHECK(ray_tree_bytes(0) > 0);
}

TEST_CASE("a share that does not fit is cut into the largest blocks that fit", "[ring]") {
    const std::uint64_t words = 500;
    for (const std::uint32_t pixels : {1u, 2u, 99u}) {
        const std::uint64_t exact = 4 * words + ray_tree_bytes(8) + 12 * pixels;
        const auto block = [&](std::uint64_t bytes, std::uint32_t share) {
            return plan_pe_memory(machine_of(bytes), demand(words, share)).block_pixels;
        };
        CAPTURE(pixels);
        CHECK(block(exact, pixels) == pixels);  // fits to the last byte
        CHECK(block(exact, pixels + 1) == pixels);
        CHECK(block(exact + 11, 1000) == pixels);
        CHECK(block(exact + 12, 1000) == pixels + 1);
    }
    // The paper's run on one PE: 256 x 256 pixels.
    const PeMemory on_one_pe = plan_pe_memory(machine_named("spa"), demand(300, 65'536));
    CHECK(on_one_pe.block_pixels > 1000);
    CHECK(on_one_pe.bytes() <= 32 * 1024);
    CHECK(on_one_pe.bytes() + 12 > 32 * 1024);
}

TEST_CASE("PEs exchange the whole share, or the minimum number of equal parts of it that fit", "[ring]") {
    constexpr std::uint64_t kSeed = 4;
    SplitMix random(kSeed);
    int cut_shares = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto method = random.next() % 2 ? AntialiasMethod::kFilter : AntialiasMethod::kSupersample;
        const PeDemand d = demand(random.next() % 300, 1 + static_cast<std::uint32_t>(random.next() % 300), method);
        const std::uint64_t free_bytes = 12 + random.next() % (13 * d.share_pixels);
        CAPTURE(kSeed, i, d.job_words, d.share_pixels, free_bytes, antialias_name(method));
        const PeMemory memory = plan_pe_memory(machine_of(bytes_without_band(d) + free_bytes), d);
        CHECK(memory.block_pixels ==
              d.share_pixels);  // all pixels stay in the PE, because other PEs may need any of them
        CHECK(memory.sum_pixels == (method == AntialiasMethod::kFilter ? d.share_pixels : 0));
        CHECK(memory.marks == (method == AntialiasMethod::kSupersample ? d.share_pixels : 0));
        CHECK(memory.band_pixels == longest_band(d.share_pixels, free_bytes));
        CHECK(memory.bytes() == bytes_without_band(d) + 12ull * memory.band_pixels);
        CHECK(memory.bytes() <= bytes_without_band(d) + free_bytes);
        cut_shares += memory.band_pixels < d.share_pixels;
    }
    CHECK(cut_shares > 500);
    const auto band = [](std::uint64_t pixels) {
        const PeDemand d = demand(100, 100, AntialiasMethod::kFilter);
        return plan_pe_memory(machine_of(bytes_without_band(d) + 12 * pixels), d).band_pixels;
    };
    CHECK((band(100) == 100 && band(99) == 50 && band(50) == 50 && band(49) == 34 && band(1) == 1));
}

TEST_CASE("a scene or share that leaves no memory for a pixel is refused with both figures and the remedy", "[ring]") {
    for (const auto method : {AntialiasMethod::kNone, AntialiasMethod::kFilter, AntialiasMethod::kSupersample}) {
        const bool smoothed = method != AntialiasMethod::kNone;
        CAPTURE(antialias_name(method));
        PeDemand d = demand(700, 333, method);
        const std::uint64_t minimum = smoothed ? bytes_without_band(d) + 12 : 4 * 700 + ray_tree_bytes(8) + 12;
        const PeMemory memory = plan_pe_memory(machine_of(minimum), d);
        CHECK((smoothed ? memory.band_pixels : memory.block_pixels) == 1);
        try {
            plan_pe_memory(machine_of(minimum - 1), d);
            FAIL("plan_pe_memory() has accepted a scene that is one byte too large");
        } catch (const DoesNotFit& error) {
            CHECK(error.needed_bytes == minimum);
            CHECK(error.memory_bytes == minimum - 1);
        }
        d.scene = "big.nff";
        d.job_words = 100'000;
        CHECK_THROWS_WITH(plan_pe_memory(machine_named("spa"), d), Contains("big.nff") && Contains("32 KB") &&
                                                                       Contains("the SPA") &&
                                                                       Contains("--machine grande"));
        const auto more_pes = Contains("more PEs");
        if (smoothed) CHECK_THROWS_WITH(plan_pe_memory(machine_named("spa"), d), more_pes);
        if (!smoothed) CHECK_THROWS_WITH(plan_pe_memory(machine_named("spa"), d), !more_pes);  // every PE has the scene
    }
}
