// The conversion of linear colours to 8-bit codes: exposure, tone curve and gamma.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "host/image/tone.hpp"
#include "host/scene/split_mix.hpp"
#include "tests/image/read_image.hpp"

namespace raya {
namespace {

using Codes = std::array<std::uint8_t, 3>;

/// Returns combinations of exposure, curve and gamma.
std::vector<Tone> tone_combinations() {
    std::vector<Tone> tones;
    for (const double exposure : {0.0, -2.0, 1.0, 0.3})
        for (const ToneCurve curve : {ToneCurve::kClip, ToneCurve::kReinhard})
            for (const std::optional<double> gamma : {std::optional<double>(), {2.2}, {1.0}})
                tones.push_back({exposure, curve, gamma});
    return tones;
}

/// Returns a random colour, dark or bright. Some of the colours have a component of 0.
std::array<float, 3> random_colour(SplitMix& random) {
    std::array<float, 3> rgb{};
    const double scale = std::exp2(random.uniform(-10, 4));
    for (float& v : rgb) v = static_cast<float>(random.uniform(-0.1, 1) * scale);
    for (float& v : rgb) v = std::max(v, 0.0f);
    return rgb;
}

TEST_CASE("ToneCodes: the default tone gives the sRGB code of each value", "[tone]") {
    const ToneCodes codes{Tone{}};
    SplitMix random(41);
    for (int i = 0; i < 20'000; ++i) {
        const std::array<float, 3> rgb = random_colour(random);
        CAPTURE(i, rgb[0], rgb[1], rgb[2]);
        REQUIRE(codes(rgb.data()) == Codes{srgb_code(rgb[0]), srgb_code(rgb[1]), srgb_code(rgb[2])});
    }
}

TEST_CASE("ToneCodes: codes equal those of the formulas up to rounding", "[tone]") {
    SplitMix random(42);
    for (const Tone& tone : tone_combinations()) {
        const ToneCodes codes(tone);
        CAPTURE(tone.exposure, tone_curve_name(tone.curve), tone.gamma.value_or(0));
        for (int i = 0; i < 500; ++i) {
            const std::array<float, 3> rgb = random_colour(random);
            const double stops = std::pow(2.0, tone.exposure);
            const double luminance = stops * (0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]);
            const Codes found = codes(rgb.data());
            for (std::size_t c = 0; c < 3; ++c) {
                double v = stops * rgb[c];
                if (tone.curve == ToneCurve::kReinhard) v /= 1 + luminance;
                v = std::min(v, 1.0);
                const double exact = 255 * (tone.gamma ? std::pow(v, 1 / *tone.gamma) : srgb_curve(v));
                CAPTURE(i, c, rgb[c], exact);
                REQUIRE(std::abs(found[c] - exact) <= 0.5 + 1e-5);
            }
        }
    }
}

TEST_CASE("ToneCodes: one more stop has the same effect as twice the light", "[tone]") {
    SplitMix random(43);
    for (Tone tone : tone_combinations()) {
        const ToneCodes codes(tone);
        tone.exposure += 1;
        const ToneCodes brighter(tone);
        for (int i = 0; i < 300; ++i) {
            const std::array<float, 3> rgb = random_colour(random);
            const std::array<float, 3> twice = {2 * rgb[0], 2 * rgb[1], 2 * rgb[2]};
            CAPTURE(i, tone.exposure);
            REQUIRE(brighter(rgb.data()) == codes(twice.data()));
        }
    }
}

TEST_CASE("ToneCodes: a grey has three equal codes, which do not decrease with its brightness", "[tone]") {
    for (const Tone& tone : tone_combinations()) {
        const ToneCodes codes(tone);
        int previous_code = 0;
        for (double v = 1e-6; v < 1e6; v *= 1.01) {
            const auto value = static_cast<float>(v);
            const std::array<float, 3> grey = {value, value, value};
            const Codes found = codes(grey.data());
            CAPTURE(v, tone.exposure);
            REQUIRE(found[0] >= previous_code);
            REQUIRE(found[0] == found[1]);
            REQUIRE(found[1] == found[2]);
            previous_code = found[0];
        }
        CHECK(previous_code == 255);
    }
}

TEST_CASE("ToneCodes: Reinhard's curve keeps different bright greys different, and preserves hues", "[tone]") {
    const ToneCodes clip{Tone{}}, reinhard{Tone{0, ToneCurve::kReinhard, {}}};
    const std::array<float, 3> bright = {2, 2, 2}, brighter = {4, 4, 4};
    CHECK(clip(bright.data()) == clip(brighter.data()));
    CHECK(reinhard(bright.data())[0] < reinhard(brighter.data())[0]);
    const ToneCodes linear{Tone{0, ToneCurve::kReinhard, 1.0}};
    const std::array<float, 3> orange = {1.5f, 0.75f, 0.3f};
    const Codes found = linear(orange.data());
    CHECK(found[0] / 1.5 == Approx(found[1] / 0.75).margin(1.5));
    CHECK(found[1] / 0.75 == Approx(found[2] / 0.3).margin(3));
}

TEST_CASE("ToneCodes: an infinity is converted like the largest float, NaN like 0", "[tone]") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    for (const Tone& tone : tone_combinations()) {
        const ToneCodes codes(tone);
        const std::array<float, 3> white = {inf, inf, inf}, black = {nan, -inf, -1}, mixed = {nan, 1e30f, 0};
        CAPTURE(tone.exposure, tone_curve_name(tone.curve));
        CHECK(codes(white.data()) == Codes{255, 255, 255});
        CHECK(codes(black.data()) == Codes{0, 0, 0});
        CHECK(codes(mixed.data()) == Codes{0, 255, 0});
    }
}

TEST_CASE("tone_attributes: returns only values other than the defaults", "[tone]") {
    CHECK(tone_attributes({}).empty());
    const ImageAttributes expected = {{"exposure", "-1.5"}, {"tone", "reinhard"}, {"gamma", "2.2"}};
    CHECK(tone_attributes({-1.5, ToneCurve::kReinhard, 2.2}) == expected);
}

}  // namespace
}  // namespace raya
