// Operations that are exact in every format, and the ways into a format: rounded fp32 numbers and whole numbers.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/number/compare.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kSeed = 17;
constexpr std::size_t kRows = 20'000;

/// Rows of two numbers of the format, made from a mix of sizes, and one normal fp32 number or infinity.
Operands conversion_operands(const NumberFormat& format) {
    Operands operands = RandomOperands(format, kSeed).rows(kRows);
    const Operands wide = RandomOperands({8, 23, false}, kSeed).rows(kRows);
    operands.c = wide.a;
    operands.c[0] = INFINITY;
    operands.c[1] = -INFINITY;
    return operands;
}

std::vector<float> expected_row(MpfrOracle& oracle, float a, float b, float wide, std::size_t row) {
    return {-a, std::abs(a), a > b ? a : b, std::floor(a), oracle.round(wide), oracle.round(static_cast<double>(row))};
}

}  // namespace

TEST_CASE("exact operations are exact, conversions round once", "[number][conversions]") {
    for (const NumberFormat& format :
         {NumberFormat{5, 4, true}, NumberFormat{6, 15, false}, NumberFormat{8, 21, false}}) {
        const Operands operands = conversion_operands(format);
        const NumberBuild build = {format};
        const Results results = NumberRunner(build).run("conversions", operands, 6);
        MpfrOracle oracle(format);
        for (std::size_t i = 0; i < operands.rows(); ++i) {
            const auto expected = expected_row(oracle, operands.a[i], operands.b[i], operands.c[i], i);
            for (std::size_t k = 0; k < expected.size(); ++k) {
                if (results[k][i] == std::bit_cast<std::uint32_t>(expected[k])) continue;
                CAPTURE(build.name(), kSeed, i, k, operands.a[i], operands.b[i], operands.c[i], expected[k]);
                FAIL("found " << std::bit_cast<float>(results[k][i]));
            }
        }
    }
    SUCCEED();
}

}  // namespace raya
