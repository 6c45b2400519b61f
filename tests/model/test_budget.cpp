// The instruction budgets: cycles of events counted by hand, sums, and the accuracy of divisions and square roots,
// which a DSP computes from a first approximation (seed) by a Newton step.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "host/model/budget.hpp"
#include "host/scene/split_mix.hpp"

namespace raya {
namespace {

std::uint64_t cycles_of(const Operations& sum) {
    return sum.multiply_accumulates + kDivisionCycles * sum.divisions + kSquareRootCycles * sum.roots + sum.moves +
           kBranchCycles * sum.branches;
}

/// Returns log2 of the maximum of |relative_error(x)| for x in [1, 4). The seed table of square roots covers these two
/// binades.
template <class RelativeError>
double error_bits(RelativeError&& relative_error) {
    double max_error = 0;
    for (int i = 0; i < 3 << 16; ++i) max_error = std::max(max_error, std::abs(relative_error(1 + std::ldexp(i, -16))));
    return std::log2(max_error);
}

/// Returns `value` rounded to 9 fraction bits after its leading bit, the precision of a word in the tables of seeds.
double table_word(double value) {
    const int exponent = std::ilogb(value);
    return std::ldexp(std::nearbyint(std::ldexp(value, 9 - exponent)), exponent - 9);
}

}  // namespace

// Cycles of a division: 3 for the seed y, and one each for e = 1 - b y, y + e y and a y. Cycles of a square root: 3 for
// the seed y, and one each for x/2, y y, d = 3/2 - (x/2)(y y), y d, and x y. Cycles of a branch: 3.
TEST_CASE("cycles of each event agree with those counted by hand", "[machine]") {
    CHECK(kDivisionCycles == 6);
    CHECK(kSquareRootCycles == 8);
    CHECK(kBranchCycles == 3);
    const auto cycles = cycles_of_events();
    CHECK(cycles[RAYA_SPHERE_TESTS] == 12 + 3);        // three dot products, a difference; one branch
    CHECK(cycles[RAYA_PLANE_TESTS] == 7 + 6 + 2 * 3);  // two dot products, a comparison; a division; two branches
    CHECK(cycles[RAYA_POLYGON_TESTS] == 24 + 6 + 2 + 2 + 5 * 3);  // corners, edges, plane; two moves; five branches
    CHECK(cycles[RAYA_CONE_TESTS] == 40 + 6 + 2 * 3);
    CHECK(cycles[RAYA_SHADOW] == 12 + 6 + 8 + 4 + 5 * 3);
    CHECK(cycles[RAYA_SHADOW_HITS] == 3 + 8 + 2 * 3);
    CHECK(cycles[RAYA_PRIMARY] == 12 + 6 + 8 + 16 + 3 * 3);
    CHECK(cycles[RAYA_REFLECTED] == 1 + 10 + 2 * 3);
    CHECK(cycles[RAYA_REFRACTED] == 24 + 2 * 6 + 2 * 8 + 18 + 4 * 3);
    CHECK(cycles[RAYA_SHADED] == 43 + 6 + 2 * 8 + 2 + 10 * 3);
    CHECK(cycles[RAYA_LIT] == 15 + 2 * 3);
    CHECK(cycles[RAYA_HIGHLIGHTS] == 22 + 6 + 5 + 3);
}

TEST_CASE("the cycles of the operations of many events equal the cycles of the events", "[machine]") {
    constexpr std::uint64_t kSeed = 5;
    SplitMix random(kSeed);
    for (int i = 0; i < 500; ++i) {
        CAPTURE(kSeed, i);
        EventCounts events{};
        std::uint64_t cycles = 0;
        for (std::size_t event = 0; event < RAYA_EVENTS; ++event) {
            events[event] = random.next() >> (24 + random.next() % 40);  // < 2^40
            cycles += events[event] * cycles_of_events()[event];
        }
        CHECK(cycles_of(operations_of(events)) == cycles);
    }
    CHECK(cycles_of(operations_of({})) == 0);
}

// Cycles per pixel. Filter: 3 x (4 additions, 1 multiplication), as many moves, 4 branches of 3 cycles: 42. Comparison:
// 4 sides x 3 colours x 6 operations, one move, 16 branches: 121.
TEST_CASE("smoothing takes the same number of cycles for each pixel of a PE", "[machine]") {
    for (const std::uint64_t pixels : {0ull, 1ull, 256ull, 1ull << 40}) {
        CAPTURE(pixels);
        CHECK(filter_cycles(pixels) == 42 * pixels);
        CHECK(compare_cycles(pixels) == 121 * pixels);
    }
}

TEST_CASE("a seed from the table and one Newton step have the accuracy that the budget assumes", "[machine]") {
    // The top 8 bits of the significand select a table word: the reciprocal of the middle of their interval.
    const auto reciprocal_seed = [](double b) {
        const int exponent = std::ilogb(b);
        const double significand = std::ldexp(b, -exponent);
        return std::ldexp(table_word(1 / ((std::floor(significand * 256) + 0.5) / 256)), -exponent);
    };
    const auto reciprocal = [&](double b) {
        const double y = reciprocal_seed(b);
        return y + (1 - b * y) * y;
    };
    // The exponent's lowest bit and 7 bits of the significand select a table word: 128 words for each of two binades.
    const auto root_seed = [](double x) {
        const double step = x < 2 ? 128 : 64;
        return table_word(1 / std::sqrt((std::floor(x * step) + 0.5) / step));
    };
    const auto root = [&](double x) {
        const double y = root_seed(x);
        return x * y * (1.5 - 0.5 * x * y * y);
    };
    CHECK(error_bits([&](double b) { return b * reciprocal_seed(b) - 1; }) < -8);
    CHECK(error_bits([&](double b) { return b * reciprocal(b) - 1; }) < -16);
    CHECK(error_bits([&](double x) { return std::sqrt(x) * root_seed(x) - 1; }) < -8);
    CHECK(error_bits([&](double x) { return root(x) / std::sqrt(x) - 1; }) < std::log2(1.5) - 16);
    // One Newton step does not reach the 23 fraction bits of fp32.
    CHECK(error_bits([&](double x) { return root(x) / std::sqrt(x) - 1; }) > -23);
}

}  // namespace raya
