// Compares the results of operations in reduced formats with those of MPFR, bit for bit, on random operands. With
// RAYA_NUMBER_CASES=1000000 the test uses that many rows of operands per format, more formats and all numbers of lanes.
#include <catch2/catch.hpp>
#include <cstdint>
#include <vector>

#include "tests/number/number_runs.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::size_t kDefaultRows = 40'000;
constexpr std::uint64_t kOracleSeed = 1993;

/// Returns formats eXmY with X = 5 .. 8 and Y = 4 .. 21, in both roundings. They include the smallest and the largest
/// format and the SPA's format. The layer has separate code for X = 8 and for Y > 15. The formats include each of these
/// cases alone, and both together.
std::vector<NumberFormat> tested_formats() {
    std::vector<NumberFormat> formats = {{5, 4}, {8, 7}, {6, 15}, {7, 18}, {8, 21}};
    if (is_long_run(kDefaultRows))
        formats.insert(formats.end(),
                       {{7, 10}, {5, 12}, {8, 15}, {5, 21}, {8, 4}, {6, 7}, {8, 16}, {6, 16}, {8, 18}, {7, 21}});
    for (std::size_t i = formats.size(); i-- > 0;)
        formats.push_back({formats[i].exponent_bits, formats[i].fraction_bits, true});
    return formats;
}

/// Returns the numbers of lanes to test: all in a long run, otherwise the largest, and 1 for the most important
/// formats.
std::vector<std::uint32_t> tested_lanes(const NumberFormat& format) {
    if (is_long_run(kDefaultRows)) return {1, 4, 8, 16};
    if (format == NumberFormat{6, 15, false} || format == NumberFormat{8, 21, false}) return {1, widest_lanes()};
    return {widest_lanes()};
}

}  // namespace

TEST_CASE("every operation rounds the exact value once, as MPFR does", "[number][oracle]") {
    for (const NumberFormat& format : tested_formats()) {
        const NumberRows rows = RandomOperands(format, kOracleSeed).rows(row_count(kDefaultRows));
        const std::vector<ExpectedNumbers> expected = expected_by_mpfr(format, rows);
        for (const std::uint32_t lanes : tested_lanes(format)) {
            const NumberBuild build = number_build(format, lanes);
            CAPTURE(build.name(), kOracleSeed);
            CHECK(wrong_numbers(build, rows, expected) == "");
        }
    }
}

TEST_CASE("on a device with inexact division and square root, the refined operations round correctly",
          "[number][refined]") {
    for (const NumberFormat& format :
         {NumberFormat{6, 15, false}, NumberFormat{8, 21, false}, NumberFormat{5, 12, true}})
        for (const std::uint32_t lanes : {1u, widest_lanes()}) {
            if (lanes == 1 && format.fraction_bits != 15) continue;
            const NumberRows rows = RandomOperands(format, kOracleSeed).rows(row_count(kDefaultRows));
            const NumberBuild build = refined_build(format, lanes);
            CAPTURE(build.name(), kOracleSeed);
            CHECK(wrong_numbers(build, rows, expected_by_mpfr(format, rows)) == "");
        }
}

TEST_CASE("the simulated errors are those of correctly rounded quotients", "[number][refined]") {
    Session session(choose_device(""));
    CHECK_THAT(number_runner(session, refined_build({6, 15, false}, 1)).options(),
               Catch::Contains("-cl-fp32-correctly-rounded-divide-sqrt"));
}

}  // namespace raya
