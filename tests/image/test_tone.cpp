// The conversion of linear colours to 8-bit codes: exposure and the sRGB curve.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "host/image/image_io.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {

TEST_CASE("srgb_codes: codes equal those of the formula up to rounding", "[tone]") {
    SplitMix random(42);
    std::vector<float> values;
    for (int i = 0; i < 20'000; ++i)
        values.push_back(static_cast<float>(random.uniform(-0.1, 1) * std::exp2(random.uniform(-10, 4))));
    for (int i = 0; i <= 10'000; ++i) values.push_back(static_cast<float>(i) / 10'000);
    for (const double exposure : {0.0, -2.0, 1.0, 0.3}) {
        const std::vector<std::uint8_t> codes = srgb_codes(values, exposure);
        REQUIRE(codes.size() == values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double exact = 255 * srgb_curve(std::clamp(std::exp2(exposure) * values[i], 0.0, 1.0));
            CAPTURE(i, exposure, values[i], exact);
            // Tolerance: half a code for the rounding, and 1e-5 codes for the gap between the linear and the power
            // branch of the curve, which do not meet exactly with the constants of IEC 61966-2-1.
            REQUIRE(std::abs(codes[i] - exact) <= 0.5 + 1e-5);
            if (exposure == 0) REQUIRE(codes[i] == srgb_code(values[i]));
        }
    }
}

TEST_CASE("srgb_codes: an infinity is converted like the largest float, NaN like 0", "[tone]") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const double exposure : {0.0, -2.0, 1e4, -1e4}) {
        CAPTURE(exposure);
        const std::uint8_t white = exposure > -1000 ? 255 : 0;
        CHECK(srgb_codes(std::vector{inf, 1e30f, nan, -inf, -1.0f, 0.0f}, exposure) ==
              std::vector<std::uint8_t>{white, white, 0, 0, 0, 0});
    }
    CHECK(srgb_code(static_cast<double>(nan)) == 0);
}

TEST_CASE("srgb_code: no float is so close to a border between codes that the error of pow() could matter", "[tone]") {
    for (int code = 0; code < 255; ++code) {
        const double encoded = (code + 0.5) / 255;
        const double border = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
        CAPTURE(code, border);
        CHECK(std::abs(static_cast<float>(border) - border) > 1e-11 * border);
    }
}

}  // namespace
}  // namespace raya
