// Previews: their size, and their pixels, which are means of the image's pixels.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/image/image_io.hpp"

namespace raya {
namespace {

Image uniform_image(int width, int height, float value) {
    return {width, height,
            std::vector<float>(3u * static_cast<unsigned>(width) * static_cast<unsigned>(height), value)};
}

TEST_CASE("preview_of: keeps proportions, and leaves small images unchanged", "[image]") {
    struct Row {
        int width, height, small_width, small_height;
    };
    for (const Row& row : {Row{256, 256, 256, 256}, Row{512, 512, 256, 256}, Row{1000, 500, 256, 128},
                           Row{3, 16384, 1, 256}, Row{257, 1, 256, 1}, Row{20, 12, 20, 12}}) {
        const Image small = preview_of(uniform_image(row.width, row.height, 0.25f));
        CHECK(small.width == row.small_width);
        CHECK(small.height == row.small_height);
        CHECK(small.rgb == uniform_image(small.width, small.height, 0.25f).rgb);
    }
    CHECK_THROWS_AS(preview_of({0, 0, {}}), std::logic_error);
}

TEST_CASE("preview_of: a pixel is the mean of its clamped source pixels", "[image]") {
    Image image{4, 2, {}};
    for (int i = 0; i < 24; ++i) image.rgb.push_back(static_cast<float>(i) / 16 - 0.25f);
    image.rgb[0] = std::nanf("");
    const Image small = preview_of(image, 2);
    REQUIRE(small.width == 2);
    REQUIRE(small.height == 1);
    const auto clamped = [&](std::size_t i) {
        return std::isnan(image.rgb[i]) ? 0 : std::clamp(image.rgb[i], 0.f, 1.f);
    };
    for (std::size_t x = 0; x < 2; ++x)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t at = 6 * x + c;
            CHECK(small.rgb[3 * x + c] ==
                  Approx((clamped(at) + clamped(at + 3) + clamped(at + 12) + clamped(at + 15)) / 4));
        }
}

TEST_CASE("as_displayed: the result has the codes of the image at the given exposure", "[image]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> light(-0.5f, 4);
    Image image = uniform_image(40, 30, 0);
    for (float& value : image.rgb) value = light(random);
    for (const double exposure : {0.0, -1.5}) {
        const Image displayed = as_displayed(image, exposure);
        CHECK(srgb_codes(image.rgb, exposure) == srgb_codes(displayed.rgb, 0));
    }
}

}  // namespace
}  // namespace raya
