// The oracle has the results that kernels/number/README.md defines for zeros and at the ends of the range of reduced
// formats, which MPFR does not define.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>

#include "tests/number/mpfr_oracle.hpp"

namespace raya {

TEST_CASE("the oracle of reduced formats has the defined zeros, saturates and flushes", "[number][mpfr_oracle]") {
    struct OracleCase {
        const char* what;
        float found, expected;
    };
    for (const char* name : {"e5m4", "e6m15", "e6m15t", "e8m21t"}) {
        const NumberFormat format = parse_format(name);
        MpfrOracle oracle(format);
        const float unit = std::ldexp(1.0F, -format.fraction_bits), above = 1 + unit, below = 1 - unit / 2;
        const float low = std::ldexp(1.0F, range_of(format).lowest),
                    high = std::ldexp(2 - unit, range_of(format).highest),
                    step = std::ldexp(unit, range_of(format).highest);
        const OracleCase cases[] = {
            {"-a + a is +0", oracle.add(-high, high), 0.0F},
            {"0 + -0 is +0", oracle.add(0.0F, -0.0F), 0.0F},
            {"-0 + -0 is -0", oracle.add(-0.0F, -0.0F), -0.0F},
            {"-0 - 0 is -0", oracle.sub(-0.0F, 0.0F), -0.0F},
            {"-0 * 1 is -0", oracle.mul(-0.0F, 1), -0.0F},
            {"0 x + -0 with a negative product", oracle.mad(0.0F, -1, -0.0F), -0.0F},
            {"0 x + -0 with a positive product", oracle.mad(0.0F, 1, -0.0F), 0.0F},
            {"overflow saturates", oracle.sub(-high, high), -high},
            {"half a step above the largest saturates", oracle.add(high, step / 2), high},
            {"a product above the range saturates", oracle.mul(high, -high), -high},
            {"a product above the range, almost cancelled by c", oracle.mad(high, above, -high), high * unit},
            {"x / -0 saturates with the product of both signs", oracle.div(1, -0.0F), -high},
            {"-0 / 0 saturates with the sign of -0", oracle.div(-0.0F, 0.0F), -high},
            {"0 / -3 is -0", oracle.div(0.0F, -3), -0.0F},
            {"a quotient below the range is flushed with its sign", oracle.div(low, -high), -0.0F},
            {"half of the smallest is flushed", oracle.mul(low, 0.5F), 0.0F},
            {"just below the smallest: flushed", oracle.mul(low, below), 0.0F},
            {"far less than a unit below the smallest", oracle.mul(-low * above, 1 - unit),
             format.truncates ? -0.0F : -low},
            {"a product below the range still counts in the sum", oracle.mad(low, 0.5F, low), low * 1.5F},
            {"the square root of a negative number is +0", oracle.sqrt(-low), 0.0F},
            {"the square root of -0 is +0", oracle.sqrt(-0.0F), 0.0F}};
        for (const OracleCase& c : cases) {
            CAPTURE(name, c.what, c.found, c.expected);
            CHECK(std::bit_cast<std::uint32_t>(c.found) == std::bit_cast<std::uint32_t>(c.expected));
        }
    }
}

}  // namespace raya
