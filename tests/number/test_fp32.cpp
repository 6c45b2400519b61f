// In fp32 the number layer gives the results of IEEE 754 binary32, as MPFR computes them.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/number/number_runs.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {

TEST_CASE("fp32 gives the bits of IEEE 754 over its whole range, in all builds", "[number][fp32]") {
    constexpr std::size_t kDefaultFp32Rows = 100'000;
    constexpr std::uint64_t kFp32Seed = 754;
    const NumberFormat fp32;
    std::vector<NumberBuild> builds = fp32_builds();
    for (const std::uint32_t lanes : {1u, widest_lanes()}) builds.push_back(refined_build(fp32, lanes));
    const NumberRows rows = RandomOperands(fp32, kFp32Seed).rows(row_count(kDefaultFp32Rows));
    std::vector<std::size_t> operations = kRoundingOperations;
    operations.insert(operations.end(), {kMax, kFloor, kRound, kFromIndex, kNeg, kAbs});
    const std::vector<ExpectedNumbers> expected = expected_by_mpfr(fp32, rows, operations);
    for (const NumberBuild& build : builds) {
        CAPTURE(build.name(), kFp32Seed);
        CHECK(wrong_numbers(build, rows, expected) == "");
    }
}

}  // namespace raya
