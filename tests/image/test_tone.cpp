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

using Codes = std::array<std::uint8_t, 3>;

constexpr double kExposures[] = {0.0, -2.0, 1.0, 0.3};

/// Returns a random colour, dark or bright. Some of the colours have a component of 0.
std::array<float, 3> random_colour(SplitMix& random) {
    std::array<float, 3> rgb{};
    const double scale = std::exp2(random.uniform(-10, 4));
    for (float& v : rgb) v = static_cast<float>(random.uniform(-0.1, 1) * scale);
    for (float& v : rgb) v = std::max(v, 0.0f);
    return rgb;
}

TEST_CASE("ToneCodes: exposure 0 gives the sRGB code of each value", "[tone]") {
    const ToneCodes codes;
    SplitMix random(41);
    for (int i = 0; i < 20'000; ++i) {
        const std::array<float, 3> rgb = random_colour(random);
        CAPTURE(i, rgb[0], rgb[1], rgb[2]);
        REQUIRE(codes(rgb.data()) == Codes{srgb_code(rgb[0]), srgb_code(rgb[1]), srgb_code(rgb[2])});
    }
}

TEST_CASE("ToneCodes: codes equal those of the formulas up to rounding", "[tone]") {
    SplitMix random(42);
    for (const double exposure : kExposures) {
        const ToneCodes codes(exposure);
        CAPTURE(exposure);
        for (int i = 0; i < 500; ++i) {
            const std::array<float, 3> rgb = random_colour(random);
            const double stops = std::pow(2.0, exposure);
            const Codes found = codes(rgb.data());
            for (std::size_t c = 0; c < 3; ++c) {
                const double exact = 255 * srgb_curve(std::min(stops * rgb[c], 1.0));
                CAPTURE(i, c, rgb[c], exact);
                REQUIRE(std::abs(found[c] - exact) <= 0.5 + 1e-5);
            }
        }
    }
}

TEST_CASE("ToneCodes: one more stop has the same effect as twice the light", "[tone]") {
    SplitMix random(43);
    for (const double exposure : kExposures) {
        const ToneCodes codes(exposure);
        const ToneCodes brighter(exposure + 1);
        for (int i = 0; i < 300; ++i) {
            const std::array<float, 3> rgb = random_colour(random);
            const std::array<float, 3> twice = {2 * rgb[0], 2 * rgb[1], 2 * rgb[2]};
            CAPTURE(i, exposure);
            REQUIRE(brighter(rgb.data()) == codes(twice.data()));
        }
    }
}

TEST_CASE("ToneCodes: a grey has three equal codes, which do not decrease with its brightness", "[tone]") {
    for (const double exposure : kExposures) {
        const ToneCodes codes(exposure);
        int previous_code = 0;
        for (double v = 1e-6; v < 1e6; v *= 1.01) {
            const auto value = static_cast<float>(v);
            const std::array<float, 3> grey = {value, value, value};
            const Codes found = codes(grey.data());
            CAPTURE(v, exposure);
            REQUIRE(found[0] >= previous_code);
            REQUIRE(found[0] == found[1]);
            REQUIRE(found[1] == found[2]);
            previous_code = found[0];
        }
        CHECK(previous_code == 255);
    }
}

TEST_CASE("ToneCodes: an infinity is converted like the largest float, NaN like 0", "[tone]") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const double exposure : kExposures) {
        const ToneCodes codes(exposure);
        const std::array<float, 3> white = {inf, inf, inf}, black = {nan, -inf, -1}, mixed = {nan, 1e30f, 0};
        CAPTURE(exposure);
        CHECK(codes(white.data()) == Codes{255, 255, 255});
        CHECK(codes(black.data()) == Codes{0, 0, 0});
        CHECK(codes(mixed.data()) == Codes{0, 255, 0});
    }
}

}  // namespace
}  // namespace raya
