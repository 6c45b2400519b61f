// Number formats on the host: their names, and rounding compared with MPFR.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "host/error.hpp"
#include "host/model/number_format.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/number/mpfr_oracle.hpp"

namespace raya {
namespace {

constexpr std::uint64_t kFirstSeed = 22;

/// Returns a random number of either sign. Its exponent may lie slightly outside the format's range. Often the number
/// lies on or next to a number of the format or a tie between two such numbers.
double random_double(SplitMix& random, const NumberFormat& format) {
    const Range range = range_of(format);
    const double units = std::floor(random.uniform(0, std::ldexp(1, format.fraction_bits)));
    double remainder = random.uniform(0, 1);
    if (random.next() % 2 == 0) remainder = 0.5 * static_cast<double>(random.next() % 3);       // on a number or a tie
    if (random.next() % 4 == 0) remainder += std::ldexp(random.next() % 2 == 0 ? 1 : -1, -30);  // next to it
    const int exponent = static_cast<int>(std::floor(random.uniform(range.lowest - 3, range.highest + 3)));
    const double magnitude = std::ldexp(1 + std::ldexp(units + remainder, -format.fraction_bits), exponent);
    return random.next() % 2 == 0 ? magnitude : -magnitude;
}

void check_rounding(const NumberFormat& format) {
    MpfrOracle oracle(format);
    SplitMix random(kFirstSeed);
    for (int i = 0; i < 50'000; ++i) {
        const double value = random_double(random, format);
        const float found = round_to_format(value, format), expected = oracle.round(value);
        if (std::bit_cast<std::uint32_t>(found) == std::bit_cast<std::uint32_t>(expected)) continue;
        CAPTURE(format_name(format), kFirstSeed, i, value, expected);
        FAIL("the value is rounded to " << found);
    }
}

}  // namespace

TEST_CASE("numbers are rounded to a format as MPFR rounds them", "[machine][number]") {
    for (const int exponent_bits : {5, 6, 7, 8})
        for (const int fraction_bits : {4, 7, 10, 12, 15, 18, 21})
            for (const bool truncates : {false, true}) check_rounding({exponent_bits, fraction_bits, truncates});
    SUCCEED();
}

TEST_CASE("numbers beyond a format's range saturate or are flushed, with their sign", "[machine][number]") {
    const NumberFormat spa = parse_format("spa22");
    const double infinity = std::numeric_limits<double>::infinity();
    const float largest = 0x1.fffep+31F, smallest = 0x1p-30F;
    CHECK(round_to_format(infinity, spa) == largest);
    CHECK(round_to_format(-infinity, spa) == -largest);
    CHECK(round_to_format(-1e300, spa) == -largest);
    CHECK(round_to_format(0x1p-30, spa) == smallest);
    CHECK(round_to_format(0x1.ffffp-31, spa) == smallest);  // a tie, rounded to even
    CHECK(round_to_format(0x1.fffep-31, spa) == 0);
    CHECK(round_to_format(0x1.ffffp-31, parse_format("e6m15t")) == 0);
    CHECK(std::signbit(round_to_format(-1e-300, spa)));
    CHECK(std::signbit(round_to_format(-0.0, spa)));
    CHECK_FALSE(std::signbit(round_to_format(0.0, spa)));
    CHECK_THROWS_AS(round_to_format(std::nan(""), spa), std::invalid_argument);
}

TEST_CASE("format_name() of every valid format is parsed back to the format", "[machine][number]") {
    CHECK(parse_format("fp32") == NumberFormat{});
    CHECK(parse_format("fp32").is_fp32());
    CHECK(format_name(parse_format("fp32")) == "fp32");
    CHECK(parse_format("spa22") == NumberFormat{6, 15, false});
    CHECK(format_name(parse_format("spa22")) == "e6m15");
    for (int x = 5; x <= 8; ++x)
        for (int y = 4; y <= 21; ++y)
            for (const bool truncates : {false, true}) {
                const std::string name = "e" + std::to_string(x) + "m" + std::to_string(y) + (truncates ? "t" : "");
                const NumberFormat format = parse_format(name);
                CHECK(format == NumberFormat{x, y, truncates});
                CHECK_FALSE(format.is_fp32());
                CHECK(format_name(format) == name);
            }
}

TEST_CASE("invalid formats are refused, and the message states the valid ranges", "[machine][number]") {
    for (const std::string text :
         {"",       "fp",      "fp16",   "FP32",    "fp32t",           "spa22t", "spa",   "e6",   "e6m",   "em15",
          "m15",    "e6m15tt", "e6m15x", "e6m15 ",  " e6m15",          "e4m15",  "e9m15", "e6m3", "e6m22", "e8m23",
          "e-6m15", "e6m-15",  "e+6m15", "e6m15.0", "e99999999999m15", "e6m15T", "m15e6"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(parse_format(text), UserError);
        CHECK_THROWS_WITH(parse_format(text), Catch::Contains("--format " + text) && Catch::Contains("X = 5..8") &&
                                                  Catch::Contains("Y = 4..21"));
    }
}

}  // namespace raya
