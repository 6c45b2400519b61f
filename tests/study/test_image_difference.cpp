// Image differences with known answers.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "host/study/image_difference.hpp"

namespace raya {
namespace {

constexpr double kLimit = 1.0 / 255;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST_CASE("equal images have infinite PSNR and no error", "[study]") {
    const std::vector<Colour> expected = {{0, 0.5, 1}, {0.25, 0.75, 0.125}};
    const ImageDifference d = image_difference(expected, std::vector<float>{0, 0.5f, 1, 0.25f, 0.75f, 0.125f}, kLimit);
    CHECK(d.psnr_db == kInfinity);
    CHECK(d.largest == 0);
    CHECK(d.over == 0);
    CHECK(d.share_over == 0);
}

TEST_CASE("one channel of twelve off by a half", "[study]") {
    const std::vector<Colour> expected(4, Colour(0.5, 0.5, 0.5));
    std::vector<float> rgb(12, 0.5f);
    rgb[7] = 1;
    const ImageDifference d = image_difference(expected, rgb, kLimit);
    CHECK(d.psnr_db == Approx(10 * std::log10(12 / 0.25)));
    CHECK(d.largest == 0.5);
    CHECK(d.over == 1);
    CHECK(d.share_over == 0.25);
}

TEST_CASE("a pixel counts once, and only above the limit", "[study]") {
    const std::vector<Colour> expected(3, Colour(0, 0, 0));
    const ImageDifference d = image_difference(expected,
                                               std::vector<float>{0.25f, 0.25f, 0.25f,  // at the limit
                                                                  0.5f, 0.5f, 0.5f,     // over it
                                                                  0, 0, 0},
                                               0.25);
    CHECK(d.over == 1);
    CHECK(d.share_over == Approx(1.0 / 3));
    CHECK(d.psnr_db == Approx(-10 * std::log10((3 * 0.0625 + 3 * 0.25) / 9)));
}

TEST_CASE("values are clamped to 0..1 on both sides before they are compared", "[study]") {
    const std::vector<Colour> expected = {{7, -1, 1.5}};
    CHECK(image_difference(expected, std::vector<float>{1.25f, -3, 90}, kLimit).psnr_db == kInfinity);
    CHECK(image_difference(expected, std::vector<float>{-2, 0, 1}, kLimit).largest == 1);
}

TEST_CASE("a value that is not finite, in either image, is infinitely far", "[study]") {
    const float bad = GENERATE(std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity());
    CAPTURE(bad);
    const std::vector<Colour> expected(2, Colour(1, 1, 1));
    const std::vector<Colour> bad_expected = {{1, 1, 1}, {1, bad, 1}};
    for (const ImageDifference& d : {image_difference(expected, std::vector<float>{1, 1, bad, 1, 1, 1}, kLimit),
                                     image_difference(bad_expected, std::vector<float>(6, 1.0f), kLimit),
                                     image_difference(bad_expected, std::vector<float>{1, 1, 1, 1, bad, 1}, kLimit)}) {
        CHECK(d.psnr_db == -kInfinity);
        CHECK(d.largest == kInfinity);
        CHECK(d.over == 1);
    }
}

TEST_CASE("images of different size and empty ones are refused", "[study]") {
    const std::vector<Colour> expected(2);
    CHECK_THROWS_AS(image_difference(expected, std::vector<float>(5), kLimit), std::invalid_argument);
    CHECK_THROWS_AS(image_difference(expected, std::vector<float>(9), kLimit), std::invalid_argument);
    CHECK_THROWS_AS(image_difference({}, {}, kLimit), std::invalid_argument);
}

}  // namespace
}  // namespace raya
