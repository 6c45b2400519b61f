// Masks: selection, counting and reductions over lanes.
#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "tests/kernels/kernel_runner.hpp"

namespace raya {
namespace {

using Words = std::vector<std::uint32_t>;

/// Returns a number with a random sign and fraction, and an exponent from -40 to 40, so that all results are normal.
float random_float(SplitMix& random) {
    const std::uint64_t word = random.next();
    const auto exponent = static_cast<std::uint32_t>(127 - 40 + (word >> 32) % 81);
    return std::bit_cast<float>((static_cast<std::uint32_t>(word) & 0x807fffffu) | exponent << 23);
}

}  // namespace

TEST_CASE("masks choose, count and reduce correctly for every combination of lanes", "[number]") {
    constexpr std::uint64_t kSeed = 62;
    constexpr std::size_t kColumns = 9;
    // Groups of 16 rows with these masks: no lane true, all lanes true, exactly one lane true, exactly one lane false,
    // and random masks. A lane is true if a < b.
    SplitMix random(kSeed);
    std::vector<bool> truth(16, false);
    truth.insert(truth.end(), 16, true);
    for (std::size_t i = 0; i < 256; ++i) truth.push_back(i / 16 == i % 16);
    for (std::size_t i = 0; i < 256; ++i) truth.push_back(i / 16 != i % 16);
    for (std::size_t i = 0; i < 512; ++i) truth.push_back(random.next() >> 63);
    std::vector<float> operands;
    for (const bool is_true : truth) {
        operands.push_back(random_float(random));
        const float above = std::nextafter(operands.back(), HUGE_VALF);
        operands.push_back(is_true ? above : operands.back());  // equal: a < b is false
    }
    for (const TestBuild& test_build : test_builds()) {
        KernelRunner runner("tests/number/masks.cl", test_build);
        const auto operand_buffer = runner.filled("operands", operands);
        auto result_buffer = runner.poisoned("results", truth.size() * kColumns);
        runner.run_rows<const Buffer<float>&, Buffer<std::uint32_t>&>("masks", truth.size(), operand_buffer,
                                                                      result_buffer);
        const Words results = runner.read(result_buffer);
        for (std::uint32_t i = 0; i < truth.size(); ++i) {
            const auto group = truth.begin() + i / test_build.lanes * test_build.lanes;
            const auto any = [&](bool value) {
                return std::find(group, group + test_build.lanes, value) != group + test_build.lanes;
            };
            const Words expected = {std::bit_cast<std::uint32_t>(operands[2 * i]),  // a, which equals b if m is false
                                    truth[i] ? i : 12345u,
                                    i + truth[i],
                                    truth[i] ? i + 5 : i,
                                    any(true),
                                    any(false),
                                    truth[i],
                                    2,
                                    std::bit_cast<std::uint32_t>(static_cast<float>(i))};
            const Words row(results.begin() + i * kColumns, results.begin() + (i + 1) * kColumns);
            CAPTURE(test_build.name(), kSeed, i);
            CHECK(row == expected);
        }
    }
}

}  // namespace raya
