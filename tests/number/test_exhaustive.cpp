// Tests all rounding operations on every pair of numbers of the smallest formats, e5m4 and e5m4t.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host/scene/split_mix.hpp"
#include "tests/number/number_runs.hpp"
#include "tests/number/oracle_results.hpp"

namespace raya {
namespace {

/// Returns all numbers of the format, including zeros of both signs.
std::vector<float> all_numbers(const NumberFormat& format) {
    const Range range = range_of(format);
    std::vector<float> numbers = {0.0F, -0.0F};
    const int first = 1 << format.fraction_bits;
    for (int exponent = range.lowest; exponent <= range.highest; ++exponent)
        for (int significand = first; significand < 2 * first; ++significand) {
            const float magnitude = std::ldexp(static_cast<float>(significand), exponent - format.fraction_bits);
            numbers.push_back(magnitude);
            numbers.push_back(-magnitude);
        }
    return numbers;
}

}  // namespace

TEST_CASE("operations round correctly on every pair of numbers of e5m4", "[number][exhaustive]") {
    constexpr std::uint64_t kSeed = 54;
    for (const bool truncates : {false, true}) {
        const NumberFormat format = {5, 4, truncates};
        const std::vector<float> numbers = all_numbers(format);
        REQUIRE(numbers.size() == 2 + 2 * 30 * 16);
        SplitMix random(kSeed);
        NumberRows rows;
        for (const float a : numbers)
            for (const float b : numbers) rows.add(a, b, numbers[(random.next() >> 33) % numbers.size()]);
        rows.pad();
        const NumberBuild build = number_build(format);
        CAPTURE(build.name(), kSeed);
        CHECK(wrong_numbers(build, rows, expected_by_mpfr(format, rows)) == "");
    }
}

}  // namespace raya
