// Hand-written cases with known results, which need no oracle: ties, carries, cancellation, the ends of the range,
// zeros.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/number/mpfr_oracle.hpp"
#include "tests/number/number_runs.hpp"

namespace raya {
namespace {

struct Case {
    const char* what;
    std::size_t operation;
    double a, b, c;             // operands
    double nearest, truncated;  // expected results, rounded to nearest and toward zero
};

double two_to(int exponent) { return std::ldexp(1, exponent); }

/// Numbers of a format from which the format's cases are made.
struct SpecialNumbers {
    explicit SpecialNumbers(const NumberFormat& format)
        : unit(two_to(-format.fraction_bits)),
          base(two_to(range_of(format).highest - 1)),
          step(base * unit),
          smallest(two_to(range_of(format).lowest)),
          largest(two_to(range_of(format).highest) * (2 - unit)) {}

    double unit;      // 2^-Y: the distance from 1 to the next number
    double base;      // a power of two so large that fractions of `step` are in the format
    double step;      // the distance from `base` to the next number
    double smallest;  // the smallest number above 0
    double largest;   // the largest number
};

/// Returns cases of sums and differences.
std::vector<Case> sums(const SpecialNumbers& f) {
    const double b = f.base, s = f.step, above = 1 + f.unit, below = 1 - f.unit / 2, all_ones = b * (2 - f.unit);
    return {
        {"a tie, rounded down to the even number", kAdd, b, s / 2, 0, b, b},
        {"a tie, rounded up to the even number", kAdd, b + s, s / 2, 0, b + 2 * s, b + s},
        {"a tie that the last bit of the addend breaks upwards", kAdd, b, s / 2 * above, 0, b + s, b},
        {"a tie that the last bit of the addend breaks downwards", kAdd, b + s, s / 2 * below, 0, b + s, b + s},
        {"a negative tie", kAdd, -b - s, -s / 2, 0, -b - 2 * s, -b - s},
        {"a difference that is a tie", kSub, b + s, s / 2, 0, b, b},
        {"below a power of two the steps are half as wide: a tie", kSub, b, s / 4, 0, b, b - s / 2},
        {"a tie below a power of two, broken upwards", kSub, b, s / 4 * below, 0, b, b - s / 2},
        {"a tie below a power of two, broken downwards", kSub, b, s / 4 * above, 0, b - s / 2, b - s / 2},
        {"a sum carries into the next binade", kAdd, all_ones, s, 0, 2 * b, 2 * b},
        {"a tie carries into the next binade", kAdd, all_ones, s / 2, 0, 2 * b, all_ones},
        {"an addend far too small to matter", kAdd, b, f.smallest, 0, b, b},
        {"a tiny subtrahend matters when truncating", kSub, b, f.smallest, 0, b, b - s / 2},
        {"cancellation leaves the last bit", kSub, b + s, b, 0, s, s},
        {"cancellation across a binade", kSub, b, b * below, 0, s / 2, s / 2},
        {"a - a is +0", kSub, b, b, 0, 0.0, 0.0},
        {"-a + a is +0", kAdd, -b, b, 0, 0.0, 0.0},
        {"0 + -0 is +0", kAdd, 0.0, -0.0, 0, 0.0, 0.0},
        {"-0 + -0 is -0", kAdd, -0.0, -0.0, 0, -0.0, -0.0},
        {"-0 - 0 is -0", kSub, -0.0, 0.0, 0, -0.0, -0.0},
        {"0 - 0 is +0", kSub, 0.0, 0.0, 0, 0.0, 0.0},
        {"a + -0 is a", kAdd, f.smallest, -0.0, 0, f.smallest, f.smallest},
        {"overflow saturates", kAdd, f.largest, f.largest, 0, f.largest, f.largest},
        {"negative overflow saturates", kSub, -f.largest, f.largest, 0, -f.largest, -f.largest},
        {"half a step above the largest saturates", kAdd, f.largest, s, 0, f.largest, f.largest},
        {"the sum is the largest number", kAdd, f.largest - 2 * s, 2 * s, 0, f.largest, f.largest},
        {"a difference below the smallest is flushed", kSub, f.smallest * above, f.smallest, 0, 0.0, 0.0},
        {"a negative difference below the smallest is flushed to -0", kSub, f.smallest, f.smallest * above, 0, -0.0,
         -0.0},
        {"the smallest difference", kSub, f.smallest * 2, f.smallest, 0, f.smallest, f.smallest},
    };
}

/// Returns cases of products.
std::vector<Case> products(const SpecialNumbers& f) {
    const double above = 1 + f.unit, below = 1 - f.unit / 2, low = f.smallest, high = f.largest;
    return {
        {"(1 + u)^2, whose last bit is far below the rounding", kMul, above, above, 0, 1 + 2 * f.unit, 1 + 2 * f.unit},
        {"(1 - u/2)^2 rounds to 1 - u", kMul, below, below, 0, 1 - f.unit, 1 - f.unit},
        {"(1 + u)(1 - u/2): just below a tie between 1 and 1 + u", kMul, above, below, 0, 1, 1},
        {"1.5 (1 + u): a tie, upwards to even", kMul, 1.5, above, 0, 1.5 + 2 * f.unit, 1.5 + f.unit},
        {"1.5 (1 + 3 u): a tie, downwards to even", kMul, -1.5, 1 + 3 * f.unit, 0, -1.5 - 4 * f.unit,
         -1.5 - 4 * f.unit},
        {"-0 * 1 is -0", kMul, -0.0, 1, 0, -0.0, -0.0},
        {"-0 * -1 is +0", kMul, -0.0, -1, 0, 0.0, 0.0},
        {"overflow saturates", kMul, high, -high, 0, -high, -high},
        {"a product just above the largest saturates", kMul, high, above, 0, high, high},
        {"underflow is flushed with its sign", kMul, -low, low, 0, -0.0, -0.0},
        {"half of the smallest is flushed", kMul, low, 0.5, 0, 0.0, 0.0},
        {"less than half a step above the smallest: rounded to the smallest", kMul, low * above, below, 0, low, low},
        {"just below the smallest: flushed, not rounded to the smallest", kMul, low, below, 0, 0.0, 0.0},
        {"far less than a unit below the smallest: rounded to the smallest, or flushed", kMul, -low * above, 1 - f.unit,
         0, -low, -0.0},
    };
}

/// Returns cases of quotients and square roots.
std::vector<Case> quotients(const SpecialNumbers& f) {
    const double above = 1 + f.unit, below = 1 - f.unit / 2, low = f.smallest, high = f.largest;
    return {
        {"x / 0 saturates", kDiv, 1, 0.0, 0, high, high},
        {"x / -0 saturates with the product of both signs", kDiv, 1, -0.0, 0, -high, -high},
        {"-x / 0 saturates with the sign of -x", kDiv, -low, 0.0, 0, -high, -high},
        {"0 / 0 saturates", kDiv, 0.0, 0.0, 0, high, high},
        {"-0 / 0 saturates with the sign of -0", kDiv, -0.0, 0.0, 0, -high, -high},
        {"0 / -3 is -0", kDiv, 0.0, -3, 0, -0.0, -0.0},
        {"x / x is 1", kDiv, high, high, 0, 1, 1},
        {"a quotient above the range saturates", kDiv, high, low, 0, high, high},
        {"a quotient below the range is flushed with its sign", kDiv, low, -high, 0, -0.0, -0.0},
        {"1 / (1 + u), between 1 - u and 1 - u / 2", kDiv, 1, above, 0, 1 - f.unit, 1 - f.unit},
        {"1 / (1 - u/2), between 1 and 1 + u, just above the middle", kDiv, 1, below, 0, 1 + f.unit, 1},
        {"a quotient just below the smallest is flushed", kDiv, low, above, 0, 0.0, 0.0},
        {"the square root of a negative number is +0", kSqrt, -1, 0, 0, 0.0, 0.0},
        {"the square root of the smallest negative number is +0", kSqrt, -low, 0, 0, 0.0, 0.0},
        {"the square root of -0 is +0", kSqrt, -0.0, 0, 0, 0.0, 0.0},
        {"the square root of 0 is 0", kSqrt, 0.0, 0, 0, 0.0, 0.0},
        {"the square root of a square is exact", kSqrt, 2.25, 0, 0, 1.5, 1.5},
        {"the square root of 1 + u is just below a tie", kSqrt, above, 0, 0, 1, 1},
        {"the square root of 1 - u/2 is just below the middle of 1 - u/2 and 1", kSqrt, below, 0, 0, 1 - f.unit / 2,
         1 - f.unit / 2},
        {"the square root of 4 (1 + 2 u) is just below 2 (1 + u)", kSqrt, 4 + 8 * f.unit, 0, 0, 2 + 2 * f.unit, 2.0},
        {"the square root of the smallest is exact", kSqrt, low, 0, 0, std::sqrt(low),
         std::sqrt(low)},  // low is an even power of 2
    };
}

/// Returns cases of multiply-accumulates.
std::vector<Case> accumulations(const SpecialNumbers& f) {
    const double u = f.unit, above = 1 + u, low = f.smallest, high = f.largest, b = f.base, s = f.step;
    return {
        {"one rounding: (1 + u)^2 - (1 + 2 u) = u^2, or flushed", kMad, above, above, -(1 + 2 * u),
         u * u < low ? 0.0 : u * u, u * u < low ? 0.0 : u * u},
        {"ab = -c gives +0", kMad, 1.5, -1, 1.5, 0.0, 0.0},
        {"0 x + -0 with a negative product", kMad, 0.0, -1, -0.0, -0.0, -0.0},
        {"0 x + -0 with a positive product", kMad, 0.0, 1, -0.0, 0.0, 0.0},
        {"a product of half a step: a tie, downwards to even", kMad, s, 0.5, b, b, b},
        {"a product of half a step: a tie, upwards to even", kMad, s, 0.5, b + s, b + 2 * s, b + s},
        {"tie broken upwards by the product's last bit", kMad, s * above, 0.5, b, b + s, b},
        {"tie broken by a product far below", kMad, b, 0.5, low, b / 2, b / 2},
        {"tiny c of the other sign than the product", kMad, b, 0.5, -low, b / 2, b / 2 - s / 4},
        {"tiny product of the other sign than c", kMad, low, -low, b, b, b - s / 2},
        {"tie of the product, broken by c upwards", kMad, 1.5, above, low, 1.5 + 2 * u, 1.5 + u},
        {"tie of the product, broken by c downwards", kMad, 1.5, above, -low, 1.5 + u, 1.5 + u},
        {"a sum above the range saturates", kMad, high, high, -high, high, high},
        {"a negative sum below the range saturates", kMad, high, -high, high, -high, -high},
        {"c brings the product back into the range", kMad, high, 2, -high, high, high},
        {"a product above the range, almost cancelled by c", kMad, high, above, -high, high * u, high * u},
        {"a product below the range still counts in the sum", kMad, low, 0.5, low / 2 * 2, low * 1.5, low * 1.5},
        {"the smallest minus its half is flushed", kMad, low, -0.5, low, 0.0, 0.0},
        {"minus half the smallest is flushed to -0", kMad, low, -0.5, low * 0, -0.0, -0.0},
    };
}

void check_cases(const NumberFormat& format, const std::vector<Case>& cases) {
    NumberRows rows;
    for (const Case& test_case : cases) {
        for (const double value :
             {test_case.a, test_case.b, test_case.c, format.truncates ? test_case.truncated : test_case.nearest}) {
            INFO(format_name(format) << ": " << test_case.what << " uses " << value);
            REQUIRE(static_cast<double>(round_to_format(value, format)) == value);
        }
        rows.add(static_cast<float>(test_case.a), static_cast<float>(test_case.b), static_cast<float>(test_case.c));
    }
    rows.pad();
    const NumberResults results = run_numbers(number_build(format), rows);
    for (std::size_t i = 0; i < cases.size(); ++i) {
        const Case& test_case = cases[i];
        const auto expected = static_cast<float>(format.truncates ? test_case.truncated : test_case.nearest);
        const auto found = std::bit_cast<float>(results[test_case.operation][i]);
        CAPTURE(format_name(format), test_case.what, kNumberOperations[test_case.operation].name, test_case.a,
                test_case.b, test_case.c, found, expected);
        CHECK(std::bit_cast<std::uint32_t>(found) == std::bit_cast<std::uint32_t>(expected));
    }
}

}  // namespace

TEST_CASE("hand-written cases have the known results: ties, carries, cancellation, ends of the range, zeros",
          "[number][directed]") {
    for (const NumberFormat& format :
         {NumberFormat{5, 4}, NumberFormat{6, 15}, NumberFormat{7, 12}, NumberFormat{8, 21}})
        for (const bool truncates : {false, true}) {
            NumberFormat tested_format = format;
            tested_format.truncates = truncates;
            const SpecialNumbers special(tested_format);
            std::vector<Case> cases = sums(special);
            for (const auto& more : {products(special), quotients(special), accumulations(special)})
                cases.insert(cases.end(), more.begin(), more.end());
            check_cases(tested_format, cases);
        }
}

}  // namespace raya
