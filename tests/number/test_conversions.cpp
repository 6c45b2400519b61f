// Tests operations that are exact in every format, and conversions of fp32 numbers and integers to a format.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/number/number_runs.hpp"
#include "tests/number/oracle_results.hpp"
#include "tests/number/random_operands.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kFirstSeed = 17;
constexpr std::size_t kRows = 20'000;

/// Appends `rows` to `all`, and the expected results of `operations` for these rows to `expected`.
void append(NumberRows& all, std::vector<ExpectedNumbers>& expected, const NumberFormat& format, const NumberRows& rows,
            const std::vector<std::size_t>& operations) {
    for (ExpectedNumbers& results : expected_by_mpfr(format, rows, operations)) {
        results.first_row = all.count();
        expected.push_back(std::move(results));
    }
    for (std::size_t i = 0; i < rows.count(); ++i) all.add(rows.a[i], rows.b[i], rows.c[i]);
}

}  // namespace

TEST_CASE("exact operations are exact, conversions round once", "[number][conversions]") {
    // `fp32_rows` has normal fp32 numbers and infinities, `integer_rows` integers.
    NumberRows fp32_rows = RandomOperands({8, 23, false}, kFirstSeed).rows(kRows), integer_rows;
    fp32_rows.a[0] = INFINITY;
    fp32_rows.a[1] = -INFINITY;
    for (std::uint32_t i = 0; i < kRows; ++i) integer_rows.add(std::bit_cast<float>(i), 1, 1);
    for (const NumberFormat& format :
         {NumberFormat{5, 4, true}, NumberFormat{6, 15, false}, NumberFormat{8, 21, false}}) {
        NumberRows rows;
        std::vector<ExpectedNumbers> expected;
        append(rows, expected, format, RandomOperands(format, kFirstSeed).rows(kRows), {kNeg, kAbs, kMax, kFloor});
        append(rows, expected, format, fp32_rows, {kRound});
        append(rows, expected, format, integer_rows, {kFromIndex});
        CAPTURE(format_name(format), kFirstSeed);
        CHECK(wrong_numbers(number_build(format), rows, expected) == "");
    }
}

}  // namespace raya
