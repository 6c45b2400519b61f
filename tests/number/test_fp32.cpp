// fp32 in the number layer is IEEE 754's binary32: the host's own arithmetic is the oracle.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/number/compare.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::size_t kUsualRows = 100'000;
constexpr std::uint64_t kSeed = 754;
const NumberFormat kFp32;

/// What the device must give for the host's `value`. Any NaN will do for NaN, and a device that promises no denormal
/// numbers may make of one what it likes.
std::uint32_t wanted_bits(float value, std::uint32_t found, bool has_denormals) {
    if (std::isnan(value) && std::isnan(std::bit_cast<float>(found))) return found;
    if (!has_denormals && std::fpclassify(value) == FP_SUBNORMAL) return found;
    return std::bit_cast<std::uint32_t>(value);
}

Results host_results(const Operands& operands, const Results& found, bool has_denormals) {
    Results expected(6);
    for (std::size_t i = 0; i < operands.rows(); ++i) {
        const float a = operands.a[i], b = operands.b[i], c = operands.c[i];
        const float values[] = {a + b, a - b, a * b, a / b, std::sqrt(a), std::fma(a, b, c)};
        for (std::size_t k = 0; k < 6; ++k) expected[k].push_back(wanted_bits(values[k], found[k][i], has_denormals));
    }
    return expected;
}

void check_fp32(const NumberBuild& build) {
    const Operands operands = RandomOperands(kFp32, kSeed).rows(number_cases(kUsualRows));
    NumberRunner runner(build);
    const Results found = runner.run("operations", operands, 6);
    CAPTURE(build.name(), kSeed);
    CHECK(report_differences(operands, found, host_results(operands, found, runner.device().denormals)) == "");
}

}  // namespace

TEST_CASE("fp32 gives the bits of IEEE 754 from end to end of its range", "[number][fp32]") {
    check_fp32({kFp32, 1});
    check_fp32({kFp32, widest_lanes()});
}

TEST_CASE("fp32 gives the same bits on a device that errs, when refined", "[number][fp32][refined]") {
    check_fp32({kFp32, 1, true});
    check_fp32({kFp32, widest_lanes(), true});
}

}  // namespace raya
