// In fp32 the number layer gives the results of IEEE 754 binary32. The oracle is the host's arithmetic.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/kernels/unoptimised.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::size_t kFp32Rows = 100'000;
constexpr std::uint64_t kFp32Seed = 754;
const NumberFormat kFp32;

void check_fp32(const NumberBuild& build) {
    const NumberRows rows = RandomOperands(kFp32, kFp32Seed).rows(row_count(kFp32Rows));
    std::vector<std::size_t> operations = kRoundingOperations;
    operations.insert(operations.end(), {kMax, kFloor, kRound, kFromIndex, kNeg, kAbs});
    HostOracle host;
    CAPTURE(build.name(), kFp32Seed);
    CHECK(wrong_numbers(build, rows, expected_by(host, rows, operations)) == "");
}

}  // namespace

TEST_CASE("fp32 gives the bits of IEEE 754 over its whole range, in all builds", "[number][fp32]") {
    for (const std::uint32_t lanes : {1u, 4u, 8u, 16u})
        for (const bool optimised : {true, false}) {
            if (lanes > widest_lanes() || (!optimised && !tests_unoptimised(lanes))) continue;
            check_fp32({.format = kFp32, .lanes = lanes, .optimised = optimised});
        }
}

TEST_CASE("refined fp32 gives the bits of IEEE 754 on a device with inexact division and square root",
          "[number][fp32][refined]") {
    check_fp32(refined_build(kFp32, 1));
    check_fp32(refined_build(kFp32));
}

}  // namespace raya
